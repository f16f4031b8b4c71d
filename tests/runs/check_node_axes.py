#!/usr/bin/env python3
"""A node that the deck asks for in several axes is written in each of them.

usage: check_node_axes.py KJOINT

A disc turns at w = 3 rad/s about z through the origin, on a hinge whose gap under the centrifugal force
is m w^2 r/Kn = 3 9 0.3/1e6 = 8e-6 m, and twice that while it rings; that slows it by 2 m r gap/J = 4.5e-5 with J = 0.32 about the
hinge, so after 1.5 rad the tip is 0.5 1.5 4.5e-5 = 3.4e-5 m behind. Its tip stands at r = 0.5 m. With a = w t:

    global, and a skew fixed along the global axes at another origin    x = r (cos a, sin a, 0)
    a skew that rides on the disc                                       x = r (1, 0, 0), v = r w (0, 1, 0)

and a node of the wall, 0.1 m up the axis, is at rest: in the axes of the disc x = (0, 0, 0.1).
"""
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

HERE = pathlib.Path(__file__).parent
GAP, BEHIND = 2e-5, 4e-5


def check(run):
    node = run["node"]
    t = run["time"][()]
    if list(node["node"]) != [102, 202, 202, 202] or list(node["skew"]) != [5, 0, 6, 5]:
        return f"nodes {list(node['node'])} in skews {list(node['skew'])}"
    labels = [name.decode() for name in node["label"]]
    if labels != ["wall", "tip", "tip at 1 2 3", "tip on the disc"]:
        return f"labels {labels}"
    a, one = 3.0 * t, np.ones_like(t)
    fixed = 0.5 * np.stack([np.cos(a), np.sin(a), 0 * t], 1)
    rides = np.stack([0.5 * one, 0 * t, 0 * t], 1)
    # legacy turns by its own steps: the angle is off by half of one
    off = 1e-3 if node["velocity"].attrs["sampled_at"] != "t" else BEHIND
    for k, expected, most in ((0, np.stack([0 * t, 0 * t, 0.1 * one], 1), 1e-12),
                              (1, fixed, off), (2, fixed, off), (3, rides, GAP)):
        worst = abs(node["position"][:, k] - expected).max()
        if worst > most:
            return f"position of {labels[k]} is {worst:.1e} off"
    # the ringing gap has the speed gap sqrt(Kn/m) = 8e-6 sqrt(1e6/2.9) = 5e-3
    if abs(node["velocity"][:, 3] - [0.0, 1.5, 0.0]).max() > 1e-2:
        return "velocity of the tip on the disc"
    return ""


def main():
    kjoint = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        for words in ([], ["--legacy"]):
            path = f"{folder}/run.h5"
            subprocess.run([kjoint, "run", *words, "-q", "-o", path, str(HERE / "node_axes_0000.rad")],
                           check=True)
            with h5py.File(path) as run:
                wrong = check(run)
            if wrong:
                raise SystemExit(f"{' '.join(words)}: {wrong}")
            # the second 202 is compared with the second, not with the first
            said = subprocess.run([kjoint, "diff", path, path, "--profile", "exact"], capture_output=True,
                                  text=True).stdout
            if not said.splitlines()[-1].startswith("SAME"):
                raise SystemExit(said)


main()
