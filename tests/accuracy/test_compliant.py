#!/usr/bin/env python3
"""The integrator compliant: errors, order, energy, redundant rows, extremes of Kn and mass.

usage: test_compliant.py KJOINT [NAME of one test]

Limits are 1.5 times what the prototype of the scheme measured, where it ran the scene; errors are
against the reference of a benchmark, or against the same scene in far smaller steps. Steps are those
of the samples where --error and --turn are lifted (FIXED).
"""
import csv
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

import compliant_scenes as scenes

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "runs"))
import limit_scene as limits

PROGRAM = sys.argv.pop(1) if len(sys.argv) > 1 else "kjoint"
BENCHMARKS = pathlib.Path(__file__).parents[1] / "benchmarks"
FIXED = ("--error", "1e3", "--turn", "1e3")
INF = ("--kn", "inf")
FOLDER = tempfile.TemporaryDirectory()


def datasets(group, path=""):
    for name, item in group.items():
        if isinstance(item, h5py.Dataset):
            yield path + name, item[()]
        else:
            yield from datasets(item, f"{path}{name}/")


class Run:
    """A history, by channel; `text` is what the program said"""

    def __init__(self, deck, *options, fails=False, integrator="compliant"):
        out = pathlib.Path(FOLDER.name) / "run.h5"
        done = subprocess.run([PROGRAM, "run", *deck, "--integrator", integrator, "-o", out, *map(str, options)],
                              capture_output=True, text=True, check=False)
        self.text, self.status = done.stdout + done.stderr, done.returncode
        if done.returncode and not fails:
            raise AssertionError(self.text)
        with h5py.File(out) as file:
            self.values = dict(datasets(file))
        found = re.search(r"cycles +(\d+)", self.text)
        self.cycles = int(found[1]) if found else 0

    def __getitem__(self, name):
        return self.values[name]

    def finite(self):
        return all(np.isfinite(v).all() for v in map(np.asarray, self.values.values())
                   if v.dtype.kind == "f")


def benchmark(name, *options):
    """Run of a benchmark and its largest errors by kind of column"""
    folder = BENCHMARKS / name
    run = Run(sorted(folder.glob("*_000?.rad")), *options)
    with open(folder / "reference.csv", newline="") as stream:
        rows = list(csv.reader(stream))
    data = np.array(rows[1:], float)
    at = np.searchsorted(data[:, 0], run["time"] - 1e-9)
    met = (at < len(data)) & (np.abs(data[np.minimum(at, len(data) - 1), 0] - run["time"]) < 1e-9)
    error = {}
    for k, head in enumerate(rows[0]):
        parts = head.split("/")
        if parts[0] not in ("node", "rbody", "joint"):
            continue
        kind = {"": "position", "v": "velocity", "w": "angular_velocity", "l": "displacement",
                "r": "rotation"}[parts[2][:-1]]
        group, entity = {"node": ("node", "node"), "rbody": ("rigid_body", "body"), "joint": ("joint", "joint")}[parts[0]]
        row = list(run[f"{group}/{entity}"]).index(int(parts[1]))
        found = run[f"{group}/{kind}"][met, row, "xyz".index(parts[2][-1])]
        worst = np.abs(found - data[at[met], k]).max()
        error[kind] = max(error.get(kind, 0.0), worst)
    return run, error


def scene(build, until, sample, *options, **more):
    root = pathlib.Path(FOLDER.name) / "scene"
    build.write(root, until, sample)
    return Run([f"{root}_0000.rad", f"{root}_0001.rad"], *options, **more)


def position(run):
    return run["rigid_body/position"]


def apart(a, b, channel="rigid_body/position"):
    """Largest difference where both have samples"""
    step = (len(b["time"]) - 1) // (len(a["time"]) - 1)
    return np.abs(a[channel] - b[channel][::step]).max()


