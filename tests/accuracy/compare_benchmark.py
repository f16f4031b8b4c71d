#!/usr/bin/env python3
"""Compare a history with the exact reference of a benchmark, channel group by channel group.

usage: compare_benchmark.py reference.csv RUN.h5 [limits.json CASE]   (exit 1 above a limit)

Prints the largest absolute error of each group: node/position, node/velocity,
rbody/angular_velocity, joint/displacement, joint/rotation, and the change of the linear momentum
relative to its size. Times of the reference that the run does not have are left out; at least
nine tenths of them must be there.
"""
import csv
import json
import sys

import h5py
import numpy as np

NAMES = {"x": ("node/position", 0), "y": ("node/position", 1), "z": ("node/position", 2),
         "vx": ("node/velocity", 0), "vy": ("node/velocity", 1), "vz": ("node/velocity", 2),
         "wx": ("rbody/angular_velocity", 0), "wy": ("rbody/angular_velocity", 1),
         "wz": ("rbody/angular_velocity", 2)}
for axis, k in zip("xyz", range(3)):
    NAMES["l" + axis] = ("joint/displacement", k)
    NAMES["r" + axis] = ("joint/rotation", k)
PATH = {"node": ("node", "node"), "rbody": ("rigid_body", "body"), "joint": ("joint", "joint")}


def errors_of(reference, run):
    """Largest absolute error of each channel group."""
    with open(reference, newline="") as stream:
        rows = list(csv.reader(stream))
    head, data = rows[0], np.array(rows[1:], dtype=float)
    worst = {}
    with h5py.File(run) as file:
        time = file["time"][:]
        place = np.searchsorted(time, data[:, 0] - 1e-9 * data[-1, 0])
        place[place == len(time)] = len(time) - 1
        met = abs(time[place] - data[:, 0]) <= 1e-9 * data[-1, 0]
        if met.mean() < 0.9:
            sys.exit(f"{run}: only {met.sum()} of {len(met)} times of the reference")
        for column, name in enumerate(head[1:], start=1):
            owner, ident, component = name.split()[0].split("/")
            group, k = NAMES[component]
            path, entity = PATH[owner]
            row = list(file[f"{path}/{entity}"][:]).index(int(ident))
            found = file[f"{path}/{group.split('/')[1]}"][:, row, k][place]
            error = abs(found - data[:, column])[met]
            worst[group] = max(worst.get(group, 0.0), error.max() if np.isfinite(error).all() else np.inf)
        momentum = np.stack([file[f"momentum_{axis}"][:] for axis in "xyz"], axis=1)
        size = np.linalg.norm(momentum[0])
        if size > 0:
            worst["momentum"] = np.linalg.norm(momentum - momentum[0], axis=1).max() / size
    return worst


def main(reference, run, limits=None, case=None):
    worst = errors_of(reference, run)
    bound = json.load(open(limits))[case] if limits else {}
    failed = False
    for group, value in worst.items():
        if limits and group not in bound:
            continue
        limit = bound.get(group)
        over = limit is not None and not value <= limit
        failed |= over
        print(f"{group:24s} {value:10.2e}" + (f"  limit {limit:8.1e}  {'OVER' if over else 'ok'}" if limit else ""))
    for group in set(bound) - set(worst):
        print(f"{group:24s} is not in the reference")
        failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) in (3, 5) else __doc__)
