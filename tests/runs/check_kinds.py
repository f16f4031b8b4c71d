#!/usr/bin/env python3
"""Stops and friction of /PROP/KJOINT2 in joints of all types, and the decks of tests/parity45, under the
consistent formulation.

usage: check_kinds.py KJOINT WORK_DIR      (needs numpy and h5py; exit 1 on a violation)

The expected numbers follow from the data of the scenes. Units: kg, m, s.
"""
import os
import pathlib
import sys

import h5py
import numpy as np

from limit_scene import (CYLINDRICAL, FREE, FREE_DOFS, OLDHAM, PLANAR, REVOLUTE, SPHERICAL, TRANSLATIONAL, UNIVERSAL,
                         Body, Scene, check, dof, energy, failed, joint, starter)

SOURCE = pathlib.Path(os.environ.get("KJOINT_SOURCE_DIR", pathlib.Path(__file__).parents[2]))


def friction_angle(scene):
    """J = 1/2, 3 rad/s, M = 2 N m about one axis: J w^2/(2 M) = 1.125 rad, less M/(2 k) = 5e-6 rad that the
    spring gives back; it rings by M/k, which Cr damps. A universal joint turns about y on body 1, about z on
    body 2, here x and y of the scene."""
    rough = dof(stiffness=2e5, limit=2.0)
    for name, kind, axis, at in (("hinge", REVOLUTE, 0, 0), ("ball", SPHERICAL, 1, 1), ("tube", CYLINDRICAL, 0, 0),
                                 ("cross_y", UNIVERSAL, 0, 1), ("cross_z", UNIVERSAL, 1, 2)):
        spin = 3.0 * np.eye(3)[axis]
        for integrator in ("split2", "liemid"):
            dofs = [dof(), rough] if kind == CYLINDRICAL else [rough] * FREE_DOFS[kind]
            file = scene.run(f"{name}_{integrator}", starter([Body(spin=spin)], joint(kind, dofs, cr=0.3)), 1.2,
                             options=("--integrator", integrator))
            angle = file["joint/rotation"][:, 0, at]
            check(f"{name}, {integrator}: stops at 1.125 rad", abs(angle[-1] - 1.125), 1e-4)
            check(f"{name}, {integrator}: friction took 2.25 J", abs(file["joint/friction_energy"][-1, 0] / 2.25 - 1), 1e-4)


def friction_ball(scene):
    """A ball joint with 0.3 N m about each of its axes: whatever the pose, the moment on the body is 0.3 sqrt(3)
    while all three slide, turns are not counted, and friction takes all of J w^2/2 = 1/4 (36 + 9 + 2.25) J in
    the end. 6 rad/s and 0.6 rad/s^2 about x alone make 30 rad."""
    prop = joint(SPHERICAL, [dof(stiffness=1e4, limit=0.3)] * 3, cr=0.3)
    file = scene.run("ball_far", starter([Body(spin=(6.0, 3.0, 1.5))], prop), 12.0)
    sliding = np.all(file["joint/state"][:, 0, 3:] == 1, axis=1)
    sliding[0] = False
    moment = np.linalg.norm(file["rigid_body/moment"][sliding, 0], axis=1)
    check("ball_far: slides about all axes for a second", -float(sliding.sum()), -500.0)
    check("ball_far: moment while it slides", abs(moment / (0.3 * np.sqrt(3.0)) - 1.0).max(), 1e-12)
    check("ball_far: turns more than once", -file["rigid_body/rotation_sum"][:, 0, 0].max(), -2.0 * np.pi)
    check("ball_far: friction took all", abs(file["joint/friction_energy"][-1, 0] / 11.8125 - 1.0), 1e-3)


