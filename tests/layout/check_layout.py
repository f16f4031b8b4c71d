#!/usr/bin/env python3
"""Check that a history file keeps the HDF5 layout 1.0 and that the usual readers open it.

usage: check_layout.py RUN.h5      (one line per violation and exit 1; exit 0 when there is none)

Reads the file with h5py, with xarray through h5netcdf and netCDF4, with `ncdump -h`, and compares it
with itself by `h5diff`.
"""
import shutil
import subprocess
import sys
import warnings
import zlib

import h5py
import numpy as np

MOST_CHUNK_BYTES = 256 * 1024
ENTITY = {"joint": "joint", "rigid_body": "body", "node": "node", "spring": "spring"}
TABLES = ("point", "segment")                           # groups that do not change with time
COMPONENTS = {"axis": ["x", "y", "z"], "quaternion": ["w", "x", "y", "z"],
              "axis6": ["tx", "ty", "tz", "rx", "ry", "rz"]}
OF_COMPONENTS = {"frame": "quaternion", "orientation": "quaternion", "state": "axis6"}
FLAGS = {"time_step_owner_kind": ([0, 1, 2, 3], "none node body joint"),
         "state": ([0, 1, 2, 3, 4, 5], "free sliding sticking at_stop locked blocked")}
ROOT_ATTRIBUTES = {
    "Conventions": "CF-1.11 KJOINT-TH-1.0", "title": None, "source": None,
    "kjoint_format_major": 1, "kjoint_format_minor": 1,
    "unit_mass": None, "unit_length": None, "unit_time": None, "NX_class": "NXentry"}
CLASSES = {"time", "energy", "force", "moment", "displacement", "rotation", "velocity",
           "angular_velocity", "acceleration", "control", "flag", "momentum"}
INTEGER_SERIES = {"cycle": "int64", "time_step_owner_kind": "int8", "time_step_owner": "int32",
                  "final": "int8", "state": "int8"}
IDS = {"joint", "body", "node", "type", "property", "node1", "node2", "body1", "body2", "main_node",
       "point", "segment", "point1", "point2"}
CONSTANT_DIMS = {"inertia_principal": ("axis",), "principal_axes": ("principal", "axis"), "position": ("axis",)}
VOLATILE_ORDER = ["command_line", "version", "compiler", "compiler_options", "hdf5_version"]
OF_HDF5 = {"CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST", "_Netcdf4Dimid",
           "_Netcdf4Coordinates"}                       # what dimension scales write themselves
ORDERED = h5py.h5p.CRT_ORDER_TRACKED | h5py.h5p.CRT_ORDER_INDEXED