class Benchmarks(unittest.TestCase):
    def below(self, name, options, **limits):
        _, error = benchmark(name, *options)
        for kind, limit in limits.items():
            self.assertLess(error[kind], limit, f"{name}: {kind}")

    def test_slider_crank(self):
        self.below("SLCR01", (*INF, *FIXED, "--sample", 0.01), position=2.1e-3)
        self.below("SLCR01", (*INF, *FIXED, "--sample", 0.002), position=8.2e-5)
        self.below("SLCR01", (*FIXED, "--sample", 0.004), position=2.5e-4)

    def test_slider_crank_is_second_order(self):
        error = [benchmark("SLCR01", *INF, *FIXED, "--sample", h)[1]["position"] for h in (0.004, 0.002)]
        self.assertAlmostEqual(np.log2(error[0] / error[1]), 2.0, delta=0.1)

    def test_heavy_top(self):
        self.below("HTOP01", (*INF, *FIXED, "--sample", 0.001), position=6.8e-4, angular_velocity=0.1)

    def test_cardan(self):
        self.below("CARD01", (*FIXED, "--sample", 0.01), position=4.5e-9)

    def test_momentum(self):
        run, _ = benchmark("RIGI01", *INF, *FIXED, "--sample", 0.01)
        for kind in ("momentum", "angular_momentum"):
            p = np.stack([run[f"{kind}_{x}"] for x in "xyz"], axis=1)
            self.assertLess(np.linalg.norm(p - p[0], axis=1).max() / np.linalg.norm(p[0]), 1e-14, kind)

    def test_error_option_keeps_its_word(self):
        _, error = benchmark("SLCR01", *INF, "--sample", 0.05)
        self.assertLess(error["position"], 1e-3 * 0.55)
        run, error = benchmark("HTOP01", *INF, "--sample", 0.05)
        self.assertLess(error["position"], 1e-3)

    def test_steps_grow_with_the_fourth_root_of_the_tolerance(self):
        """Pairs: a hundredth of the tolerance takes 100^(1/4) = 3.2 times the steps, where second order took ten times the
        247 of the prototype at 1e-4. Rows that stiffen at once with shorter steps shake the thin rods until the run stands
        still."""
        for tolerance, most in ((1e-4, 247), (1e-5, 247*10**0.25), (1e-6, 247*100**0.25)):
            run = scene(scenes.bricard(), 1.0, 0.05, *INF, "--error", tolerance)
            self.assertLess(run.cycles, most)

    def test_pairs_are_fourth_order(self):
        """Errors fall with the fourth power of the number of steps. Against steps to 1e-8, which single ones of 0.5 ms, of
        second order, have to come to within the 2.3e-5 m that the prototype was wrong by with them"""
        fine = scene(scenes.governor(), 1.0, 0.05, *INF, "--error", 1e-8)
        self.assertLess(apart(fine, scene(scenes.governor(), 1.0, 0.0005, *INF, *FIXED)), 1.5 * 2.3e-5)
        runs = [scene(scenes.governor(), 1.0, 0.05, *INF, "--error", error) for error in (1e-2, 1e-5)]
        errors = [apart(run, fine) for run in runs]
        order = np.log(errors[0] / errors[1]) / np.log(runs[1].cycles / runs[0].cycles)
        self.assertAlmostEqual(order, 4.0, delta=0.5)

    def test_small_tolerances_are_kept(self):
        """A thousandth of the tolerance is a thousandth of the error, less what rounding takes. Below 1e-8 steps of single order
        are no better; pairs stopped there, too, and it was a fortieth"""
        runs = [scene(scenes.governor(), 0.2, 0.04, *INF, "--error", error) for error in (1e-8, 1e-11, 1e-13)]
        self.assertLess(apart(runs[1], runs[2]), 0.01 * apart(runs[0], runs[2]))

    def test_a_long_run_from_rest(self):
        """A point mass with a spin inertia of its own on a hinge, level at first: (m l^2 + J) angle'' = -m g l cos(angle).
        Neither its speed nor the error of the first steps tells how long they may be"""
        build = scenes.Scene(1e7)
        ground = build.body((0, 0, 0), 1, (1, 1, 1), held=True)
        build.join(scenes.REVOLUTE, ground, build.body((1, 0, 0), 1.0, (0.1, 0.1, 0.1)), (0, 0, 0), (0, 0, 1))

        def rate(y):
            return np.array([y[1], -9.81 * np.cos(y[0]) / 1.1])

        y, h, angles = np.zeros(2), 1e-3, [0.0]
        for n in range(10000):
            k1 = rate(y)
            k2 = rate(y + h / 2 * k1)
            k3 = rate(y + h / 2 * k2)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + h * k3))
            if n % 500 == 499:
                angles.append(y[0])
        exact = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        for tolerance in (1e-3, 1e-4):
            run = scene(build, 10.0, 0.5, *INF, "--error", tolerance)
            self.assertLess(np.linalg.norm(position(run)[:, 1, :2] - exact, axis=1).max(), 2 * tolerance)   # of its way, 2 m

    def test_cost_for_the_error(self):
        """Steps of the prototype at 1e-3 and 20 samples, for inf: 265, 95, 409, 41. A pair counts as its three solves"""
        for build, until, most in ((scenes.slider_crank, 1.0, 300), (scenes.bricard, 1.0, 110), (scenes.governor, 1.0, 450),
                                   (scenes.four_bars, 0.7, 50)):
            run = scene(build(), until, until / 20, *INF)
            self.assertLessEqual(run.cycles, most)
            self.assertEqual(run["cycle"][-1], run.cycles)
        pairs = scene(scenes.slider_crank(), 0.1, 0.1, *INF, "--error", 1e-9)
        self.assertEqual(pairs.cycles % 3, 0)

    def test_springs_of_joints_that_are_not_resolved_are_told(self):
        """2 kg on a ball joint hang by 20 N: with 1e3 N/m it gives way by 0.02 m, 4 % of the scene, and rings as far"""
        told = re.search(r"not resolved +ringing of joints, about (\S+) of the size", scene(scenes.pair(), 0.5, 0.01).text)
        self.assertGreater(float(told[1]), 0.04)
        self.assertNotIn("not resolved", scene(scenes.slider_crank(), 0.1, 0.01).text)
        self.assertNotIn("not resolved", scene(scenes.pair(), 0.5, 0.01, *INF).text)

    def test_masses_that_no_rigid_joint_carries_are_told(self):
        """A rod of 1 kg with one of 1e6 kg at its end: the upper joint is as rigid as its rod alone asks for, a millionth of
        the way of a step, and carries a million times that"""
        for mass, told in ((1e6, True), (1e2, False)):
            build = scenes.Scene()
            build.join(scenes.SPHERICAL, build.body((0, 0, 0), 1, (1, 1, 1), held=True), build.rod((0, 0, 0), (1, 0, 0)), (0, 0, 0))
            build.join(scenes.SPHERICAL, 2, build.rod((1, 0, 0), (2, 0, 0), mass), (1, 0, 0))
            run = scene(build, 0.6, 0.06, *INF)
            self.assertEqual("not rigid     joints give way" in run.text, told, run.text)

    def test_errors_of_dense_samples(self):
        """A bar of 1 m swings for 10 s; with 1000 samples single steps are cheap. They were wrong by 1.9e-3 m"""
        _, error = benchmark("IFA01")
        self.assertLess(error["position"], 1e-3)

    def test_reactions_have_no_start_up_ringing(self):
        """Against a run in tenths of the steps: forces at t, from the first row on"""
        for kn in (INF, ()):
            rough, _ = benchmark("SLCR01", *kn, *FIXED, "--sample", 0.004)
            fine, _ = benchmark("SLCR01", *kn, *FIXED, "--sample", 0.0004)
            force = fine["joint/force"][::10]
            rms = np.sqrt(((rough["joint/force"] - force)**2).mean()) / np.abs(force).max()
            self.assertLess(rms, 3e-4)

    def test_fast_tops(self):
        """0.05 to 0.45 rad of spin a step, nutation faster still: numbers stay numbers"""
        for turn in (0.05, 0.15, 0.3, 0.45):
            run, _ = benchmark("HTOP01", *INF, *FIXED, "--sample", turn / 150, "--until", 0.2)
            self.assertTrue(run.finite())


