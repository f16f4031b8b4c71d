"""Curves with names, units and labels: of a run in memory or of a history file."""
from __future__ import annotations

import abc
import contextlib
import fnmatch
import os
import pathlib
import re
import tempfile
from typing import TYPE_CHECKING, Any, Iterator, NamedTuple, Union

import numpy as np
import numpy.typing as npt

from ._error import Error, unknown

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure

Array = npt.NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]

COMPONENTS = {1: ("",), 3: ("x", "y", "z"), 4: ("w", "x", "y", "z"),
              6: ("tx", "ty", "tz", "rx", "ry", "rz")}
DIMENSION = {3: "axis", 4: "quaternion", 6: "direction"}
ENTITY = {"rigid_body": "body"}                   # groups whose entities have another name


class Channel(NamedTuple):
    """What a channel is: meaning, unit, ids and labels of its entities, number of components.

    >>> import kjoint
    >>> kjoint.example().run(until=0.1, sample=0.05).channel("joint/force")
    Channel(meaning='joint force on node 1', unit='kg m s-2', ids=(1,), labels=('hinge',), n_comp=3)
    """
    meaning: str
    unit: str
    ids: tuple[int, ...]
    labels: tuple[str, ...]
    n_comp: int


class Curve(NamedTuple):
    """One number over time: name as the command line has it, unit, values.

    >>> import kjoint
    >>> curve, = kjoint.example().run(until=0.1, sample=0.05).curves("joint/force.z")
    >>> curve.name, curve.unit, curve.values.shape
    ('joint/force[hinge].z', 'kg m s-2', (3,))
    """
    name: str
    unit: str
    values: Array


