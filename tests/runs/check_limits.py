#!/usr/bin/env python3
"""Stops, friction, locks and automatic stiffness of /PROP/KJOINT2 under the consistent formulation.

usage: check_limits.py KJOINT WORK_DIR      (needs numpy and h5py; exit 1 on a violation)

The scenes are written here, the expected numbers follow from their data. Units: kg, m, s.
"""
import os
import pathlib
import sys

import numpy as np

from limit_scene import (PLANAR, REVOLUTE, SPHERICAL, TRANSLATIONAL, Body, Scene, check, dof, energy, failed, joint,
                         reals, starter)


def friction_block(scene):
    """v0 = 3 m/s, F = 9 N, 2 kg: m v0^2/(2 F) = 1 m, less F/(2 k) = 5e-6 m that the spring gives
    back; it rings by F/k = 1e-5 m, which Cr damps."""
    prop = joint(TRANSLATIONAL, [dof(stiffness=9e5, limit=9.0)], cr=0.3)
    file = scene.run("block", starter([Body(velocity=(3, 0, 0))], prop), 1.0)
    x, taken = file["joint/displacement"][:, 0, 0], file["joint/friction_energy"][:, 0]
    check("block: stops at 1 m", abs(x[-1] - 1.0), 1e-4)
    check("block: stays there", np.ptp(x[-50:]), 1e-6)
    check("block: friction took 9 J", abs(taken[-1] - 9.0) / 9.0, 1e-4)
    t, v = file["time"][:], file["joint/velocity"][:, 0, 0]
    sliding = (t > 0.01) & (t < 0.66)
    check("block: v = v0 - F t/m", abs(v - (3.0 - 4.5 * t))[sliding].max(), 3e-4)
    check("block: the force is the limit", abs(file["joint/force"][:, 0, 0] - 9.0)[sliding].max(), 1e-9)
    check("block: slides (1), sticks (2)", float(np.any(file["joint/state"][:, 0, 0][sliding] != 1) or
                                                file["joint/state"][-1, 0, 0] != 2), 0.0)
    both = file["joint/elastic_energy"][:] + file["joint/dissipated_energy"][:] - file["joint/internal_energy"][:]
    check("block: elastic + dissipated = work", abs(both).max(), 1e-12)


def friction_curve(scene):
    """Limit 20 N/m times x, from x = 0.2 on 4 N more: the function of the angle is 4 + 20 x. With
    1/2 m v0^2 = 9 J the way is the root of 4 s + 10 s^2 = 9."""
    extra = ["/FUNCT/5", "limit", reals(-1.0, -16.0), reals(2.0, 44.0)]
    prop = joint(TRANSLATIONAL, [dof(stiffness=9e5, f_limit=5)], cr=0.3)
    file = scene.run("curve", starter([Body(velocity=(3, 0, 0))], prop, extra=extra), 1.0)
    check("curve: stops at the root", abs(file["joint/displacement"][-1, 0, 0] -
                                          (np.sqrt(16.0 + 360.0) - 4.0) / 20.0), 1e-4)


def combined_friction(scene):
    """A planar joint with combined stops far away: friction 9 N in all, whatever the direction, so
    the way of 2 kg with (1.8, 2.4) m/s is straight and 1 m long."""
    d = dof(stiffness=9e5, limit=9.0, low=-5.0, high=5.0, combined=1)
    file = scene.run("puck", starter([Body(velocity=(0, 1.8, 2.4))], joint(PLANAR, [d, d], cr=0.3)), 1.0)
    x = file["joint/displacement"][-1, 0]
    check("puck: stops at (0.6, 0.8) m", np.abs(x - [0.0, 0.6, 0.8]).max(), 1e-4)