class Checker:
    """Collects violations of one file."""

    def __init__(self, path):
        self.path, self.found = path, []

    def say(self, place, message):
        self.found.append(f"{self.path}: {place}: {message}")

    def expect(self, condition, place, message):
        if not condition:
            self.say(place, message)
        return bool(condition)

    # ---- the file as h5py sees it

    def check_file(self):
        with h5py.File(self.path, "r") as file:
            root = h5py.h5g.open(file.id, b"/").get_create_plist()
            self.expect(root.get_link_creation_order() == ORDERED, "/",
                        "creation order of links is not tracked and indexed")
            self.expect(root.get_attr_creation_order() == ORDERED, "/",
                        "creation order of attributes is not tracked and indexed")
            self.expect(not root.get_obj_track_times(), "/", "stores its times")
            self.check_attributes(file, "/")
            self.check_root(file)
            self.check_links(file, "")
            self.check_chunks(file)
            for name in ENTITY:
                if name in file:
                    self.check_entities(file, file[name], name)
            for name in TABLES:
                if name in file:
                    self.check_table(file[name], name)
            self.check_input(file)
            self.check_run(file)

    def check_root(self, file):
        for name, value in ROOT_ATTRIBUTES.items():
            if self.expect(name in file.attrs, "/", f"no attribute {name}") and value is not None:
                self.expect(file.attrs[name] == value, "/",
                            f"attribute {name} is {file.attrs[name]!r}, not {value!r}")
        groups = [name for name in ENTITY if name in file]
        if groups:
            self.expect(file.attrs.get("default") == groups[0], "/",
                        f"attribute default is not {groups[0]!r}")
        if not self.expect("time" in file, "/time", "missing"):
            return
        time = file["time"]
        self.expect(time.is_scale, "/time", "is no dimension scale")
        self.expect(time.attrs.get("units") == file.attrs.get("unit_time"), "/time",
                    "its units are not those of the file")
        self.expect(time.attrs.get("axis") == "T", "/time", "attribute axis is not 'T'")
        self.expect(np.all(np.diff(time[:]) >= 0), "/time", "decreases")
        for name, item in file.items():
            if isinstance(item, h5py.Dataset):
                self.check_series(file, item, f"/{name}", ())

    def check_links(self, group, prefix):
        """Links, creation properties and types of everything below a group."""
        for name in group:
            path = f"{prefix}/{name}"
            if not self.expect(type(group.get(name, getlink=True)) is h5py.HardLink, path,
                               "is a soft or external link"):
                continue
            item = group[name]
            plist = item.id.get_create_plist()
            self.expect(plist.get_attr_creation_order() == ORDERED, path,
                        "creation order of attributes is not tracked and indexed")
            self.expect(not plist.get_obj_track_times(), path, "stores its times")
            self.check_attributes(item, path)
            if isinstance(item, h5py.Group):
                self.expect(plist.get_link_creation_order() == ORDERED, path,
                            "creation order of links is not tracked and indexed")
                self.expect(len(item) > 0 or name == "run", path, "is empty")
                self.check_links(item, path)
            else:
                self.check_type(item.dtype, item.id.get_type(), path)
                self.expect(item.id.get_space().get_simple_extent_type() != h5py.h5s.NULL, path,
                            "has a null dataspace")

    def check_chunks(self, file):
        """Every chunk holds the very bytes that the filters of HDF5 would have put there; plain ones are not
        shuffled, and say so."""
        series = []
        file.visititems(lambda path, item: series.append(path) if isinstance(item, h5py.Dataset)
                        and item.chunks is not None and item.maxshape[0] is None else None)
        with h5py.File("by_filters", "w", driver="core", backing_store=False) as other:
            for path in series:
                mine = file[path]
                plist = mine.id.get_create_plist()
                filters = [plist.get_filter(i)[0] for i in range(plist.get_nfilters())]
                self.expect(filters == [h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_DEFLATE], path,
                            "is not shuffled and deflated")
                theirs = other.create_dataset(path, data=mine[()], maxshape=mine.maxshape,
                                              chunks=mine.chunks, shuffle=True,
                                              compression="gzip", compression_opts=1)
                n = theirs.id.get_num_chunks()
                self.expect(mine.id.get_num_chunks() == n, path, "has not every chunk")
                for i in range(n):
                    offset = theirs.id.get_chunk_info(i).chunk_offset
                    (plain, found), (_, wanted) = (d.id.read_direct_chunk(offset) for d in (mine, theirs))
                    found = np.frombuffer(zlib.decompress(found), np.uint8)
                    if plain:
                        self.expect(plain == 1, path, "leaves out another filter than the first")
                        found = found.reshape(-1, mine.dtype.itemsize).T
                    self.expect(found.tobytes() == zlib.decompress(wanted), path, f"other bytes in chunk {offset}")

    def check_type(self, dtype, stored, path):
        """Plain numbers and variable-length UTF-8 strings only."""
        text = h5py.check_string_dtype(dtype)
        if text is not None:
            self.expect(text.length is None and text.encoding == "utf-8", path,
                        "is a string that is not variable-length UTF-8")
            return
        plain = stored.get_class() in (h5py.h5t.INTEGER, h5py.h5t.FLOAT)
        self.expect(plain, path, f"has the forbidden type {dtype}")

    def check_attributes(self, item, path):
        for name in item.attrs:
            if name in OF_HDF5:
                continue
            attribute = item.attrs.get_id(name)
            self.check_type(attribute.dtype, attribute.get_type(), f"{path}@{name}")
            self.expect(attribute.get_space().get_simple_extent_type() != h5py.h5s.NULL,
                        f"{path}@{name}", "has a null dataspace")

    # ---- datasets

    def labels(self, item):
        """Names of the scales on each dimension."""
        return tuple(dim[0].name.rsplit("/", 1)[1] if len(dim) else None for dim in item.dims)

    def check_labels(self, item, path, wanted):
        found = (item.name.rsplit("/", 1)[1],) if item.is_scale else self.labels(item)
        for i, dim in enumerate(() if item.is_scale else item.dims):
            self.expect(all(h5py.h5ds.is_attached(item.id, scale.id, i) for scale in dim.values()), path,
                        f"the scale of dimension {i} does not list it")
        return self.expect(found == wanted, path, f"dimensions are labelled {found}, not {wanted}")

    def check_series(self, file, item, path, entity):
        """A dataset over time: labels, length, chunks, filters, attributes."""
        name = path.rsplit("/", 1)[1]
        wanted = ("time", *entity)
        if len(item.shape) > len(wanted):
            wanted += (OF_COMPONENTS.get(name, "axis"),)
        self.check_labels(item, path, wanted)
        self.expect(item.shape[0] == file["time"].shape[0], path, "is not as long as time")
        self.expect(item.maxshape[0] is None, path, "its first dimension is not unlimited")
        self.expect(item.dtype == np.dtype(INTEGER_SERIES.get(name, "float64")), path,
                    f"is of type {item.dtype}")
        if self.expect(item.chunks is not None, path, "is not chunked"):
            rows = item.chunks[0]
            self.expect(rows & (rows - 1) == 0, path, f"chunks of {rows} rows, no power of two")
            self.expect(np.prod(item.chunks) * item.dtype.itemsize <= MOST_CHUNK_BYTES, path,
                        "chunks are larger than 256 KiB")
            if entity:
                self.expect(item.chunks[1] <= item.shape[1], path, "chunks are wider than the data")
            self.expect(item.chunks[2:] == item.shape[2:], path, "chunks split the components")
        self.expect(item.shuffle and item.compression == "gzip" and item.compression_opts == 1, path,
                    "is not shuffled and deflated at level 1")
        for attribute in ("units", "long_name", "channel_class", "sampled_at"):
            self.expect(item.attrs.get(attribute), path, f"no attribute {attribute}")
        self.expect(item.attrs.get("channel_class") in CLASSES, path, "unknown channel_class")
        self.expect(item.attrs.get("sampled_at") in ("t", "t-dt/2", "t+dt"), path,
                    "unknown sampled_at")
        self.expect(item.attrs.get("frame", "global") in ("joint", "global"), path, "unknown frame")
        if len(wanted) == 3:
            self.expect("frame" in item.attrs, path, "a vector without attribute frame")
        if name in FLAGS:
            values, meanings = FLAGS[name]
            self.expect(list(item.attrs.get("flag_values", [])) == values, path, "flag_values")
            self.expect(item.attrs["flag_values"].dtype == item.dtype, path,
                        "flag_values are of another type than the data")
            self.expect(item.attrs.get("flag_meanings") == meanings, path, "flag_meanings")

    def check_entities(self, file, group, name):
        entity, path = ENTITY[name], f"/{name}"
        if not self.expect(entity in group and group[entity].is_scale, path, f"no scale {entity}"):
            return
        ids = group[entity]
        self.expect(ids.dtype == np.dtype("int32"), f"{path}/{entity}", "is not of type int32")
        self.expect(np.all(np.diff(ids[:]) > 0), f"{path}/{entity}", "user ids do not ascend")
        self.expect("time" in group and group["time"] == file["time"], path,
                    "time is no hard link to /time")
        for scale, values in COMPONENTS.items():
            if scale in group:
                self.expect(list(group[scale].asstr()[:]) == values, f"{path}/{scale}",
                            f"does not hold {values}")
        self.expect(group.attrs.get("NX_class") == "NXdata", path, "NX_class is not NXdata")
        signal = group.attrs.get("signal")
        if self.expect(signal in group, path, "no signal"):
            self.expect(tuple(group.attrs.get("axes", ())) == self.labels(group[signal]), path,
                        "axes are not the dimensions of the signal")
        coordinates = [text for text in ("label", "kind") if text in group]
        for key, item in group.items():
            here = f"{path}/{key}"
            if key == "time" or item.is_scale:
                self.expect(item.attrs.get("long_name"), here, "no attribute long_name")
            elif item.maxshape[0] is None:
                self.check_series(file, item, here, (entity,))
                self.expect(item.attrs.get("coordinates", "") == " ".join(coordinates), here,
                            f"coordinates are not {coordinates}")
            else:
                self.check_constant(item, here, entity)

    def check_table(self, group, name):
        """Points and segments of the bodies, counted from 0."""
        ids = group[name]
        self.expect(ids.is_scale and list(ids) == list(range(len(ids))), f"/{name}/{name}",
                    "is no scale that counts from 0")
        for key, item in group.items():
            if not item.is_scale:
                self.check_constant(item, f"/{name}/{key}", name)

    def check_constant(self, item, path, entity):
        name = path.rsplit("/", 1)[1]
        self.check_labels(item, path, (entity, *CONSTANT_DIMS.get(name, ())))
        self.expect(item.attrs.get("long_name"), path, "no attribute long_name")
        if name in IDS:
            self.expect(item.dtype == np.dtype("int32"), path, "is not of type int32")
        if h5py.check_string_dtype(item.dtype) is None:
            self.expect(item.attrs.get("units"), path, "no attribute units")

    # ---- deck files and the run

    def check_input(self, file):
        for name, item in file.get("input", {}).items():
            path = f"/input/{name}"
            self.expect(item.shape == (), path, "is no scalar")
            self.expect(len(item.attrs.get("sha256", "")) == 64, path, "no attribute sha256")
            self.expect(item.attrs.get("role") in ("starter", "engine", "include"), path,
                        "unknown role")
            self.expect(len(item.asstr()[()]) > 0, path, "is empty")
        if "input" in file:
            self.expect(len(file.attrs.get("input_sha256", "")) == 64, "/", "no input_sha256")

    def check_run(self, file):
        if not self.expect("run" in file, "/run", "missing"):
            return
        run = file["run"]
        self.expect(len(run) == 0, "/run", "holds more than attributes")
        for name in ("version", "compiler", "compiler_options", "hdf5_version", "status"):
            self.expect(name in run.attrs, "/run", f"no attribute {name}")
        status = run.attrs.get("status", "")
        known = status in ("RUNNING", "NORMAL TERMINATION", "STOPPED BY USER")
        self.expect(known or status.startswith("ERROR"), "/run", f"unknown status {status!r}")
        order = [name for name in run.attrs if name in VOLATILE_ORDER]
        self.expect(order == [name for name in VOLATILE_ORDER if name in run.attrs], "/run",
                    "attributes are not in the order of writing")

    # ---- other readers

    def check_xarray(self, engine):
        import xarray
        with h5py.File(self.path, "r") as file:
            series = {name: {key: len(item.shape) for key, item in file[name].items()
                             if isinstance(item, h5py.Dataset) and item.maxshape[:1] == (None,)}
                      for name in ["/", *[name for name in ENTITY if name in file]]}
        for name, shapes in series.items():
            place = f"{name} in xarray ({engine})"
            try:
                data = xarray.open_dataset(self.path, group=name, engine=engine)
            except Exception as problem:        # any failure of a reader is a finding
                self.say(place, repr(problem))
                continue
            with data:
                self.expect(data["time"].dtype == np.dtype("float64"), place,
                            f"time became {data['time'].dtype}")
                for key, rank in shapes.items():
                    wanted = ("time", ENTITY.get(name), OF_COMPONENTS.get(key, "axis"))[:rank]
                    self.expect(data[key].dims == wanted, f"{place}, {key}",
                                f"dimensions are {data[key].dims}, not {wanted}")
                if name != "/":
                    wanted = {"time", ENTITY[name], "axis", "label"} & set(data.variables)
                    self.expect(wanted <= set(data.coords), place,
                                f"{wanted - set(data.coords)} are no coordinates")
                self.check_tables(data, place)
        for name in TABLES:
            if h5_has(self.path, name):
                with xarray.open_dataset(self.path, group=name, engine=engine) as data:
                    self.expect(len(data.to_dataframe()) > 0, f"{name} in xarray", "is empty")
                    last = data[name].values[-1]
                    self.expect(data.sel({name: last})[name] == last and
                                name not in data.mean(name).dims,
                                f"{name} in xarray", "has no last row or no mean")

    def check_tables(self, data, place):
        """What people do first with a group: a table, a mean, a sample by its time."""
        first = data.isel({name: slice(0, 50 if name in ENTITY.values() else 2)
                           for name in ("time", *ENTITY.values()) if name in data.dims}).load()
        self.expect(len(first.to_dataframe()) == np.prod(list(first.sizes.values())), place,
                    "its table has not a row for each combination of its dimensions")
        mean = data.mean("time")
        self.expect("time" not in mean.dims and len(mean.data_vars) > 0, place, "has no mean")
        last = data.time.values[-1]
        self.expect(data.sel(time=last, method="nearest").time == last, place,
                    "does not find its last time")

    def check_command(self, *command):
        if shutil.which(command[0]) is None:
            self.say(command[0], "is not installed")
            return ""
        done = subprocess.run(command, capture_output=True, text=True)
        self.expect(done.returncode == 0, " ".join(command),
                    f"exit {done.returncode}: {done.stderr.strip()[:200]}")
        return done.stdout


def h5_has(path, name):
    with h5py.File(path, "r") as file:
        return name in file


def main(path):
    warnings.simplefilter("error")              # a reader that warns has not understood the file
    checker = Checker(path)
    checker.check_file()
    for engine in ("h5netcdf", "netcdf4"):
        checker.check_xarray(engine)
    header = checker.check_command("ncdump", "-h", path)
    checker.expect("phony" not in header, "ncdump -h", "shows dimensions without a scale")
    checker.check_command("h5diff", path, path)
    print("\n".join(checker.found) if checker.found else f"{path}: keeps the layout")
    return 1 if checker.found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