class Mechanisms(unittest.TestCase):
    def test_bricard(self):
        fine = scene(scenes.bricard(), 1.0, 0.01, *INF, *FIXED, "--dt-max-scale", 1, "--sample", 1/3200)
        inf = scene(scenes.bricard(), 1.0, 0.01, *INF, *FIXED)
        deck = scene(scenes.bricard(), 1.0, 0.01, *FIXED)
        for run in (inf, deck):
            self.assertLess(apart(run, fine), 5.3e-5)
            self.assertLess(apart(run, fine, "rigid_body/velocity"), 1e-4)
        force = inf["joint/force"]
        self.assertLess(np.abs(force - deck["joint/force"]).max(), 0.1 * np.abs(force).max())

    def test_kn_of_any_size(self):
        gaps, places = [], []
        for scale in (1.0, 1e2, 1e4, 1e6):
            run = scene(scenes.bricard(), 1.0, 0.01, *FIXED, "--kn-scale", scale)
            gaps.append(np.abs(run["joint/displacement"]).max() * scale)
            places.append(position(run))
        places.append(position(scene(scenes.bricard(), 1.0, 0.01, *INF, *FIXED)))
        for place in places[2:]:
            self.assertLess(np.abs(place - places[1]).max(), 1e-6)
        self.assertLess(max(gaps[:2]) / min(gaps[:2]), 1.05)     # beyond, the step does not see Kn

    def test_four_bars(self):
        fine = scene(scenes.four_bars(), 0.7, 0.01, *INF, *FIXED, "--sample", 0.7/2240)
        run = scene(scenes.four_bars(), 0.7, 0.01, *INF, *FIXED)
        self.assertLess(apart(run, fine), 1.8e-4)
        self.assertLess(apart(run, fine, "joint/rotation"), 2.0e-4)

    def test_heavy_last_link(self):
        """The page has 3.3e-5 m for a link that it does not name. Here the last upright weighs 1e4 kg: all follows
        that rod, angle'' = 3 g sin(angle)/2, from upright with 1 rad/s. The leapfrog scheme in its angle alone,
        which is second order like RATTLE, is wrong by 8.7e-5 rad, that is m of the couplers, after 0.6 s."""
        def leapfrog(h, angle=0.0, rate=1.0):
            for _ in range(round(0.6 / h)):
                rate += h / 2 * 1.5 * 9.81 * np.sin(angle)
                angle += h * rate
                rate += h / 2 * 1.5 * 9.81 * np.sin(angle)
            return angle

        limit = abs(leapfrog(0.005) - leapfrog(0.00005))
        fine = scene(scenes.four_bars(last=1e4), 0.6, 0.005, *INF, *FIXED, "--sample", 0.6/1920)
        run = scene(scenes.four_bars(last=1e4), 0.6, 0.005, *INF, *FIXED)
        self.assertLess(apart(run, fine), limit)
        self.assertTrue(run.finite())

    def test_singular_positions(self):
        """Ten seconds through the positions in which all bars lie on a line, h = 0.01. The couplers stay level, so
        one angle is left: three uprights of 1/3 kg m^2, two couplers of 1 kg: 3 angle'' = 7/2 g sin(angle)."""
        run = scene(scenes.four_bars(), 10.0, 0.01, *FIXED)
        energy = run["kinetic_energy_trans"] + run["kinetic_energy_rot"] + run["internal_energy"] + run["potential_energy"]
        self.assertLess(np.abs(energy - energy[0]).max(), 5e-3 * run["kinetic_energy_trans"].max())
        y, h, angles = np.array([0.0, 1.0]), 1e-3, [0.0]

        def rate(y):
            return np.array([y[1], 3.5 / 3 * 9.81 * np.sin(y[0])])

        for n in range(10000):
            k1 = rate(y)
            k2 = rate(y + h / 2 * k1)
            k3 = rate(y + h / 2 * k2)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(y + h * k3))
            if n % 10 == 9:
                angles.append(y[0])
        coupler = position(run)[:, 4, :2] - [0.5, 0]           # level: its centre goes as B0
        exact = np.stack([np.sin(angles), np.cos(angles)], axis=1)
        self.assertLess(np.abs(coupler - exact).max(), 2e-2)

    def test_singular_positions_at_small_errors(self):
        """All bars on a line: across the way that the loops go they hold nothing, and shake at any step. A hundredth of the
        error takes ten times the steps of a second-order scheme; at 1e-3 it takes 132 to 146"""
        for kn in (INF, ()):
            run = scene(scenes.four_bars(), 1.0, 0.01, *kn, "--error", 1e-5)
            self.assertLess(run.cycles, 1460)
            energy = run["kinetic_energy_trans"] + run["kinetic_energy_rot"] + run["internal_energy"] + run["potential_energy"]
            self.assertLess(np.abs(energy - energy[0]).max(), 1e-5 * run["kinetic_energy_trans"].max())

    def test_governor(self):
        """A spring and a damper on the collar: second order. Redundant hinges; 500 steps a second"""
        build = scenes.governor
        fine = scene(build(), 1.0, 0.004, *INF, *FIXED, "--sample", 1/8000)
        error = [apart(scene(build(), 1.0, h, *INF, *FIXED), fine) for h in (0.004, 0.002)]
        slider = apart(scene(build(), 1.0, 0.002, *INF, *FIXED), fine, "joint/displacement")
        self.assertAlmostEqual(np.log2(error[0] / error[1]), 2.0, delta=0.1)
        self.assertLess(error[1], 5.5e-4)
        self.assertLess(slider, 5.1e-5)

    def test_oldham_coupling(self):
        """Two shafts 0.05 m apart turn with 10 rad/s, 0.1 rad a step: the way across the coupling, in its axes that
        turn along, goes as 0.05 (sin, cos - 1) of the angle"""
        for kn in (INF, ()):
            run = scene(scenes.shafts(scenes.OLDHAM), 1.0, 0.01, *kn, *FIXED)
            way = np.linalg.norm(run["joint/displacement"][:, 2, 1:], axis=1)
            self.assertLess(np.abs(way - 0.1 * np.abs(np.sin(5 * run["time"]))).max(), 8.5e-8)

    def test_velocities_that_do_not_fit(self):
        """One upright of four bars is struck, the others rest: what joints do not allow is gone at once, where split2
        rings. In the end both have the same energy and place."""
        def struck():
            build = scenes.four_bars(1)
            build.gravity = None
            speed = [k for k, card in enumerate(build.cards) if card.startswith("/INIVEL")]
            for k in speed[2:]:
                build.cards[k] = "\n".join([*build.cards[k].split("\n")[:2], scenes.reals(0, 0, 0) + build.cards[k].split("\n")[2][60:]])
            return build

        fast = scene(struck(), 0.7, 0.07, *FIXED, "--sample", 0.007)
        slow = scene(struck(), 0.7, 0.07, integrator="split2")
        kinetic = [(run["kinetic_energy_trans"] + run["kinetic_energy_rot"])[-1] for run in (fast, slow)]
        self.assertLess(abs(kinetic[0] - kinetic[1]), 1e-4)
        self.assertLess(np.abs(position(fast)[-1] - position(slow)[-1]).max(), 1.5e-4)
        self.assertIn("KJ-9047", fast.text)

    def test_chain(self):
        fine = scene(scenes.chain(50), 0.3, 0.003, *INF, *FIXED, "--sample", 0.3/3200)
        run = scene(scenes.chain(50), 0.3, 0.003, *INF, *FIXED)
        self.assertLess(apart(run, fine), 8.5e-5)

    def test_a_hub_with_many_arms(self):
        """Arms on one body do not couple: each moves as if it were alone"""
        alone = scene(scenes.chain(3), 0.3, 0.01, *INF, *FIXED)
        many = scene(scenes.chain(60, hubs=20), 0.3, 0.01, *INF, *FIXED)
        place = position(many)[:, 1:].reshape(31, 20, 3, 3) - np.array([0, 1, 0]) * np.arange(20)[None, :, None, None]
        self.assertLess(np.abs(place - position(alone)[:, None, 1:]).max(), 1e-9)

    def test_start_that_does_not_fit(self):
        """Velocities that the joints do not allow: their energy is lost at once and told"""
        build = scenes.four_bars()
        build.rod((0, 0, 1), (1, 0, 1), velocity=(0, 0.5, 0))
        bad = scenes.Scene(1e7)
        ground = bad.body((0, 0, 0), 1, (1, 1, 1), held=True)
        rod = bad.rod((0, 0, 0), (1, 0, 0), velocity=(0, 1, 0))
        bad.join(scenes.REVOLUTE, ground, rod, (0, 0, 0), (0, 0, 1))
        run = scene(bad, 0.1, 0.01, *INF)
        # v = 1, w = 0: momentum about the hinge m v l/2 = J w, J = m l^2/3: 0.375 J of 0.5 J stay
        kinetic = (run["kinetic_energy_trans"] + run["kinetic_energy_rot"])[0]
        self.assertAlmostEqual(kinetic, 0.375, delta=1e-3)
        self.assertIn("KJ-9047", run.text)

    def test_all_kn_are_finite_or_an_error(self):
        for kn in (("--kn-scale", 1e-3), ("--kn-scale", 1.0), ("--kn-scale", 1e5), INF):
            run = scene(scenes.slider_crank(), 1.0, 0.1, *FIXED, *kn, fails=True)
            self.assertTrue(run.finite())

    def test_energy_has_no_trend(self):
        """400 s of a pendulum on a hinge: balance of kinetic energy, work on the joint and potential"""
        run, _ = benchmark("IFA01", *INF, *FIXED, "--sample", 0.02, "--until", 400)
        drift, swing = trend(run)
        self.assertLess(drift, 1e-5)
        self.assertLess(swing, 2e-3)

    def test_a_run_that_cannot_go_on_leaves_numbers(self):
        """A step far too long for its passes is halved; where no step goes it is an error that names joint and time.
        In a history there are numbers only."""
        for build, kn in ((scenes.slider_crank, INF), (scenes.bricard, INF), (scenes.bricard, ())):
            for h in (0.1, 0.25, 0.5):
                run = scene(build(), 1.0, h, *FIXED, *kn, fails=True)
                self.assertTrue(run.finite())
                if run.status:
                    self.assertIn("does not converge", run.text)


    def test_drives_that_joints_do_not_allow_end_with_an_error(self):
        """A slider drawn beyond the reach of its rods: steps of 1e-11 s and forces of 1e21 N for ever, before"""
        build = scenes.slider_crank()
        build.drive(4, "IMPVEL", "X", ((0, 0.5), (9, 0.5)))
        run = scene(build, 1.0, 0.01, *INF, fails=True)
        self.assertIn("does not converge", run.text)
        self.assertTrue(run.finite())

    def test_tolerances_beyond_rounding_do_not_crawl(self):
        """What the position stage leaves is noise in the error of a step: it took steps of 1e-11 s"""
        for kn in (INF, ()):
            self.assertLess(scene(scenes.bricard(), 0.01, 0.01, *kn, "--error", 1e-12).cycles, 2000)

    def test_a_kn_that_no_step_sees_stores_next_to_nothing(self):
        """Bricard with 1e13 N/m: 140 J, 380 times the kinetic energy, were told as elastic, as many given back as lost"""
        run = scene(scenes.bricard(1e13), 0.2, 0.01)
        for channel in ("joint/elastic_energy", "joint/dissipated_energy"):
            self.assertLess(np.abs(run[channel]).max(), 1e-3 * run["kinetic_energy_rot"].max())