def pendulum(scene):
    """A rod of 1 m, J = 1/2 + 2/4 about its end, falls from rest over 60 degrees onto a stop at -1 rad
    (soft and as stiff as the blocked directions) and comes back with what it had."""
    for name, stiffness, limit in (("pendulum_soft", 1e4, 1e-4), ("pendulum_hard", 0.0, 2e-3)):
        prop = joint(REVOLUTE, [dof(low=-1.0, high=1.0, stiffness=stiffness)], kn=1e7)
        body = Body(centre=(0, 0.5, 0))
        file = scene.run(name, starter([body], prop, gravity=9.81), 1.5)
        angle, rate = file["joint/rotation"][:, 0, 0], file["joint/angular_velocity"][:, 0, 0]
        # level at first, so the height is 1/2 sin(angle); the impact leaves a little in the hinge, whose
        # ringing shows in kinetic and elastic energy by turns: hence the mean between two impacts
        fall = 2.0 * 9.81 * 0.5 * np.sin(1.0)
        hits = np.flatnonzero((rate[:-1] < 0.0) & (rate[1:] >= 0.0) & (angle[1:] < -0.98))
        check(f"{name}: at least two bounces", -float(len(hits)), -2.0)
        between = np.arange(hits[0] + 5, hits[1] - 5)
        check(f"{name}: swings back with its energy", abs(energy(file)[between].mean() - energy(file)[0]) / fall,
              1e-3)
        # the hard stop leaves 1e-3 of it in the hinge
        check(f"{name}: comes back to where it began", abs(angle[between].max()), limit)


def stop_and_friction(scene):
    """Against a stop of k = 2e4 N/m at 0.1 m with friction F = 3 N all the way, 2 kg, v0 = 2 m/s: goes
    in by o, 4 J = F (0.1 + o) + k o^2/2, rubs on the way back too, and rests where F times the way
    there and back has taken all 4 J. Cr is left 0: its default damps the stuck spring, not the stop."""
    prop = joint(TRANSLATIONAL, [dof(low=-9.0, high=0.1, stiffness=2e4, limit=3.0)], cr=0.0)
    file = scene.run("both", starter([Body(velocity=(2, 0, 0))], prop), 2.0)
    k = 2e4
    o = (-3.0 + np.sqrt(9.0 + 2.0 * k * (4.0 - 0.3))) / k
    x = file["joint/displacement"][:, 0, 0]
    # the spring of friction turns by 2 F/k at the stop without sliding
    way = 4.0 / 3.0
    rest = 0.1 - (way - 0.1 - 2.0 * o) - 2.0 * 3.0 / k
    check("both: goes in by o", abs(x.max() - 0.1 - o), 2e-4)
    check("both: rests where friction took all", abs(x[-1] - rest), 6e-4)
    check("both: force at the stop is k o + F", abs(file["joint/force"][:, 0, 0].max() / (k * o + 3.0) - 1.0), 1e-2)
    check("both: friction took 4 J", abs(file["joint/friction_energy"][-1, 0] - 4.0), 2e-3)


def lock(scene):
    """A sensor at 0.1 s locks a block of 2 kg at 1 m/s: it rings about 0.1 m by v sqrt(m/K) and comes to
    rest; the force starts from zero and rises as K v t."""
    kn = 1e6
    extra = ["/SENSOR/TIME/3", "lock", reals(0.1)]
    for name, cr in (("lock", 1e-9), ("lock_damped", 0.5)):
        prop = joint(TRANSLATIONAL, [dof()], kn=kn, cr=cr, sensor=3)
        file = scene.run(name, starter([Body(velocity=(1, 0, 0))], prop, extra=extra), 0.2,
                         options=("--sample", "0", "--dt-scale", "0.1"))
        t, x, f = file["time"][:], file["joint/displacement"][:, 0, 0], file["joint/force"][:, 0, 0]
        w = np.sqrt(kn / 2.0)
        check(f"{name}: no force before", abs(f[t <= 0.1]).max(), 0.0)
        rise = np.abs(np.diff(f)) / np.diff(t)
        check(f"{name}: the force does not jump", rise.max() / (kn * 1.0), 1.6)
        check(f"{name}: locked (4)", float(np.any(file["joint/state"][:, 0, 0][t > 0.1] != 4)), 0.0)
        if cr < 0.1:
            expected = 0.1 + np.sin(w * (t - 0.1)) / w
            late = (t > 0.1) & (t < 0.11)
            check(f"{name}: rings by v/w", abs(x - expected)[late].max() * w, 0.03)
            e = energy(file)
            check(f"{name}: keeps the energy", abs(e / e[0] - 1.0).max(), 1e-2)
        else:
            check(f"{name}: comes to rest at 0.1 m", abs(x[-1] - 0.1) * w, 1e-3)


