#!/usr/bin/env python3
"""The start of a run with split2: joints bear the forces of the first moment, so that reactions are right
from the first row on; their damping; and what must not matter: the unit of length, the way that a slider
has gone.

usage: test_start.py KJOINT [NAME of one test]
"""
import pathlib
import tempfile
import unittest

import numpy as np

import compliant_scenes as scenes
import test_compliant as base              # takes KJOINT off the command line

G = 9.81
STEEP = np.radians(30)


def scene(build, until, sample, *options, integrator="split2"):
    return base.scene(build, until, sample, *options, integrator=integrator)


def held(build):
    return build.body((0, 0, 0), 1, (1, 1, 1), held=True)


def pendulum(kind, offset, cr=0):
    """A body of 2 kg that starts to fall: its centre 0.5 m along x, `offset` along the hinge z"""
    build = scenes.Scene(cr=cr)
    body = build.body((0.5, 0, offset), 2.0, (0.01, 0.08, 0.08))
    build.join(kind, held(build), body, (0, 0, 0), (0, 0, 1))
    return build


def fall(until, n=4000):
    """Reaction in the plane of the pendulum: angle'' = -m g a cos/(J + m a^2), force = m (a_centre - g)"""
    m, a, j = 2.0, 0.5, 0.08
    y, h, force = np.zeros(2), until / n, []

    def rate(y):
        return np.array([y[1], -m * G * a * np.cos(y[0]) / (j + m * a * a)])

    for _ in range(n + 1):
        along, across = np.array([np.cos(y[0]), np.sin(y[0])]), np.array([-np.sin(y[0]), np.cos(y[0])])
        force.append(m * (a * rate(y)[1] * across - a * y[1]**2 * along) + [0, m * G])
        k1 = rate(y)
        k2 = rate(y + h / 2 * k1)
        k3 = rate(y + h / 2 * k2)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + h * k3))
    return np.linalg.norm(force, axis=1)


def slider(kind, spin=0.0, kn=1e7):
    """2 kg on a rail that falls by 30 degrees, gravity along -y"""
    build = scenes.Scene(kn, cr=0)
    down = np.array([np.cos(STEEP), -np.sin(STEEP), 0])
    body = build.body((0, 0, 0), 2.0, (0.02, 0.02, 0.02), velocity=(0, 0, 0), spin=tuple(spin * down))
    build.join(kind, held(build), body, (0, 0, 0), down)
    return build


class FirstRow(unittest.TestCase):
    """Reactions against exact solutions from the first row on, to 1e-3 of the peak. Before, joints began
    without a force and rang: an error of 1 in the first row, and of 0.5 for seconds with the Cr of old."""

    def near(self, found, wanted):
        self.assertLess(np.abs(found - wanted).max(), 1e-3 * np.abs(wanted).max())

    def test_pendulums(self):
        exact = fall(1.0)[::80]
        for kind, offset in ((scenes.REVOLUTE, 0.0), (scenes.REVOLUTE, 0.3), (scenes.SPHERICAL, 0.0), (scenes.UNIVERSAL, 0.0),
                             (scenes.CYLINDRICAL, 0.3)):
            run = scene(pendulum(kind, offset), 1.0, 0.02)
            with self.subTest(kind=kind, offset=offset):
                self.near(np.linalg.norm(run["joint/force"][:, 0], axis=1), exact)
                if offset:                       # the hinge holds the centre that stands out: offset times force
                    self.near(np.linalg.norm(run["joint/moment"][:, 0], axis=1), offset * exact)

    def test_weld(self):
        build = scenes.Scene(cr=0)
        body = build.body((0.5, 0, 0.2), 2.0, (0.01, 0.08, 0.08))
        build.join(scenes.RIGID, held(build), body, (0, 0, 0))
        run = scene(build, 0.2, 0.01)
        self.near(np.linalg.norm(run["joint/force"][:, 0], axis=1), np.full(21, 2 * G))
        self.near(np.linalg.norm(run["joint/moment"][:, 0], axis=1), np.full(21, 2 * G * np.hypot(0.5, 0.2)))

    def test_sliders_that_go_far(self):
        """g sin a t^2/2: 62 m in 5.03 s. The rail presses with m g cos a; half way between the nodes that is
        a moment of s/2 times the force. The gap is force/Kn wherever the slider is."""
        press = 2 * G * np.cos(STEEP)
        for kind, spin in ((scenes.TRANSLATIONAL, 0.0), (scenes.CYLINDRICAL, 2.0)):
            run = scene(slider(kind, spin), 5.03, 0.1)
            way = G * np.sin(STEEP) * run["time"]**2 / 2
            with self.subTest(kind=kind):
                self.near(run["joint/displacement"][:, 0, 0], way)
                self.near(np.linalg.norm(run["joint/force"][:, 0, 1:], axis=1), np.full(len(way), press))
                self.near(np.linalg.norm(run["joint/moment"][:, 0], axis=1), way / 2 * press)
                self.assertLess(np.linalg.norm(run["joint/displacement"][:, 0, 1:], axis=1).max(), 1.01 * press / 1e7)

    def test_planes(self):
        """On a plane: the rail's pressure without its moment along x, the free directions y and z"""
        for kind in (scenes.PLANAR, scenes.OLDHAM):
            build = scenes.Scene(cr=0)
            normal = (np.sin(STEEP), np.cos(STEEP), 0)
            body = build.body((0, 0, 0), 2.0, (0.02, 0.02, 0.02))
            build.join(kind, held(build), body, (0, 0, 0), normal)
            run = scene(build, 1.0, 0.05)
            with self.subTest(kind=kind):
                self.near(np.abs(run["joint/force"][:, 0, 0]), np.full(21, 2 * G * np.cos(STEEP)))

    def test_mechanisms(self):
        """Loops against compliant with rigid joints: what does not ring is within 1e-3 from the first row on"""
        for build in (scenes.four_bars, scenes.slider_crank):
            run = scene(build(), 0.1, 0.01)
            exact = scene(build(), 0.1, 0.01, *base.INF, *base.FIXED, "--sample", 0.0005, integrator="compliant")
            self.assertLess(base.apart(run, exact, "joint/force"), 1.5e-3 * np.abs(exact["joint/force"]).max())

    def test_a_start_that_jumps_stays_unloaded(self):
        """A velocity that the hinge does not allow: no force of that moment is meant to last"""
        build = scenes.Scene()
        rod = build.rod((0, 0, 0), (1, 0, 0), velocity=(0, 1, 0))
        build.join(scenes.REVOLUTE, held(build), rod, (0, 0, 0), (0, 0, 1))
        run = scene(build, 0.01, 0.001)
        self.assertLess(np.abs(run["rigid_body/position"][0, 0] - [0.5, 0, 0]).max(), 1e-5)

    def test_islands_start_alike(self):
        build = scenes.chain(6, hubs=2)
        one, parts = scene(build, 0.05, 0.01), scene(build, 0.05, 0.01, "--islands")
        self.assertTrue(np.array_equal(one["rigid_body/position"][0], parts["rigid_body/position"][0]))
        self.assertLess(base.apart(one, parts, "joint/force"), 1e-3 * np.abs(one["joint/force"]).max())


