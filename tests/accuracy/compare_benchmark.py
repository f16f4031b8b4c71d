#!/usr/bin/env python3
"""Compare a history with the exact reference of a benchmark, channel group by channel group.

usage: compare_benchmark.py reference.csv RUN.h5 [limits.json CASE]   (exit 1 above a limit)

Prints the largest absolute error of each group: node/position, node/velocity,
rbody/angular_velocity, joint/displacement, joint/rotation, and that of the linear momentum over its
size. Times of the reference that the run does not have are left out; at least nine tenths of them
must be there. Beside the limits, the cases of FIVE_TIMES must be five times better than what
OpenRadioss showed at its default step: the figures of the table in the about.md of the case.
"""
import csv
import json
import pathlib
import re
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
FIVE_TIMES = ("CARD01", "DZHA01", "DZHA02", "HTOP01", "HTOP02")
ABOUT = {"position": "node/position", "velocity": "node/velocity", "angular velocity": "rbody/angular_velocity",
         "joint angle": "joint/rotation", "joint displacement": "joint/displacement"}
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
            if name.startswith("global/"):
                continue
            owner, ident, component = name.split()[0].split("/")
            group, k = NAMES[component]
            path, entity = PATH[owner]
            row = list(file[f"{path}/{entity}"][:]).index(int(ident))
            found = file[f"{path}/{group.split('/')[1]}"][:, row, k][place]
            error = abs(found - data[:, column])[met]
            worst[group] = max(worst.get(group, 0.0), error.max() if np.isfinite(error).all() else np.inf)
        columns = [head.index(f"global/{axis}mom") for axis in "xyz" if f"global/{axis}mom" in head]
        if columns:
            momentum = np.stack([file[f"momentum_{axis}"][:] for axis in "xyz"], axis=1)
            error = np.linalg.norm(momentum[place] - data[:, columns], axis=1)[met]
            worst["momentum"] = error.max() / np.linalg.norm(data[0, columns])
    return worst


def legacy_figures(about):
    """Errors of OpenRadioss at its default step: first column of the table of an about.md."""
    figures = {}
    for line in pathlib.Path(about).read_text(encoding="utf-8").splitlines():
        row = re.match(r"\| ([a-z ]+) \[[^]]*\] \| *([0-9.e+-]+) \|", line)
        if row and row[1] in ABOUT:
            figures[ABOUT[row[1]]] = float(row[2])
    return figures


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
    if case in FIVE_TIMES:
        legacy = legacy_figures(pathlib.Path(reference).with_name("about.md"))
        for group in set(worst) & set(bound):
            gain = legacy[group] / worst[group]
            failed |= not gain >= 5.0
            print(f"{group:24s} {gain:10.1f} times better than OpenRadioss" + ("" if gain >= 5.0 else "  TOO LITTLE"))
    for group in set(bound) - set(worst):
        print(f"{group:24s} is not in the reference")
        failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) in (3, 5) else __doc__)