def trend(run):
    """Last against first tenth, and swing, of kinetic + work on joints + potential, over the largest kinetic energy"""
    kinetic = run["kinetic_energy_trans"] + run["kinetic_energy_rot"]
    s = (kinetic + run["internal_energy"] + run["potential_energy"]) / kinetic.max()
    tenth = len(s) // 10
    return abs(s[:tenth].mean() - s[-tenth:].mean()), s.max() - s.min()


class HundredThousandSteps(unittest.TestCase):
    """Limits of the balance: ten times what the prototype had in a tenth of the steps, 1.5e-5. Four bars turn over and
    pass their singular position twice a turn."""

    def test_four_bars(self):
        for kn in (INF, ()):
            run = scene(scenes.four_bars(1), 1000.0, 0.01, *kn, *FIXED)
            self.assertEqual(run.cycles, 100000)             # no step is halved on its way through
            self.assertLess(trend(run)[0], 1.5e-4)

    def test_slider_crank(self):
        run = scene(scenes.slider_crank(), 500.0, 0.005, *INF, *FIXED)
        self.assertEqual(run.cycles, 100000)
        self.assertLess(trend(run)[0], 1.5e-4)


class Limits(unittest.TestCase):
    """Stops, friction and locks of /PROP/KJOINT2: a block of 2 kg on a rail"""

    def block(self, dof, velocity, until, *options, sensor=0, extra=(), kn=1e7, kind=limits.TRANSLATIONAL):
        prop = limits.joint(kind, [dof], kn=kn, sensor=sensor)
        root = pathlib.Path(FOLDER.name) / "block"
        pathlib.Path(f"{root}_0000.rad").write_text(
            limits.starter([limits.Body(**{
            "velocity" if kind == limits.TRANSLATIONAL else "spin": (velocity, 0, 0)})], prop, extra=extra))
        pathlib.Path(f"{root}_0001.rad").write_text(limits.engine(until))
        return Run([f"{root}_0000.rad"], "--error", "1e-5", *options)

    def test_friction_stops_it(self):
        """9 N take 3 m/s in 2 v^2/(2 F/m) = 1 m, and 9 J"""
        run = self.block(limits.dof(stiffness=1e6, limit=9.0), 3.0, 1.0)
        self.assertAlmostEqual(run["joint/displacement"][-1, 0, 0], 1.0, delta=1e-3)
        self.assertAlmostEqual(run["joint/friction_energy"][-1, 0], 9.0, delta=0.01)
        self.assertLess(abs(run["energy_error"]).max(), 1e-3)

    def test_a_stop_gives_back_what_it_got(self):
        """To a stop at 0.05 m with 1 m/s and back: speed -1"""
        run = self.block(limits.dof(high=0.05, stiffness=1e5), 1.0, 0.12)
        self.assertAlmostEqual(run["rigid_body/velocity"][-1, -1, 0], -1.0, delta=2e-3)
        self.assertLess(abs(run["energy_error"]).max(), 2e-3)

    def test_a_lock_takes_the_speed_at_once(self):
        """A sensor at 0.1 s: the block stops at 0.1 m, and its 1 J is lost in the joint. The lock is not rigid:
        1/(1 + (h w)^2/2)^2, 0.7 % of it for h = 2 ms, goes in the next step, whose ledger is second order."""
        run = self.block(limits.dof(), 1.0, 0.2, sensor=3, extra=["/SENSOR/TIME/3", "lock", limits.reals(0.1)])
        self.assertAlmostEqual(run["joint/displacement"][-1, 0, 0], 0.1, delta=1e-5)
        self.assertAlmostEqual(run["joint/dissipated_energy"][-1, 0], 1.0, delta=1e-2)
        self.assertLess(abs(run["rigid_body/velocity"][-1, -1, 0]), 1e-6)
        self.assertLess(abs(run["energy_error"]).max(), 1e-2)

    def test_a_lock_of_a_hinge(self):
        """0.5 kg m^2 with 2 rad/s: 1 J. The loss was counted as if the hinge had stood still before"""
        run = self.block(limits.dof(), 2.0, 0.2, sensor=3, extra=["/SENSOR/TIME/3", "lock", limits.reals(0.1)],
                         kind=limits.REVOLUTE)
        self.assertAlmostEqual(run["joint/dissipated_energy"][-1, 0], 1.0, delta=1e-2)
        self.assertLess(abs(run["energy_error"]).max(), 1e-2)