class WhatMustNotMatter(unittest.TestCase):
    def test_unit_of_length(self):
        """Bricard in m, dm, mm: the same steps and motion. Before, KR was Kn times the square of the unit: in
        dm the step was 9 times as long. The decks have 13 digits."""
        runs = [(scene(scenes.bricard(length=unit), 0.02, 0.01), size) for unit, size in (("m", 1), ("dm", 10), ("mm", 1000))]
        for run, size in runs[1:]:
            self.assertEqual(run.cycles, runs[0][0].cycles)
            self.assertLess(np.abs(run["rigid_body/position"] / size - runs[0][0]["rigid_body/position"]).max(), 1e-8)

    def test_way_of_a_slider(self):
        """A block on a long rail at 60 m/s: as many steps in the last second as in the first"""
        for kind in (scenes.TRANSLATIONAL, scenes.CYLINDRICAL):
            near, far = (scene(slider(kind), t, t) for t in (1.0, 5.0))
            self.assertLess(far.cycles, 5.2 * near.cycles)


class Damping(unittest.TestCase):
    def test_a_long_arm_is_damped_as_a_short_one(self):
        """A point of 1 kg at 2 m from a rigid joint, struck across. L is that arm, so KR = 4 Kn; the point gives way
        to a force by F/Kn + F a^2/KR = 2 F/Kn: w^2 = Kn/(2 m). c = Cr sqrt(Kn m) and Cr sqrt(KR m a^2) are both
        Cr sqrt(m/Kn) times the stiffness: damping ratio 1/2 w Cr sqrt(m/Kn) = Cr/sqrt(8). With the central
        inertia of old, 1e-4 of m a^2, the rotation was hardly damped at all and gave half of that."""
        build = scenes.Scene(kn=1e4, cr=0.2, gravity=None)
        body = build.body((2, 0, 0), 1.0, (4e-4, 4e-4, 4e-4), velocity=(0, 0.1, 0))
        build.join(scenes.RIGID, held(build), body, (0, 0, 0))
        run = scene(build, 1.0, 0.001)
        y, t = run["rigid_body/position"][:, 0, 1], run["time"]
        tops = [i for i in range(1, len(y) - 1) if y[i] > y[i - 1] and y[i] >= y[i + 1]][:6]
        decay = np.log(y[tops[1]] / y[tops[5]]) / (t[tops[5]] - t[tops[1]])
        ratio = 0.2 / np.sqrt(8)
        self.assertAlmostEqual(decay, ratio * np.sqrt(1e4 / 2), delta=0.05 * ratio * np.sqrt(1e4 / 2))

    def test_cr_left_0_is_1(self):
        """The deck that says 0 and the one that says 1 give the same bits"""
        one, zero = (scene(pendulum(scenes.REVOLUTE, 0.3, cr), 0.05, 0.01)["joint/force"] for cr in (1, 0))
        self.assertTrue(np.array_equal(one, zero))


if __name__ == "__main__":
    unittest.main()
