#!/usr/bin/env python3
"""Places of joints and bodies: enough to draw a mechanism at any sample.

usage: check_places.py KJOINT

A body carries its points: X = position + R(orientation) p. From these the place of a joint must be the
middle of its two nodes, in both formulations; and each node that a joint holds must hang on the centre
of its body by a segment.
"""
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).parents[2]
CASES = [("decks/slider_crank_0000.rad", []), ("decks/slider_crank_0000.rad", ["--legacy"]),
         ("decks/oldham_coupling_0000.rad", []), ("tests/parity/UNI05/UNI05_0000.rad", ["--legacy"]),
         ("tests/parity/SK201/SK201_0000.rad", [])]


def turned(q, p):
    """R(q) p for each row of quaternions w x y z."""
    u = q[:, 1:]
    return p + 2.0 * np.cross(u, np.cross(u, p) + q[:, :1] * p)


def check(path):
    with h5py.File(path) as run:
        bodies = list(run["rigid_body/body"])
        node, owner = run["point/node"][()], run["point/body"][()]
        place, size = {}, 0.0
        for k, p in enumerate(run["point/position"]):
            b = bodies.index(owner[k])
            place[node[k]] = run["rigid_body/position"][:, b] + \
                turned(run["rigid_body/orientation"][:, b], p)
            size = max(size, np.linalg.norm(p))
        joint = run["joint"]
        worst, n = 0.0, 0
        for j in range(len(joint["joint"])):
            ends = [joint["node1"][j], joint["node2"][j]]
            if not set(ends) <= set(place):
                continue                        # a free node is no point of a body
            n += 1
            middle = 0.5 * (place[ends[0]] + place[ends[1]])
            worst = max(worst, abs(joint["position"][:, j] - middle).max())
        joined = {tuple(node[[a, b]]) for a, b in zip(run["segment/point1"], run["segment/point2"])}
        main = dict(zip(run["rigid_body/body"], run["rigid_body/main_node"]))
        for end in (1, 2):
            for body, held in zip(joint[f"body{end}"], joint[f"node{end}"]):
                if main.get(body, held) != held and (main[body], held) not in joined:
                    return f"{path}: no segment to node {held} of body {body}"
        # legacy moves nodes by their velocities: they drift by the square of the angle of a step
        legacy = joint["velocity"].attrs["sampled_at"] != "t"
        if n == 0 or not worst < (1e-4 if legacy else 1e-12) * size:
            return f"{path}: joints are {worst:.2e} off the middle of their nodes, arms {size:.2e}"
    return ""


def main(kjoint):
    problems = []
    with tempfile.TemporaryDirectory() as folder:
        for deck, options in CASES:
            history = pathlib.Path(folder) / "run.h5"
            subprocess.run([kjoint, "run", "-q", ROOT / deck, "-o", history, *options], check=True)
            problem = check(history)
            if problem:
                problems.append(f"{deck} {' '.join(options)}: {problem}")
    print("\n".join(problems) or f"{len(CASES)} runs: joints are where their nodes are")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