def stop_liemid(scene):
    """The pendulum of check_limits.py with the other integrators."""
    prop = joint(REVOLUTE, [dof(low=-1.0, high=1.0, stiffness=1e4)], kn=1e6)
    for integrator in ("liemid", "rkmk4"):
        file = scene.run(f"pendulum_{integrator}", starter([Body(centre=(0, 0.5, 0))], prop, gravity=9.81), 1.5,
                         options=("--integrator", integrator))
        angle, rate = file["joint/rotation"][:, 0, 0], file["joint/angular_velocity"][:, 0, 0]
        hits = np.flatnonzero((rate[:-1] < 0.0) & (rate[1:] >= 0.0) & (angle[1:] < -0.98))
        between = np.arange(hits[0] + 5, hits[1] - 5)
        fall = 2.0 * 9.81 * 0.5 * np.sin(1.0)
        check(f"{integrator}: swings back with its energy", abs(energy(file)[between].mean() - energy(file)[0]) / fall,
              1e-3)
        check(f"{integrator}: comes back to where it began", abs(angle[between].max()), 1e-3)


def rebound(cr, k, m, v):
    """Speed after a stop whose damper is no stronger than its spring: Runge-Kutta in small steps."""
    c, h = cr * np.sqrt(k * m), 1e-3 * np.sqrt(m / k)

    def rate(y):
        return np.array([y[1], -(k * y[0] + np.sign(y[1]) * min(c * abs(y[1]), k * y[0])) / m])

    y = np.array([0.0, v])
    while y[0] >= 0.0:
        a = rate(y)
        b = rate(y + 0.5 * h * a)
        d = rate(y + 0.5 * h * b)
        y = y + h / 6.0 * (a + 2.0 * b + 2.0 * d + rate(y + h * d))
    return -y[1]


def damped_stop(scene):
    """2 kg at 1 m/s against a stop with Cr 0.3. Combined stops damp the motion towards them only: at 45
    degrees onto the circle the way along it goes on."""
    k, v = 1e4, rebound(0.3, 1e4, 2.0, 1.0)
    check("rebound: less than 1, more than exp(-pi Cr/2)", abs(v - 0.5 * (1.0 + np.exp(-0.15 * np.pi))),
          0.5 * (1.0 - np.exp(-0.15 * np.pi)))
    stop = dof(low=-0.1, high=0.1, stiffness=k)
    for name, kind, dofs in (("buffer", TRANSLATIONAL, [stop]), ("ring", PLANAR, [stop, stop])):
        along = np.array([1.0, 0.0, 0.0] if kind == TRANSLATIONAL else [0.0, 0.6, 0.8])
        file = scene.run(name, starter([Body(velocity=along)], joint(kind, dofs if kind == TRANSLATIONAL else
                         [dof(low=-0.1, high=0.1, stiffness=k, combined=1)] * 2, cr=0.3, kn=1e6)), 0.18)
        velocity, f = file["joint/velocity"][:, 0] @ along, file["joint/force"][:, 0] @ along
        check(f"{name}: comes back with the speed of a damped stop", abs(-velocity[-1] / v - 1.0), 5e-3)
        check(f"{name}: the stop does not pull [of its push]", -min(0.0, f.min()) / f.max(), 1e-3)
        lost = file["joint/dissipated_energy"][-1, 0]
        check(f"{name}: the loss is dissipated", abs(lost / (1.0 - v**2) - 1.0), 1e-2)


def whirl(scene):
    """A puck inside a circle of 0.3 m (combined stops): the stop pushes to the centre, so energy and angular
    momentum about it stay, damped or not. It meets the circle obliquely, again and again. The least of the
    radii and the largest of the stiffnesses count."""
    ring = [dof(low=-r, high=r, stiffness=stiffness, combined=1) for r, stiffness in ((0.35, 1e4), (0.3, 5e3))]
    for name, cr in (("whirl", 1e-9), ("whirl_damped", 0.4)):
        body = Body(velocity=(0, 1.0, 0.5), centre=(0, 0, 0))
        file = scene.run(name, starter([body], joint(PLANAR, ring, kn=1e6, cr=cr), extra=push()), 3.0)
        x, v = file["rigid_body/position"][:, 0], file["rigid_body/velocity"][:, 0]
        late = file["time"][:] > 0.11
        moment = (x[:, 1] * v[:, 2] - x[:, 2] * v[:, 1])[late]
        # pushed by 5 m/s^2: 0.1 (0.5 + 0.5) - (0.05 + 0.025) 1
        check(f"{name}: passes the centre at a distance [m^2/s]", abs(moment[0] - 0.025), 2e-4)
        check(f"{name}: angular momentum", abs(moment / moment[0] - 1.0).max(), 1e-9)
        check(f"{name}: stays in the circle", np.hypot(x[:, 1], x[:, 2]).max(), 0.3 + np.sqrt(2.0 * 3.0 / 1e4))
        gap, state = file["joint/gap"][:, 0, 1:], file["joint/state"][:, 0, 1:3]
        check(f"{name}: gap to the circle", abs(gap.T - (0.3 - np.hypot(x[:, 1], x[:, 2]))).max(), 1e-12)
        check(f"{name}: at the stop (3) where the gap is gone", float(np.any((gap < 0.0) != (state == 3))), 0.0)
        e = energy(file) - file["external_work"][:]
        check(f"{name}: energy", abs(e[late] / e[late][0] - 1.0).max(), 1e-3)


