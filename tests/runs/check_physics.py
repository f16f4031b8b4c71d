#!/usr/bin/env python3
"""Histories against themselves and against the laws of motion.

usage: check_physics.py KJOINT WORK_DIR      (needs numpy and h5py; exit 1 on a violation)

Every cycle is sampled. Legacy: a leapfrog, so x(n+1) - x(n) = h v(n+1) and v(n+1) - v(n) = h12 a(n)
to rounding, impulse(n) - impulse(n-1) = h force(n). Consistent: everything at t, so the same
differences hold with the mean of both ends up to h^2 over the time scale of the motion, and nodes
ride on the pose exactly.
"""
import json
import os
import pathlib
import subprocess
import sys

import h5py
import numpy as np

SOURCE = pathlib.Path(os.environ["KJOINT_SOURCE_DIR"])
sys.path.insert(0, str(SOURCE / "tools"))
import bench_scenes

failed = []


def check(name, value, limit):
    ok = value <= limit
    print(f"{'ok    ' if ok else 'FAILED'} {name:58s} {value:9.2e} <= {limit:7.1e}")
    if not ok:
        failed.append(name)


def run(kjoint, work, case, *options):
    path = work / f"{case}.h5"
    deck = next((SOURCE / "tests").glob(f"parity*/{case}/{case}_0000.rad"), SOURCE / f"decks/{case}_0000.rad")
    with open(work / f"{case}.log", "w") as log:
        subprocess.run([kjoint, "run", deck, "-q", "-o", path, "--sample", "0", *options], check=True, stderr=log)
    return h5py.File(path)


def rotate(q, r):
    """r turned by the quaternions q (n, 4)."""
    t = 2 * np.cross(q[:, 1:], r)
    return r + q[:, :1] * t + np.cross(q[:, 1:], t)


def momentum(file, name):
    """Linear momentum is constant; forces and moments of both bodies cancel in every cycle."""
    p = np.stack([file[f"momentum_{axis}"][:] for axis in "xyz"], axis=1)
    check(f"{name}: momentum over {len(p)} cycles", np.linalg.norm(p - p[0], axis=1).max() / np.linalg.norm(p[0]), 1e-12)
    body = file["rigid_body"]
    f, m, x = body["force"][:], body["moment"][:], body["position"][:]
    check(f"{name}: sum of the forces", (np.linalg.norm(f.sum(axis=1), axis=1) /
          np.linalg.norm(f, axis=2).sum(axis=1).clip(1e-30)).max(), 1e-14)
    about_origin = m + np.cross(x, f)
    size = (np.linalg.norm(m, axis=2) + np.linalg.norm(x, axis=2) * np.linalg.norm(f, axis=2)).sum(axis=1)
    check(f"{name}: sum of the moments about the origin", (np.linalg.norm(about_origin.sum(axis=1), axis=1) /
          size.clip(1e-30)).max(), 1e-14)


def angular_momentum(file, name):
    l = np.stack([file[f"angular_momentum_{axis}"][:] for axis in "xyz"], axis=1)
    check(f"{name}: angular momentum", np.linalg.norm(l - l[0], axis=1).max() / np.linalg.norm(l[0]), 1e-12)


def legacy(file, name):
    t, h = file["time"][:], file["time_step"][:]
    x, v, a = (file["node"][c][:] for c in ("position", "velocity", "acceleration"))
    dt = np.diff(t)[:, None, None]
    check(f"{name}: x(n+1) - x(n) = h v(n+1)", abs(np.diff(x, axis=0) - dt * v[1:]).max(), 4e-15 * abs(x).max())
    h12 = np.concatenate([[h[0] / 2], (h[1:-1] + h[:-2]) / 2])[:, None, None]
    check(f"{name}: v(n+1) - v(n) = h12 a(n)", abs(np.diff(v, axis=0) - h12 * a[:-1]).max(), 1e-12 * abs(v).max())
    impulse, force = file["rigid_body/impulse"][:, 1], file["rigid_body/force"][:, 1]
    weight = file["rigid_body/mass"][1] * np.array([0, 0, -9.81])
    check(f"{name}: d(impulse)/dt = force", abs(np.diff(impulse, axis=0) / dt[:, :, 0] - (force[1:] - weight)).max(),
          1e-9 * abs(force).max())
    # a node drifts outward by (w h)^4/8 of its radius a cycle, and its cloud turns by (w h)^3/3 too little or far
    turn = (np.linalg.norm(file["rigid_body/angular_velocity"][:, 1], axis=1) * h).max()
    nodes_ride(file, name, len(t) * turn**3)


def last_row_of_a_stop(kjoint, work):
    """/DT/NODA/STOP ends a run in a cycle that nobody foresaw: its row is that of a run with a row each cycle.

    The step of PLA01 falls from 1.51937e-4 to 1.51917e-4 within 841 of its 3291 cycles."""
    rows = []
    source = SOURCE / "tests" / "parity" / "PLA01"
    (work / "PLA01_0000.rad").write_text((source / "PLA01_0000.rad").read_text())
    (work / "PLA01_0001.rad").write_text((source / "PLA01_0001.rad").read_text() + "/DT/NODA/STOP\n0.9 1.5192e-4\n")
    for sample in ("0", "1"):
        path = work / f"PLA01_{sample}.h5"
        subprocess.run([kjoint, "run", work / "PLA01_0000.rad", "-q", "--legacy", "-o", path, "--sample", sample],
                       check=True, stderr=subprocess.DEVNULL)
        with h5py.File(path) as file:
            rows.append({f"{group}/{name}": values[-1] for group in ("joint", "rigid_body", "node")
                         for name, values in file[group].items() if values.maxshape[0] is None})
            cycles = int(file["cycle"][-1])
    check("/DT/NODA/STOP: cycles", cycles, 841)
    worst = max(abs(a - b).max() for a, b in ((rows[0][key], rows[1][key]) for key in rows[0]))
    check(f"/DT/NODA/STOP: {len(rows[0])} channels of the last row", worst, 0.0)