class Samples(abc.ABC):
    """What Model and Run share: channels by name, as arrays, tables and pictures.

    A name is a channel, group/dataset, and may choose an entity by label or id in brackets and a
    component or `norm` behind a dot: joint/force[wrist pin].norm. * and ? stand for any text and
    letter. Values have the units of the deck, which each channel tells; angles are in radian.

    >>> import kjoint
    >>> samples = kjoint.example().run(until=0.1, sample=0.05)
    >>> samples["joint/force"].shape, samples["joint/force[hinge].z"].shape
    ((3, 1, 3), (3,))
    """

    @property
    @abc.abstractmethod
    def channels(self) -> list[str]:
        """Names of all channels.

        >>> import kjoint
        >>> "joint/force" in kjoint.example().run(until=0.1, sample=0.05).channels
        True
        """

    @property
    @abc.abstractmethod
    def title(self) -> str:
        """Title of the deck.

        >>> import kjoint
        >>> kjoint.example().run(until=0.1, sample=0.05).title
        'pendulum'
        """

    @abc.abstractmethod
    def channel(self, name: str) -> Channel:
        """What a channel is: meaning, unit, ids and labels of its entities, components.

        >>> import kjoint
        >>> kjoint.example().run(until=0.1, sample=0.05).channel("rigid_body/position").labels
        ('wall', 'bar')
        """

    @abc.abstractmethod
    def _values(self, name: str) -> Array:
        """Values of a channel: sample x entity x component."""

    def __getitem__(self, name: str) -> Array:
        """A channel: time, or time x entity, or with x component; or one curve by its whole name.

        >>> import kjoint
        >>> run = kjoint.example().run(until=0.1, sample=0.05)
        >>> run["time"]                                 # s
        array([0.  , 0.05, 0.1 ])
        >>> run["joint/rotation[hinge].x"].shape        # rad
        (3,)
        """
        if "[" in name or "." in name:
            found = self.curves(name)
            if len(found) != 1:
                raise Error(f"{name} means {len(found)} curves, not one, such as {found[0].name}")
            return found[0].values
        values = self._values(name)
        if values.shape[2] == 1:
            values = values[:, :, 0]
        return values[:, 0] if "/" not in name else values

    def unit(self, channel: str) -> str:
        """Unit of a channel, such as kg m s-2.

        >>> import kjoint
        >>> kjoint.example().run(until=0.1, sample=0.05).unit("joint/moment")
        'kg m2 s-2'
        """
        return self.channel(channel).unit

    def curves(self, *names: str) -> list[Curve]:
        """The curves that names mean, each with name, unit and values.

        >>> import kjoint
        >>> run = kjoint.example().run(until=0.1, sample=0.05)
        >>> [curve.name for curve in run.curves("joint/force", "kinetic*")][-2:]
        ['kinetic_energy_trans', 'kinetic_energy_rot']
        """
        found: list[Curve] = []
        for name in names:
            n = len(found)
            for path, entity, comp in self._places(name):
                values = self._values(path)
                what = self.channel(path)
                for i, label in enumerate(titles(what)):
                    if entity and not (fnmatch.fnmatchcase(what.labels[i], entity)
                                       or entity in (str(what.ids[i]), label)):
                        continue
                    whole = f"{path}[{label}]" if "/" in path else path
                    if comp == "norm" and what.n_comp > 1:
                        norm = np.linalg.norm(values[:, i], axis=1)
                        found.append(Curve(whole + ".norm", what.unit, norm))
                    for k, letter in enumerate(COMPONENTS[what.n_comp]):
                        if comp in ("", letter):
                            found.append(Curve(f"{whole}.{letter}".rstrip("."), what.unit,
                                               values[:, i, k]))
            if len(found) == n:
                self._explain(name)
        return found

    @staticmethod
    def _apart(name: str) -> tuple[str, str, str]:
        """Channel, entity and component of a name."""
        parts = re.fullmatch(r"([^\[.]+)(?:\[(.*)\])?(?:\.(\w+))?", name)
        if not parts:
            raise Error(f"{name!r} is no name of curves: GROUP/CHANNEL[ENTITY].COMPONENT")
        path, entity, comp = (part or "" for part in parts.groups())
        return path, entity, comp

    def _places(self, name: str) -> Iterator[tuple[str, str, str]]:
        path, entity, comp = self._apart(name)
        for channel in self.channels:
            if channel.count("/") == path.count("/") and fnmatch.fnmatchcase(channel, path):
                yield channel, entity, comp

    def _explain(self, name: str) -> None:
        """Say why a name means no curve."""
        path, entity, comp = self._apart(name)
        for channel, _, _ in self._places(name):
            what = self.channel(channel)
            letters = COMPONENTS[what.n_comp] + ("norm",)*(what.n_comp > 1)
            if comp and comp not in letters:
                raise unknown(f"component of {channel},", comp, filter(None, letters))
            raise unknown(f"entity of {channel},", entity, what.labels)
        raise unknown("channel", path, self.channels)

    def to_xarray(self, *channels: str) -> xarray.Dataset:
        """Channels, or all, as an xarray.Dataset: labels as coordinates, units as attributes.

        >>> import kjoint
        >>> data = kjoint.example().run(until=0.1, sample=0.05).to_xarray("joint/force")
        >>> force = data["joint/force"].sel(joint="hinge", axis="z")
        >>> force.units, force.sizes["time"]
        ('kg m s-2', 3)
        """
        import xarray
        data: dict[str, Any] = {}
        coords: dict[str, Any] = {"time": ("time", self["time"], {"units": self.unit("time")})}
        for name in channels or self.channels:
            if name == "time":
                continue
            what = self.channel(name)
            values, dims = self._values(name), ["time"]
            if "/" in name:
                group = name.partition("/")[0]
                dims.append(ENTITY.get(group, group))
                coords[dims[1]] = titles(what)
                coords[dims[1] + "_id"] = (dims[1], list(what.ids))
            else:
                values = values[:, 0]
            if what.n_comp > 1:
                dims.append(DIMENSION[what.n_comp])
                coords[dims[-1]] = list(COMPONENTS[what.n_comp])
            else:
                values = values[..., 0]
            data[name] = (dims, values, {"units": what.unit, "long_name": what.meaning})
        return xarray.Dataset(data, coords, {"title": self.title})

    def to_pandas(self, *names: str) -> pandas.DataFrame:
        """Curves, or all, as a pandas.DataFrame over the time; attrs["units"] has their units.

        >>> import kjoint
        >>> table = kjoint.example().run(until=0.1, sample=0.05).to_pandas("joint/force")
        >>> list(table.columns), table.attrs["units"]["joint/force[hinge].x"]
        (['joint/force[hinge].x', 'joint/force[hinge].y', 'joint/force[hinge].z'], 'kg m s-2')
        """
        import pandas
        found = self.curves(*(names or [name for name in self.channels if name != "time"]))
        table = pandas.DataFrame({curve.name: curve.values for curve in found},
                                 index=pandas.Index(self["time"], name="time"))
        table.attrs["units"] = {curve.name: curve.unit for curve in found}
        return table

    def plot(self, *names: str, path: Path | None = None) -> Figure:
        """Curves over time with matplotlib, a panel a name; path: a picture instead of a window.

        >>> import kjoint, matplotlib; matplotlib.use("Agg")
        >>> run = kjoint.example().run(until=0.1, sample=0.05)
        >>> figure = run.plot("joint/force", path="force.png")
        >>> figure.axes[0].get_ylabel()
        'joint force on node 1 [kg m s-2]'
        """
        import matplotlib.pyplot as plt
        figure, axes = plt.subplots(len(names), 1, sharex=True, squeeze=False, layout="constrained",
                                    figsize=(8, 0.5 + 2.2*len(names)))
        for name, ax in zip(names, axes[:, 0]):
            found = self.curves(name)
            for curve in found:
                ax.plot(self["time"], curve.values, label=curve.name.partition("/")[2] or curve.name)
            meanings = {self.channel(path).meaning for path, _, _ in self._places(name)}
            units = sorted({curve.unit for curve in found})
            ax.set_ylabel(f"{meanings.pop() if len(meanings) == 1 else name} [{' or '.join(units)}]",
                          wrap=True)
            ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize="small")
            ax.margins(x=0.0)
        axes[-1, 0].set_xlabel(f"time [{self.unit('time')}]")
        figure.suptitle(self.title)
        if path:
            figure.savefig(path)
        elif "inline" not in plt.get_backend():          # a notebook shows what the call gives
            plt.show()
        plt.close(figure)
        return figure