def push():
    """10 N along y for 0.1 s on body 2."""
    def row(t, f):
        return f"{t:20.12g}{f:20.12g}"

    return ["/FUNCT/7", "push", row(0, 1), row(0.1, 1), row(0.1000001, 0), row(9, 0), "/GRNOD/NODE/1999", "puck",
            f"{200:10d}", "/CLOAD/1", "push", f"{7:10d}{'Z':>10s}{0:10d}{0:10d}{1999:10d}" + " " * 10 +
            f"{1.0:20.12g}{10.0:20.12g}"]


def two_stops(scene):
    """A cylindrical joint with stops in both directions: 0.1 m and 0.2 rad, 2 kg at 1 m/s, J = 1/2 at 3 rad/s.
    They do not know of each other: each half period is the way 2 a/v and half a period of the stop, pi/w."""
    dofs = [dof(low=-0.1, high=0.1, stiffness=2e4), dof(low=-0.2, high=0.2, stiffness=5e3)]
    file = scene.run("two_stops", starter([Body(velocity=(1, 0, 0), spin=(3, 0, 0))], joint(CYLINDRICAL, dofs, kn=1e6)),
                     3.0, options=("--sample", "0.0005"))
    t = file["time"][:]
    for name, y, half in (("shift", file["joint/displacement"][:, 0, 0], 0.2 / 1.0 + np.pi * np.sqrt(2.0 / 2e4)),
                          ("turn", file["joint/rotation"][:, 0, 0], 0.4 / 3.0 + np.pi * np.sqrt(0.5 / 5e3))):
        zero = np.flatnonzero(y[1:-1] * y[2:] < 0.0) + 1
        cross = t[zero] - y[zero] * (t[zero + 1] - t[zero]) / (y[zero + 1] - y[zero])
        check(f"two_stops, {name}: many bounces", -float(len(cross)), -10.0)
        check(f"two_stops, {name}: half a period", abs(np.diff(cross) / half - 1.0).max(), 1e-3)
    rates = 2.0 * file["joint/velocity"][:, 0, 0]**2 + 0.5 * file["joint/angular_velocity"][:, 0, 0]**2
    inside = np.all(file["joint/state"][:, 0][:, [0, 3]] == 0, axis=1)
    check("two_stops: energy between them", abs(rates[inside] / 6.5 - 1.0).max(), 1e-3)


def order_of_joints(scene):
    """The same joints listed in another order, which gives them other places in memory: the same bits, at
    steps that no stop shortens."""
    bodies = [Body(velocity=(v, 0, 0)) for v in (0.3, 0.1, 1e-3, -0.5)]
    prop = joint(TRANSLATIONAL, [dof(low=-0.02, high=0.02, stiffness=9e4, limit=2.0)], cr=0.2)
    files = [scene.run(name, starter(bodies, prop, springs=springs), 0.4, options=("--dt-rule", "nodal"), dt_max=2e-5)
             for name, springs in (("listed", [901, 902, 903, 904]), ("mixed", [903, 901, 904, 902]))]
    for name in ("displacement", "force", "friction_energy", "state", "gap", "dissipated_energy"):
        sides = []
        for file in files:
            at = np.argsort(file["joint/joint"][:])
            sides.append(file[f"joint/{name}"][:][:, at])
        check(f"order of joints: {name}", float(not np.array_equal(*sides, equal_nan=True)), 0.0)