def steps_of_many(kjoint, work):
    """1300 equal pendulums on one ground take the steps of 20: they are shorter at the start, until about half of
    the run, and however large the scene is, the step is looked at again every few cycles."""
    cycles = []
    for n in (20, 1300):
        bench_scenes.write("forest", n, work / f"forest{n}", until=0.08, sample=0.08)
        run = subprocess.run([kjoint, "run", work / f"forest{n}_0000.rad", "-q", "--json", "-o", work / "forest.h5"],
                             check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        cycles.append(json.loads(run.stdout)["cycles"])
    check(f"steps of 20 and 1300 pendulums: {cycles[0]}", abs(cycles[1] - cycles[0]), 1)


def consistent(file, name):
    t = file["time"][:]
    x, v, a = (file["node"][c][:] for c in ("position", "velocity", "acceleration"))
    dt = np.diff(t)[:, None, None]
    # trapezoids: the error is h^2/12 of the second derivative, bounded by the jump of a or of its difference
    rough = abs(np.diff(a, axis=0)).max()
    check(f"{name}: x(n+1) - x(n) = h (v + v)/2", (abs(np.diff(x, axis=0) / dt - (v[1:] + v[:-1]) / 2)).max(),
          0.3 * dt.max() * rough)
    check(f"{name}: v(n+1) - v(n) = h (a + a)/2", (abs(np.diff(v, axis=0) / dt - (a[1:] + a[:-1]) / 2)).max(), 0.3 * rough)
    impulse, force = file["rigid_body/impulse"][:, 1], file["rigid_body/force"][:, 1]
    weight = file["rigid_body/mass"][1] * np.array([0, 0, -9.81])
    mean = (force[1:] + force[:-1]) / 2 - weight
    check(f"{name}: d(impulse)/dt = mean force", abs(np.diff(impulse, axis=0) / dt[:, :, 0] - mean).max(), 1e-10 * abs(force).max())
    nodes_ride(file, name, 1e-12)


def nodes_ride(file, name, limit):
    """Nodes 201 and 202 against the pose of body 2."""
    q, c = file["rigid_body/orientation"][:, 1], file["rigid_body/position"][:, 1]
    x = file["node/position"][:]
    ids = list(file["node/node"][:])
    for node in (201, 202):
        k = ids.index(node)
        expected = c + rotate(q, rotate(q[:1] * [1, -1, -1, -1], x[0, k] - c[0])[0])   # q[0]: joints bear forces
        check(f"{name}: node {node} rides on its body", abs(x[:, k] - expected).max(), limit)


def force_in_its_frame(file, name):
    """The components of a joint's force in its frame are the force on the body of node 1, however far it turned"""
    turned = rotate(file["joint/frame"][:, 0], file["joint/force"][:, 0])
    on_body = file["rigid_body/force"][:, 0]
    check(f"{name}: force in its frame", abs(turned - on_body).max(), 1e-14 * abs(on_body).max())
    check(f"{name}: 2 rad less how far it turned", 2.0 - abs(file["joint/rotation"][:]).max(), 0.0)


def length_of_a_slider(file, name):
    """Both nodes of the joint, fixed to bodies, stand at one place at the start: their distance is the displacement."""
    length, moved = file["joint/length"][:, 0], np.linalg.norm(file["joint/displacement"][:, 0], axis=1)
    check(f"{name}: length and displacement", abs(length - moved).max(), 1e-9 * moved.max())
    check(f"{name}: a tenth less how far it went", 0.1 - moved.max(), 0.0)


def main(kjoint, work):
    work = pathlib.Path(work)
    work.mkdir(parents=True, exist_ok=True)
    with run(kjoint, work, "UNI04", "--legacy", "--until", "1.7") as file:
        p = np.stack([file[f"momentum_{axis}"][:] for axis in "xyz"], axis=1)
        check(f"UNI04 legacy: momentum over {len(p)} cycles", np.linalg.norm(p - p[0], axis=1).max() /
              np.linalg.norm(p[0]), 1e-12)
    with run(kjoint, work, "UNI04", "--until", "2") as file:
        momentum(file, "UNI04 consistent")
        angular_momentum(file, "UNI04 consistent")
    with run(kjoint, work, "REV03", "--legacy") as file:
        legacy(file, "REV03 legacy")
    with run(kjoint, work, "SPH07") as file:   # equal springs: shown in the mean frame
        force_in_its_frame(file, "SPH07 consistent")
    for formulation in ("consistent", "legacy"):
        with run(kjoint, work, "translational_slider", "--formulation", formulation, "--until", "0.3") as file:
            length_of_a_slider(file, f"slider {formulation}")
    last_row_of_a_stop(kjoint, work)
    steps_of_many(kjoint, work)
    with run(kjoint, work, "REV03") as file:
        consistent(file, "REV03 consistent")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 3 else __doc__)