def lock_at_once(scene):
    """A lock at time 0 holds the start, whatever the speed."""
    extra = ["/SENSOR/TIME/3", "lock", reals(0.0)]
    prop = joint(TRANSLATIONAL, [dof()], kn=1e6, cr=0.5, sensor=3)
    file = scene.run("held", starter([Body(velocity=(1, 0, 0))], prop, extra=extra), 0.1)
    check("held: stays at 0", abs(file["joint/displacement"][-1, 0, 0]), 1e-6)


def several(scene):
    """Three blocks on one property, one to its stop and back, one sliding, one stuck: each as alone.
    0.3 m/s are 0.09 J and take 0.045 m of 2 N, the stop is at 0.02 m. The step is so short that none
    of them asks for shorter ones."""
    bodies = [Body(velocity=(v, 0, 0)) for v in (0.3, 0.1, 1e-3)]
    prop = joint(TRANSLATIONAL, [dof(low=-0.02, high=0.02, stiffness=9e4, limit=2.0)], cr=0.2)
    dt = 2e-5
    names = ("displacement", "force", "friction_energy", "state", "gap")
    together = scene.run("three", starter(bodies, prop), 0.4, options=("--dt-rule", "nodal"), dt_max=dt)
    for i, body in enumerate(bodies):
        alone = scene.run(f"one{i}", starter([body], prop), 0.4, options=("--dt-rule", "nodal"), dt_max=dt)
        for name in names:
            a, b = alone[f"joint/{name}"][:, 0], together[f"joint/{name}"][:, i]
            worst = np.nanmax(np.abs(a - b)) / max(1e-30, np.nanmax(np.abs(a)))
            check(f"several: {name} of joint {i + 1} as alone", worst, 1e-10)
    for i, flags in enumerate(({1, 2, 3}, {1, 2}, {2})):
        seen = set(together["joint/state"][1:, i, 0])
        check(f"several: what joint {i + 1} does", float(seen != flags), 0.0)


def order(scene):
    """Halving the step: what a block with friction and a stop has at the end converges at least with
    the first order. Fixed steps by /DTIX, far below the limits."""
    cases = {"slide": (dof(stiffness=2e3, limit=9.0), 0.9),
             "bounce": (dof(low=-9.0, high=0.5, stiffness=2e3), 0.4)}
    for name, (d, end) in cases.items():
        deck = starter([Body(velocity=(3, 0, 0))], joint(TRANSLATIONAL, [d], kn=1e4))
        at = []
        for k in range(6):
            with scene.run(f"{name}{k}", deck, end, dt_max=4e-4 / 2**k) as file:
                at.append(file["joint/displacement"][-1, 0, 0])
        fine = 4e-4 / 2**np.arange(5)
        errors = np.abs(np.array(at[:-1]) - at[-1])
        slope = np.polyfit(np.log(fine[:4]), np.log(np.maximum(errors[:4], 1e-15)), 1)[0]
        print(f"       {name}: errors {' '.join(f'{e:.1e}' for e in errors)}")
        check(f"order of {name}: {slope:.2f}", -slope, -1.0)