class WaysToRun(unittest.TestCase):
    def test_split2_tells_what_compliant_would_cost(self):
        """Steps and error of the summary, against a run with that error"""
        told = scene(scenes.slider_crank(), 0.05, 0.01, integrator="split2")
        steps, error = re.search(r"--fast +this error in about (\d+) cycles, \d+ times as fast: --error (\S+)", told.text).groups()
        fine = scene(scenes.slider_crank(), 0.05, 0.01, *INF, *FIXED, "--sample", 0.05/4000)
        fast = scene(scenes.slider_crank(), 0.05, 0.01, *INF, "--error", error)
        self.assertLess(apart(fast, fine), 1.5e-6)             # F/Kn of its joints, 1e-6 m
        self.assertLess(fast.cycles, 3 * int(steps))
        slow = scene(scenes.pair(), 0.05, 0.01, integrator="split2")
        self.assertNotIn("--fast", slow.text)                  # nothing to gain

    def test_threads_give_the_same_bits(self):
        one = scene(scenes.chain(60, hubs=20), 0.2, 0.01)
        two = scene(scenes.chain(60, hubs=20), 0.2, 0.01, "--threads", 2, "--least-share", 1)
        for channel in ("rigid_body/position", "joint/force", "joint/dissipated_energy"):
            self.assertTrue(np.array_equal(one[channel], two[channel]), channel)

    def test_islands(self):
        one = scene(scenes.chain(6, hubs=2), 0.2, 0.01)
        parts = scene(scenes.chain(6, hubs=2), 0.2, 0.01, "--islands")
        self.assertLess(apart(one, parts), 1e-4)

    def test_a_checkpoint_goes_on_with_the_same_bits(self):
        root = pathlib.Path(FOLDER.name) / "stopped"
        scenes.slider_crank().write(root, 1.0, 0.01)
        words = [PROGRAM, "run", f"{root}_0000.rad", f"{root}_0001.rad", "--integrator", "compliant", *INF, *FIXED, "-q"]
        for more in (["-o", f"{root}.h5"], ["-o", f"{root}2.h5", "--until", "0.5", "--checkpoint"],
                     ["-o", f"{root}2.h5", "--until", "1.0", "--restart", f"{root}2.restart.h5"]):
            subprocess.run(words + more, check=True, stdout=subprocess.DEVNULL)
        with h5py.File(f"{root}.h5") as whole, h5py.File(f"{root}2.h5") as halves:
            for channel in ("rigid_body/position", "rigid_body/velocity", "joint/force"):
                self.assertTrue(np.array_equal(whole[channel], halves[channel]), channel)


if __name__ == "__main__":
    unittest.main()