def titles(what: Channel) -> list[str]:
    """The labels of the entities; label (id) where two are equal, the id where there is none."""
    return [f"{label} ({id})" if what.labels.count(label) > 1 and label else label or str(id)
            for id, label in zip(what.ids, what.labels)]


class Run(Samples):
    """A history file of kjoint, or a T01 of Radioss: what a run left on the disk.

    >>> import kjoint
    >>> kjoint.example().run(until=0.1, sample=0.05).write_history("pendulum.h5")
    >>> run = kjoint.Run.open("pendulum.h5")
    >>> run.title, run["time"]                          # s
    ('pendulum', array([0.  , 0.05, 0.1 ]))
    """

    def __init__(self, path: Path) -> None:
        self.path = pathlib.Path(path)
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        if not self.path.is_file():
            raise Error(f"there is no file {self.path}", 3)
        if self.path.read_bytes()[:8] != b"\x89HDF\r\n\x1a\n":
            from ._show import call
            self._folder = tempfile.TemporaryDirectory()
            target = pathlib.Path(self._folder.name, "converted.h5")
            call("convert", self.path, "-o", target)
            self.path = target
        with self._file() as file:
            self._channels = [path for path in self._time_series(file)]
            if "time" not in self._channels:
                raise Error(f"{path} is no history of kjoint", 3)

    @classmethod
    def open(cls, path: Path) -> Run:
        """Open a history, RUN.h5, or a T01.

        >>> import kjoint
        >>> kjoint.example().run(until=0.1, sample=0.05).write_history("pendulum.h5")
        >>> kjoint.Run.open("pendulum.h5")
        Run('pendulum.h5')
        """
        return cls(path)

    def __repr__(self) -> str:
        return f"Run({str(self.path)!r})"

    @contextlib.contextmanager
    def _file(self) -> Iterator[Any]:
        try:
            import h5py
        except ImportError as error:
            raise ImportError("kjoint.Run needs h5py: python3 -m pip install 'kjoint[plot]'") from error
        try:
            with h5py.File(self.path, "r") as file:
                yield file
        except Error:
            raise
        except (OSError, KeyError, RuntimeError, AttributeError) as error:     # h5py gives None for what it cannot open
            raise Error(f"cannot read {self.path}: {error}", 3) from error

    @staticmethod
    def _time_series(file: Any) -> Iterator[str]:
        n = file["time"].shape[0] if "time" in file else -1
        for name, item in file.items():
            if hasattr(item, "keys"):
                if name + "/time" not in file:
                    continue
                for dataset, values in item.items():
                    if dataset != "time" and values.ndim > 1 and values.shape[0] == n \
                            and values.dims[0].keys() and "time" in values.dims[0][0].name:
                        yield f"{name}/{dataset}"
            elif item.shape == (n,):
                yield name

    @property
    def channels(self) -> list[str]:
        """Names of all channels.

        >>> import kjoint
        >>> kjoint.example().run(until=0.1, sample=0.05).write_history("pendulum.h5")
        >>> "joint/force" in kjoint.Run.open("pendulum.h5").channels
        True
        """
        return list(self._channels)

    @property
    def title(self) -> str:
        """Title of the deck.

        >>> import kjoint
        >>> kjoint.example().run(until=0.1, sample=0.05).write_history("pendulum.h5")
        >>> kjoint.Run.open("pendulum.h5").title
        'pendulum'
        """
        with self._file() as file:
            return str(file.attrs.get("title", ""))

    def channel(self, name: str) -> Channel:
        """What a channel is: meaning, unit, ids and labels of its entities, components.

        >>> import kjoint
        >>> kjoint.example().run(until=0.1, sample=0.05).write_history("pendulum.h5")
        >>> kjoint.Run.open("pendulum.h5").channel("rigid_body/velocity").unit
        'm s-1'
        """
        if name not in self._channels:
            raise unknown("channel", name, self._channels)
        with self._file() as file:
            item = file[name]
            about = str(item.attrs.get("long_name", "")), str(item.attrs.get("units", ""))
            if "/" not in name:
                return Channel(*about, (0,), ("",), 1)
            group = name.partition("/")[0]
            ids = file[group][ENTITY.get(group, group)][()]
            labels = file[group]["label"].asstr()[()] if "label" in file[group] else [""]*len(ids)
            return Channel(*about, tuple(map(int, ids)), tuple(map(str, labels)),
                           item.shape[2] if item.ndim == 3 else 1)

    def _values(self, name: str) -> Array:
        what = self.channel(name)
        with self._file() as file:
            values = np.asarray(file[name][()], dtype=float)
        return values.reshape(len(values), len(what.ids), what.n_comp)