def threads(scene):
    """85 pucks in a ring with friction, two blocks of joints: the same bits with 1, 2 and 3 threads."""
    flat = dof(low=-0.1, high=0.1, stiffness=1e4, limit=2.0, combined=1)
    prop = joint(PLANAR, [flat, flat, dof(low=-0.2, high=0.2, stiffness=1e3, limit=0.1)], cr=0.1)
    rates = np.random.default_rng(3).normal(size=(85, 3))
    deck = starter([Body(velocity=(0, v, w), spin=(s, 0, 0)) for v, w, s in rates], prop)
    files = []
    for n in "123":
        scene.run("threads", deck, 0.2, options=("--threads", n, "--reproducible")).close()
        files.append((scene.work / "threads.h5").read_bytes())
    check("threads: the same bits", float(len(set(files)) != 1), 0.0)


def order(scene):
    """Halving the step: where a turn with friction or with a stop has come to converges at least with the first
    order. Fixed steps by /DTIX, far below the limits."""
    cases = {"rub": (dof(stiffness=5e2, limit=2.0), 0.9), "hit": (dof(low=-9.0, high=0.5, stiffness=5e2), 0.4)}
    for name, (d, end) in cases.items():
        deck = starter([Body(spin=(3, 0, 0))], joint(REVOLUTE, [d], kn=1e4))
        at = []
        for k in range(6):
            with scene.run(f"{name}{k}", deck, end, dt_max=4e-4 / 2**k, options=("--integrator", "liemid")) as file:
                at.append(file["joint/rotation"][-1, 0, 0])
        errors = np.abs(np.array(at[:-1]) - at[-1])
        slope = np.polyfit(np.arange(4) * np.log(0.5), np.log(np.maximum(errors[:4], 1e-15)), 1)[0]
        print(f"       {name}: errors {' '.join(f'{e:.1e}' for e in errors)}")
        check(f"order of {name}: {slope:.2f}", -slope, -1.0)


def kinds(scene):
    """Two bodies that float, with ends apart, thrown at each other with stops, friction and both in all free
    directions of every type: momentum and angular momentum stay, friction only takes; the legacy scheme
    runs to the end with finite numbers. (/DTIX for a free joint, where nothing else limits its step.)"""
    ground = Body(velocity=(0.2, -0.1, 0.3), spin=(0.3, 0.8, -0.5), centre=(-0.2, 0.1, 0.0), mass=3.0,
                  inertia=(0.2, 0.3, 0.4))
    body = Body(velocity=(0.5, 0.4, -0.6), spin=(1.5, -0.9, 1.2), centre=(0.3, -0.1, 0.1), inertia=(0.1, 0.15, 0.2))
    laws = {"stops": {"low": -0.05, "high": 0.04, "stiffness": 2e3},
            "friction": {"stiffness": 2e3, "limit": 0.5},
            "both": {"k": 20.0, "c": 0.05, "low": -0.05, "high": 0.04, "stiffness": 2e3, "limit": 0.3}}
    for kind in (SPHERICAL, REVOLUTE, CYLINDRICAL, PLANAR, UNIVERSAL, TRANSLATIONAL, OLDHAM, FREE):
        for law, cards in laws.items():
            name = f"kind{kind}_{law}"
            deck = starter([body], joint(kind, [dof(**cards)] * FREE_DOFS[kind], kn=1e5, cr=0.05), ground=ground,
                           apart=(0.02, 0.01, 0.0))
            dt_max = 2e-4 if kind == FREE else 0.0
            file = scene.run(name, deck, 0.5, dt_max, options=("--integrator", ("split2", "liemid")[kind % 2]))
            for which in ("momentum", "angular_momentum"):
                p = np.stack([file[f"{which}_{axis}"][:] for axis in "xyz"], axis=1)
                check(f"{name}: {which}", np.linalg.norm(p - p[0], axis=1).max() / np.linalg.norm(p[0]), 1e-12)
            states = set(file["joint/state"][:].ravel())
            wanted = {"stops": {3}, "friction": {1}, "both": {1, 3}}[law]
            check(f"{name}: its limits act", float(not wanted <= states), 0.0)
            elastic, lost = file["joint/elastic_energy"][:], file["joint/dissipated_energy"][-1, 0]
            check(f"{name}: elastic energy is positive [J]", -elastic.min(), 1e-6)
            check(f"{name}: takes energy [J]", -lost, 0.0)
            old = scene.run(f"{name}_legacy", deck, 0.5, dt_max, options=("--legacy",))
            finite = all(np.isfinite(old[f"joint/{n}"][:]).all() for n in ("force", "moment", "displacement", "rotation"))
            check(f"{name}: legacy stays finite", float(not finite), 0.0)


