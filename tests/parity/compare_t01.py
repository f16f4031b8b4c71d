#!/usr/bin/env python3
"""Compare a history of kjoint with a Radioss time history of type /TFILE/1, channel by channel.

usage: compare_t01.py CASET01 RUN.h5 [TOLERANCE]   (needs numpy and h5py; exit 1 when they differ)

A check that shares no code with kjoint. Every component of a vector channel lies within 1e-7 of
the peak of the vector's norm in the T01 (a peak below 1e-6 of the largest of its class counts as
that), times within 1e-9 relative, energies within 1e-6 of the largest kinetic + internal + |work|. TOLERANCE replaces 1e-7, energies
keep ten times that, times stay.
"""
import struct
import sys

import h5py
import numpy as np

VECTOR, TIME = 1e-7, 1e-9                         # tolerances
ENERGY = 10                                       # of energies, times that of vectors
FLOOR = 1e-6                                      # smallest peak that counts, of its class's
TITLE = {3040: 40, 3041: 80, 3050: 100, 4021: 100}
NODE, SPRING, RBODY = 0, 6, 103
GROUP = {None: "", SPRING: "joint", RBODY: "rigid_body", NODE: "node"}
ENTITY = {SPRING: "joint", RBODY: "body", NODE: "node"}

# dataset: code of its first component in the T01, number of components, class
CHANNELS = {
    None: {
        "time_step": (7, 1, "control"), "mass": (6, 1, "control"),
        "kinetic_energy_trans": (2, 1, "energy"), "kinetic_energy_rot": (8, 1, "energy"),
        "internal_energy": (1, 1, "energy"), "external_work": (9, 1, "energy"),
        "momentum_xyz": (3, 3, "momentum")},
    SPRING: {
        "force": (2, 3, "force"), "moment": (5, 3, "moment"),
        "displacement": (8, 3, "displacement"), "rotation": (11, 3, "rotation"),
        "internal_energy": (14, 1, "energy"), "length": (65, 1, "displacement")},
    RBODY: {
        "impulse": (1, 3, "impulse"), "angular_impulse": (4, 3, "angular impulse"),
        "rotation_sum": (7, 3, "rotation"), "position": (16, 3, "displacement"),
        "velocity": (22, 3, "velocity"), "acceleration": (25, 3, "acceleration"),
        "angular_velocity": (28, 3, "angular velocity"),
        "angular_acceleration": (31, 3, "angular acceleration")},
    NODE: {
        "displacement": (1, 3, "displacement"), "velocity": (4, 3, "velocity"),
        "acceleration": (7, 3, "acceleration"), "angular_velocity": (10, 3, "angular velocity"),
        "angular_acceleration": (13, 3, "angular acceleration"),
        "position": (16, 3, "displacement")},
}


def records(path):
    """Payloads of the records of a Fortran unformatted file."""
    with open(path, "rb") as file:
        data = file.read()
    at = 0
    while at + 4 <= len(data):
        n = struct.unpack_from("<i", data, at)[0]
        if at + 8 + n > len(data):
            return
        yield data[at + 4:at + 4 + n]
        at += 8 + n


def read_t01(path):
    """Times, and {type: {id: {code: series}}} with type None, id 0 for the globals."""
    rec = records(path)

    def ints(payload, n):
        return list(struct.unpack_from(f"<{n}i", payload))

    code = ints(next(rec), 1)[0]
    name = 2 * TITLE[code]                        # 4 characters fill a word of 8 bytes
    next(rec)
    if code in (3050, 4021):
        for _ in range(ints(next(rec), 1)[0]):
            next(rec)
    n_part, n_mat, n_prop, n_subset, n_group, n_glob = ints(next(rec), 6)
    sizes = []                                    # of the records of a row: (type, ids, codes)
    if n_glob:
        sizes.append((None, [0], ints(next(rec), n_glob)))
    n_part_value = 0
    for _ in range(n_part):
        n_var = ints(next(rec)[4 + name:], 4)[3]
        if n_var:
            next(rec)
        n_part_value += n_var
    for _ in range(n_mat + n_prop):
        next(rec)
    n_subset_value = 0
    for _ in range(n_subset):
        _, _, n_child, n_own, n_var = ints(next(rec), 5)
        for n in (n_child, n_own, n_var):
            if n:
                next(rec)
        n_subset_value += n_var
    for n in (n_part_value, n_subset_value):
        if n:
            sizes.append(("skip", [0], [0] * n))
    for _ in range(n_group):
        _, kind, _, n_object, n_var = ints(next(rec), 5)
        ids = [ints(next(rec), 1)[0] for _ in range(n_object)]
        codes = ints(next(rec), n_var) if n_var else []
        if ids and codes:
            sizes.append((kind, ids, codes))
    return read_rows(rec, sizes)