def automatic(scene):
    """Kn = 0 with /DTIX 1e-4: the step is that of /DTIX, the blocked directions hold, SCF softens them."""
    body = Body(centre=(0, 0.5, 0), spin=(3, 0, 0), velocity=(0, 0, 1.5))
    prop = joint(REVOLUTE, [dof(low=-1.0, high=1.0)], kn=0.0)
    file = scene.run("automatic", starter([body], prop), 0.5, dt_max=1e-4)
    # a sample interval is cut into equal steps, none longer; at the start and at stops they are shorter
    check("automatic: no step above that of /DTIX", file["time_step"][:].max() / 1e-4, 1.0 + 1e-9)
    check("automatic: most steps are that of /DTIX", 1e-4 / np.quantile(file["time_step"][1:], 0.9), 1.06)
    # centripetal 2 kg 9 0.5 = 9 N over K = (2 0.9/1e-4)^2 2 kg at most: 1e-8 m; rings at first
    soft = scene.run("automatic_soft", starter([body], joint(REVOLUTE, [dof()], kn=0.0, scf=0.01)), 0.5, dt_max=1e-4)
    hard = scene.run("automatic_hard", starter([body], joint(REVOLUTE, [dof()], kn=0.0)), 0.5, dt_max=1e-4)
    ratio = soft["joint/violation_trans"][-20:].mean() / hard["joint/violation_trans"][-20:].mean()
    check("automatic: SCF 0.01 is a hundred times softer", abs(ratio / 100.0 - 1.0), 0.2)
    done = scene.launch("automatic_free", starter([body], joint(REVOLUTE, [dof()], kn=0.0)), 0.1, 0.0, ())
    check("automatic: without a limit an error that says so",
          float(not (done.returncode == 1 and "/DTIX" in done.stdout)), 0.0)


def first_angle(scene):
    """Skews 0.3 rad apart about x: the angle starts there. J = 1/2, K = 50: 0.3 cos(10 t), 2.25 J."""
    y, z = (0.0, np.cos(0.3), np.sin(0.3)), (0.0, -np.sin(0.3), np.cos(0.3))
    extra = ["/SKEW/FIX/3", "wall", reals(0, 0, 0), reals(0, 1, 0), reals(0, 0, 1),
             "/SKEW/FIX/4", "block", reals(0, 0, 0), reals(*y), reals(*z)]
    for name, kind in (("angle_revolute", REVOLUTE), ("angle_spherical", SPHERICAL)):
        prop = joint(kind, [dof(k=50.0, low=-0.5, high=0.5)], skews=(3, 4))
        file = scene.run(name, starter([Body()], prop, extra=extra), 1.0, options=("--dt-scale", "0.2"))
        angle, t = file["joint/rotation"][:, 0, 0], file["time"][:]
        check(f"{name}: 0.3 cos(10 t)", abs(angle - 0.3 * np.cos(10.0 * t)).max(), 1e-3)
        check(f"{name}: moment K angle", abs(file["joint/moment"][:, 0, 0] - 50.0 * angle).max(), 1e-9)
        check(f"{name}: holds 2.25 J at first", abs(file["joint/elastic_energy"][0, 0] - 2.25) +
              abs(file["joint/dissipated_energy"][0, 0]), 1e-9)
        check(f"{name}: gap from the angle", abs(file["joint/gap_rot"][:, 0, 0] - (0.5 - abs(angle))).max(), 1e-12)


def refusals(scene):
    deck = starter([Body(velocity=(1, 0, 0))], joint(TRANSLATIONAL, [dof(stiffness=1e4, limit=1.0)]))
    done = scene.launch("refused", deck, 0.1, 0.0, ("--integrator", "rkmk4"))
    check("rkmk4 with friction is refused", float(not (done.returncode == 2 and "rkmk4" in done.stdout)), 0.0)


CHECKS = (friction_block, friction_curve, combined_friction, pendulum, stop_and_friction, lock, lock_at_once,
          several, order, automatic, first_angle, refusals)


def main(kjoint, work):
    work = pathlib.Path(work)
    work.mkdir(parents=True, exist_ok=True)
    for one in CHECKS:
        one(Scene(kjoint, work))
    return 1 if failed else 0


if __name__ == "__main__":
    os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 3 else __doc__)