def ringing(scene):
    """Joints that are thrown together with ends that do not fit, hardly damped: their blocked directions ring on
    and on. Steps that change for stops or friction must not pump that: at 0.5 of the limit the plain sum of
    energies is off by (w h)^2/4 = 1/4 of the ringing at most, which has less than a third of the energy."""
    ground = Body(velocity=(1.2, -0.3, 0.4), spin=(0.8, -1.6, 0.5), centre=(0.2, 0.1, -0.15), mass=80.0, inertia=0.5)
    body = Body(velocity=(1.8, 2.0, -1.5), spin=(2.0, -3.0, 1.0), centre=(-0.1, 0.2, 0.1), mass=1.8, inertia=0.07)
    dofs = [dof(low=-0.25, high=0.16), dof(stiffness=1.2e4, limit=0.1)]
    file = scene.run("ringing", starter([body], joint(CYLINDRICAL, dofs, kn=5e7, cr=1e-9), ground=ground,
                                        apart=(0.03, -0.04, 0.02)), 0.5)
    kinetic = file["kinetic_energy_trans"][:] + file["kinetic_energy_rot"][:]
    check("ringing: no energy from nowhere", kinetic.max() / kinetic[0], 1.05)
    check("ringing: friction acts [J]", -file["joint/friction_energy"][-1, 0], -0.01)


def references(scene):
    """The reference decks of the legacy scheme. The ledger is exact for linear laws; what is left comes from
    frames that turn while the blocked directions ring, and falls with the square of the step: below 1e-4 at the
    default step, at half of it down to half or better (or rounding). Friction and dampers take, and no energy
    comes from nowhere: what is there never exceeds start and work."""
    for deck in sorted((SOURCE / "tests" / "parity45").glob("*/*_0000.rad")):
        name = deck.name[:-9]
        errors, steps = [], []
        for scale, sample in (("0.9", "0.002"), ("0.45", "0.001")):
            history = scene.work / f"{name}_{scale}.h5"
            done = scene.start(deck, history, ("--dt-scale", scale, "--sample", sample))
            if done.returncode != 0:
                raise SystemExit(f"{name}: {done.stdout}")
            with h5py.File(history) as file:
                errors.append(abs(file["energy_error"][:]).max())
                steps.append(file["time_step"][:].max())
        check(f"{name}: ledger", errors[0], 1e-4)
        if steps[1] < 0.6 * steps[0]:          # an automatic stiffness keeps the step as it is
            check(f"{name}: ledger at half the step", errors[1], max(1e-6, 0.5 * errors[0]))
        file = h5py.File(history)
        kinetic = file["kinetic_energy_trans"][:] + file["kinetic_energy_rot"][:]
        stored = kinetic + file["joint/elastic_energy"][:].sum(axis=1) + file["potential_energy"][:]
        check(f"{name}: no energy from nowhere", (stored - file["external_work"][:] - stored[0]).max() / kinetic.max(),
              5e-3)
        check(f"{name}: joints take energy [J]", -file["joint/dissipated_energy"][-1].sum(), 0.0)
        if "friction_energy" in file["joint"]:
            taken = np.diff(file["joint/friction_energy"][:], axis=0)
            check(f"{name}: friction never gives back [J]", -min(0.0, taken.min()), 0.0)


CHECKS = (friction_angle, friction_ball, stop_liemid, damped_stop, whirl, two_stops, order_of_joints, threads, order,
          kinds, ringing, references)


def main(kjoint, work):
    work = pathlib.Path(work)
    work.mkdir(parents=True, exist_ok=True)
    for one in CHECKS:
        one(Scene(kjoint, work))
    return 1 if failed else 0


if __name__ == "__main__":
    os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 3 else __doc__)