def read_rows(rec, sizes):
    times, blocks = [], [[] for _ in sizes]
    for payload in rec:
        times.append(struct.unpack("<d", payload)[0])
        for block in blocks:
            block.append(np.frombuffer(next(rec), "<f8"))
    found = {}
    for (kind, ids, codes), block in zip(sizes, blocks):
        if kind == "skip":
            continue
        values = np.array(block).reshape(len(times), len(ids), len(codes))
        for i, user_id in enumerate(ids):
            series = found.setdefault(kind, {}).setdefault(user_id, {})
            series.update({code: values[:, i, j] for j, code in enumerate(codes)})
    return np.array(times), found


def read_h5(run, kind, name, n_comp):
    """{id: series (time, n_comp)} of one dataset of the history; springs have a group of their own."""
    if kind == SPRING and "spring" in run:
        group = run["spring"]
        series = {int(user_id): group[name][:, i].reshape(-1, n_comp)
                  for i, user_id in enumerate(group["spring"][:]) if name in group}
        return (series | read_h5({key: run[key] for key in run if key != "spring"}, kind, name, n_comp)
                if "joint" in run else series)
    group = run[GROUP[kind]] if GROUP[kind] else run
    if name == "momentum_xyz":
        return {0: np.stack([group[f"momentum_{c}"][:] for c in "xyz"], axis=1)}
    values = group[name][:]
    if kind is None:
        return {0: values.reshape(-1, 1)}
    ids = group[ENTITY[kind]][:]
    return {int(user_id): values[:, i].reshape(-1, n_comp) for i, user_id in enumerate(ids)}


def compare(t01_path, h5_path, tolerance):
    """Yield lines (what, error / tolerance, place of the worst) of every channel."""
    times, ref = read_t01(t01_path)
    with h5py.File(h5_path, "r") as run:
        keep = run["final"][:] == 0 if "final" in run else np.ones(len(run["time"]), bool)
        keep[:len(times)] = True
        t = run["time"][:][keep]
        if len(t) != len(times):
            yield f"samples: {len(times)} in the T01, {len(t)} in the history", np.inf, 0
            return
        off = np.abs(t - times) / np.maximum(TIME * times, 1e-300)
        off[t == times] = 0
        yield "time", off.max(), off.argmax()
        g = ref[None][0]
        energy = np.max(g[2] + g[8] + np.abs(g[1]) + np.abs(g[9]))
        rows = []
        for kind, channels in CHANNELS.items():
            for name, (first, n_comp, quantity) in channels.items():
                for user_id, series in ref.get(kind, {}).items():
                    if all(first + c in series for c in range(n_comp)):
                        old = np.stack([series[first + c] for c in range(n_comp)], axis=1)
                        rows.append((kind, name, n_comp, quantity, user_id, old))
        largest = {}
        for _, _, _, quantity, _, old in rows:
            peak = np.sqrt((old**2).sum(axis=1)).max()
            largest[quantity] = max(largest.get(quantity, 0), peak)
        for kind, name, n_comp, quantity, user_id, old in rows:
            what = f"{GROUP[kind]}/{name}[{user_id}]"
            try:
                new = read_h5(run, kind, name, n_comp)[user_id][keep]
            except KeyError:
                if not old.any():                     # springs of TYPE4 have no moments
                    continue
                yield what + " is missing", np.inf, 0
                continue
            peak = max(np.sqrt((old**2).sum(axis=1)).max(), FLOOR * largest[quantity])
            limit = tolerance * (ENERGY * energy if quantity == "energy" else peak)
            off = np.abs(new - old).max(axis=1)
            off = np.where(off == 0, 0, off / max(limit, 1e-300))
            off[np.isnan(off)] = np.inf
            yield what, off.max(), off.argmax()


def main(t01_path, h5_path, tolerance=VECTOR):
    found = sorted(compare(t01_path, h5_path, float(tolerance)), key=lambda line: -line[1])
    print("error/tolerance  sample  channel")
    for what, off, where in found[:20]:
        print(f"{off:15.3e}  {where:6d}  {what}")
    bad = sum(1 for line in found if not line[1] <= 1)
    verdict = "DIFFERENT" if bad else "SAME"
    print(f"{verdict}: {bad} of {len(found)} channels over their tolerance, worst {found[0][0]} "
          f"{found[0][1]:.3e} of the tolerance")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) in (3, 4) else __doc__)
