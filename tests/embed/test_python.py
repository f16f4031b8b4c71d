#!/usr/bin/env python3
"""The Python module on both levels. usage: test_python.py REV01_0000.rad UNI01_0000.rad"""
import os
import pathlib
import signal
import sys
import tempfile
import threading
import unittest

import numpy as np

import kjoint

REV01, UNI01 = sys.argv[1:3]
LOA01 = REV01.replace("REV01", "LOA01")
# inertia of body 2 of REV01 as its deck has it
INERTIA = np.array([[0.026251216830485567, -7.9851351636942e-03, 0.010973497550995382],
                    [-7.9851351636942e-03, 0.047342852654973957, 0.003125608415245281],
                    [0.010973497550995382, 0.003125608415245281, 0.056405930519940466]])


def matrix(q):
    w, x, y, z = q
    return np.array([[1 - 2*(y*y + z*z), 2*(x*y - w*z), 2*(x*z + w*y)],
                     [2*(x*y + w*z), 1 - 2*(x*x + z*z), 2*(y*z - w*x)],
                     [2*(x*z - w*y), 2*(y*z + w*x), 1 - 2*(x*x + y*y)]])


def turned(phi, q):
    angle = np.linalg.norm(phi)
    p = np.r_[np.cos(angle/2), np.sinc(angle/2/np.pi)*phi/2]
    return np.r_[p[0]*q[0] - p[1:] @ q[1:], p[0]*q[1:] + q[0]*p[1:] + np.cross(p[1:], q[1:])]


def free_body():
    m = kjoint.Mechanism("free")
    body = m.body(2.0, (1, 1, 1), at=(1, 0, 0))
    m.joint("free", m.ground(), body, at=(0, 0, 0))
    return m.model(until=1.0, sample=0.1, dt_scale=0.5), body


def threads_of_process():
    """None where the system does not tell"""
    return len(os.listdir("/proc/self/task")) if os.path.isdir("/proc/self/task") else None


def with_openmp():
    with open("/proc/self/maps") as maps:
        return "libgomp" in maps.read()


class Models(unittest.TestCase):
    def test_a_restored_model_goes_on_with_the_same_bits(self):
        for options in (dict(formulation="legacy"), {}):
            whole = kjoint.Model(REV01, until=0.02, sample=1e-3, **options).start()
            whole.advance(0.01)
            kept = pathlib.Path("state")               # by a file of the host
            kept.write_bytes(whole.save())
            state = kept.read_bytes()
            other = kjoint.Model(REV01, until=0.02, sample=1e-3, **options).restore(state)
            for model in (whole, other):
                model.advance(0.02)
                model.sample()
            for channel in ("time", "joint/force", "rigid_body/position"):
                np.testing.assert_array_equal(whole[channel], other[channel])

    def test_a_state_of_another_deck_or_a_cut_one_is_refused(self):
        state = kjoint.Model(REV01).start().save()
        for deck, bytes_, options, why in (
                (UNI01, state, {}, "another deck"), (REV01, state[:-8], {}, "damaged"),
                (REV01, b"", {}, "no saved state"), (REV01, state + b"x", {}, "damaged"),
                (REV01, state, dict(kn_scale=2.0), "saved with"),
                (REV01, state, dict(formulation="legacy"), "saved with")):
            with self.assertRaisesRegex(kjoint.Error, why):
                kjoint.Model(deck, **options).restore(bytes_)
        with self.assertRaisesRegex(kjoint.Error, "not started"):
            kjoint.Model(REV01).save()

    def test_stepping_gives_the_bits_of_a_run(self):
        options = dict(until=0.02, sample=1e-3, formulation="legacy")
        run = kjoint.Model(REV01, **options).run()
        stepped = kjoint.Model(REV01, **options).start()
        for i in range(20):
            stepped.advance(i*1e-3)
            stepped.sample()
        for channel in ("time", "joint/force", "rigid_body/position", "external_work"):
            np.testing.assert_array_equal(run[channel][:20], stepped[channel])

    def test_two_threads_give_the_bits_of_one(self):
        # 1000 joints: a thread takes 500 at least
        m = kjoint.Mechanism("chain", gravity=(0, 0, -9.81))
        last = m.ground()
        for i in range(1000):
            link = m.body(0.2, (2e-5, 2e-4, 2e-4), at=(0.1*i + 0.05, 0, 0), omega=(i % 7, 0, 1))
            m.joint("spherical", last, link, at=(0.1*i, 0, 0))
            last = link
        for formulation in ("consistent", "legacy"):
            options = dict(until=5e-4, sample=1e-4, formulation=formulation)
            one = m.model(**options, threads=1).run()
            before = threads_of_process()
            two = m.model(**options, threads=2).run()
            if formulation == "consistent" and before and with_openmp():
                self.assertGreater(threads_of_process(), before)
            for channel in ("time", "joint/force", "rigid_body/position", "rigid_body/velocity"):
                np.testing.assert_array_equal(one[channel], two[channel])

    def test_a_constant_load_does_what_newton_says(self):
        # v = F t/m = 3*0.5/2, x - x0 = F t^2/(2 m); leap-frog is exact here
        model, body = free_body()
        model.start()
        model.set_body_load(body, force=(3, 0, 0))
        model.advance(0.5)
        model.sample()
        state = model.body(body)
        self.assertAlmostEqual(state.velocity[0], 0.75, 12)
        self.assertAlmostEqual(state.position[0], 1.0 + 3*0.25/4, 12)
        # all of it is external work: 0.5 m v^2
        self.assertAlmostEqual(model.status.work, 0.5*2*0.75**2, 12)

    def test_factor_of_a_load(self):
        def pushed(factor):
            model = kjoint.Model(LOA01, until=0.05, sample=0.01).start()
            if factor is not None:
                model.set_load_factor(11, factor)
            model.advance(0.05)
            return np.array(model.body(model.bodies[-1]).velocity)
        np.testing.assert_array_equal(pushed(None), pushed(1.0))
        self.assertGreater(np.linalg.norm(pushed(2.0) - pushed(1.0)), 1e-6)

    def test_a_body_that_is_put_elsewhere_strains_its_joint(self):
        # turned by 0.1 about the hinge of REV01: moment Krx*0.1 = 4 about x, nothing else
        model = kjoint.Model(REV01, until=1.0, sample=0.1).start()
        free = kjoint.Model(REV01, formulation="legacy").start()       # without the force of gravity
        axis = np.array(free.joint(900).frame)[0]
        turn = turned(0.1*axis, np.array([1.0, 0, 0, 0]))
        model.set_body_velocity(2, (0, 0, 0))
        model.set_body_pose(2, matrix(turn) @ free.body(2).position, turn)
        joint = model.joint(900)
        np.testing.assert_allclose(joint.displacement, [0, 0, 0, 0.1, 0, 0], atol=1e-12)
        np.testing.assert_allclose(joint.force, [0, 0, 0, 4.0, 0, 0], atol=1e-6)

    def test_a_legacy_body_turns_by_less_than_a_radian_in_a_step(self):
        # about its hinge, which goes through the origin; the one before was slower than the first
        model = kjoint.Model(REV01, until=1.0, sample=0.1, formulation="legacy").start()
        axis = np.array(model.joint(900).frame)[0]
        for turn in (0.01, 0.0, 1.01):
            omega = turn/model.status.time_step*axis
            model.set_body_velocity(2, np.cross(omega, model.body(2).position), omega)
            if turn < 1:
                model.step()
        with self.assertRaisesRegex(kjoint.Error, r"body 2 \(2\) turns by more than 1 rad"):
            model.step()

    def test_the_limit_is_found_anew_every_eighth_step(self):
        # of a knee that swings, whoever asks for the steps: the eighth is the last of its length.
        # One call takes them all.
        deck = pathlib.Path(__file__).parents[2]/"decks"/"knee_0000.rad"
        alone, together = (kjoint.Model(deck).start() for _ in range(2))
        lengths = []
        for _ in range(400):
            alone.step()
            lengths.append(alone.status.time_step)
        changes = np.flatnonzero(np.diff(lengths)) + 1   # what comes is said after the step
        self.assertGreater(len(changes), 3)
        self.assertEqual(set(changes % 8), {7})
        together.step(400)
        np.testing.assert_array_equal(together.body(2).position, alone.body(2).position)

    def test_a_second_run_gives_the_bits_of_the_first(self):
        # a run begins with shorter steps for a while: that, too, begins anew
        for formulation in ("consistent", "legacy"):
            model = kjoint.Model(REV01, until=0.02, sample=1e-3, formulation=formulation)
            first = model.run()["joint/force"]
            np.testing.assert_array_equal(first, model.run()["joint/force"])
            model.start()
            for time in first[:, 0, 0]:
                model.step()
            np.testing.assert_array_equal(first, model.run()["joint/force"])

    def test_legacy_samples_come_an_interval_after_the_last_or_with_the_next_cycle(self):
        # steps of 0.028 until a spring becomes stiff, then short ones: what was missed is not made up
        m = kjoint.Mechanism("stiff")
        body = m.body(1.0, (1, 1, 1), at=(0, 0, 0), velocity=(1, 0, 0))
        m.joint("free", m.ground(), body, at=(0, 0, 0), k={"tx": 1e3})
        points = "".join(f"{x:20g}{y:20g}\n" for x, y in ((-1, -1), (0.02, 0.02), (0.22, 40.02)))
        text = m.deck().replace("/FUNCT/1\n", f"/FUNCT/2\nstiff\n{points}/FUNCT/1\n")
        text = text.replace(f"{1e3:20.13e}         0", f"{1e3:20.13e}         2", 1)
        self.addCleanup(os.remove, "stiff_0000.rad")
        with open("stiff_0000.rad", "w") as file:
            file.write(text)
        options = dict(until=0.15, formulation="legacy")
        cycles = kjoint.Model("stiff_0000.rad", sample=0.0, **options).run()["time"]
        steps = np.diff(cycles)
        self.assertGreater(steps[0], 0.02)
        self.assertLess(steps.min(), 0.005)
        wanted, following = [], 0.0
        for time in cycles:
            if time >= following:
                wanted.append(time)
                following = max(time, following + 0.01)
        found = kjoint.Model("stiff_0000.rad", sample=0.01, **options).run()["time"]
        np.testing.assert_array_equal(wanted, found[:len(wanted)])
        self.assertLessEqual(len(found), len(wanted) + 1)        # the last state

    def test_consistent_samples_stand_at_their_times(self):
        found = kjoint.Model(REV01, until=0.02, sample=0.003).run()["time"]
        np.testing.assert_array_equal([0.003*i for i in range(7)] + [0.02], found)

    def test_islands_add_up_to_the_scene(self):
        # two sliders of 2 and 4 kg, 0.1 s under 3 N each: work F^2 t^2/(2 m) = 0.0225 + 0.01125
        m = kjoint.Mechanism("two")
        bodies = [m.body(mass, (1, 1, 1), at=(0, y, 0)) for mass, y in ((2.0, 0), (4.0, 1))]
        for body, y in zip(bodies, (0, 1)):
            m.joint("translational", m.ground(), body, at=(0, y, 0))
        loads = "".join(f"/CLOAD/{body}\npush\n{1:10d}         X         0         0{9200000 + body:10d}"
                        f"         1{1.0:20.1f}{3.0:20.1f}\n" for body in bodies)
        with tempfile.TemporaryDirectory() as folder:
            deck = os.path.join(folder, "two_0000.rad")
            with open(deck, "w") as file:
                file.write(m.deck().replace("/TH/SPRING/1\n", loads + "/TH/SPRING/1\n"))
            for islands in (False, True):
                run = kjoint.Model(deck, until=0.1, sample=0.05, islands=islands).run()
                self.assertAlmostEqual(0.03375, run["external_work"][-1], 6)
                self.assertAlmostEqual(0.03375, run["kinetic_energy_trans"][-1], 6)
                self.assertLess(abs(run["energy_error"][-1]), 1e-6)

    def test_a_locked_joint_stays(self):
        m = kjoint.Mechanism("locked", gravity=(0, 0, -9.81))
        bar = m.body(1.0, (0.01, 0.1, 0.1), at=(0.5, 0, 0))
        m.joint("revolute", m.ground(), bar, at=(0, 0, 0), axis=(0, 1, 0),
                stops={"rx": (-3, 3)})
        model = m.model(until=1.0, sample=0.01).start()
        model.advance(0.2)
        model.lock_joint(1)
        held = model.joint(1).displacement[3]
        self.assertGreater(abs(held), 0.1)
        model.advance(0.6)
        self.assertLess(abs(model.joint(1).displacement[3] - held), 0.01)
        model.lock_joint(1, False)
        model.advance(0.8)
        self.assertGreater(abs(model.joint(1).displacement[3] - held), 0.05)

    def test_a_history_file(self):
        try:
            import h5py
        except ImportError:
            self.skipTest("no h5py")
        model = kjoint.Model(UNI01, until=0.01, sample=1e-3).run()
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "x.h5")
            try:
                model.write_history(path)
            except kjoint.Error as error:
                self.assertEqual(error.status, 3)
                self.skipTest("built without HDF5")
            with h5py.File(path) as file:
                np.testing.assert_array_equal(file["joint/force"][:], model["joint/force"])

    @staticmethod
    def slider():
        """2 kg on a slider along x, at rest."""
        m = kjoint.Mechanism()
        mass = m.body(2.0, (1, 1, 1), at=(0, 0, 0), name="mass")
        m.joint("translational", m.ground(), mass, at=(0, 0, 0))
        return m

    def driven(self, card, columns, text, blocks=(), keyword="/IMPVEL"):
        """The run of the slider, driven by v = t until 0.3, with another text in columns of a card of the motion."""
        m = self.slider()
        m.drive("mass", along=(1, 0, 0), velocity=[(0, 0), (1, 1)], stop=0.3)
        lines = m.deck().splitlines()
        motion = next(i for i, line in enumerate(lines) if line.startswith("/IMPVEL"))
        line = lines[motion + 1 + card]
        lines[motion + 1 + card] = line[:columns[0]] + text.rjust(columns[1] - columns[0]) + line[columns[1]:]
        lines[motion] = lines[motion].replace("/IMPVEL", keyword)
        lines[motion:motion] = blocks
        with tempfile.TemporaryDirectory() as folder:
            deck = pathlib.Path(folder, "driven_0000.rad")
            deck.write_text("\n".join(lines) + "\n")
            return kjoint.Model(deck, until=0.5, sample=0.1).run()

    def test_a_motion_ends_before_its_sensor_does(self):
        # by a sensor that never ends; then it coasts at 0.3
        run = self.driven(1, (30, 40), "77", ["/SENSOR/TIME/77", "on", f"{0.0:20}"])
        velocity = run["rigid_body/velocity[mass].x"]
        self.assertAlmostEqual(0.2, velocity[2], 2)
        np.testing.assert_allclose(velocity[4:], 0.3, atol=5e-3)

    def test_a_motion_whose_abscissa_is_scaled(self):
        # v = t/0.5: x = t**2; the work is the kinetic energy, v**2 of 2 kg
        run = self.driven(2, (0, 20), "0.5")
        t = run["time"][1:3]
        np.testing.assert_allclose(run["rigid_body/velocity[mass].x"][1:3], 2*t, rtol=1e-3)
        np.testing.assert_allclose(run["rigid_body/position[mass].x"][1:3], t**2, rtol=1e-3)
        np.testing.assert_allclose(run["external_work"][1:3], (2*t)**2, rtol=5e-3)

        # as an acceleration: a = t/0.5, v = t**2
        run = self.driven(2, (0, 20), "0.5", keyword="/IMPACC")
        np.testing.assert_allclose(run["rigid_body/velocity[mass].x"][1:3], t**2, rtol=1e-3)

    def test_a_slack_line_is_soft_across(self):
        # k = 1e4 N/m along x at an arm a of 0.1 m along x, J = 1e-6 kg m2: a line without force turns nothing; as stiff
        # across as along it would allow steps of 2 sqrt(J/(k a**2)) = 2e-4 s. Along: 2 sqrt(m/k) = 0.02 s, and some of it
        m = kjoint.Mechanism()
        tip = m.body(1.0, (1e-6, 1e-6, 1e-6), at=(1.1, 0, 0))
        m.spring(m.ground(), tip, at_1=(0, 0, 0), at_2=(1, 0, 0), k=1e4)
        step = m.run(until=1.0, sample=1.0).status.time_step
        self.assertGreater(step, 2e-3)
        self.assertLess(step, 0.02)

    def test_a_last_state_between_samples_says_so(self):
        run = self.slider().run(until=0.25, sample=0.1)
        self.assertEqual([0, 0, 0, 1], list(run["final"]))
        np.testing.assert_allclose(run["time"], [0, 0.1, 0.2, 0.25], rtol=1e-9)
        self.assertEqual([0, 0, 0], list(self.slider().run(until=0.2, sample=0.1)["final"]))

    def test_the_work_of_a_load_is_force_times_way(self):
        m = self.slider()
        m.load("mass", force=(10.0, 0, 0))                   # x = 10/2 t**2/2
        run = m.run(until=0.4, sample=0.1)
        x = run["rigid_body/position[mass].x"]
        np.testing.assert_allclose(x[1:], 2.5*run["time"][1:]**2, rtol=1e-3)
        np.testing.assert_allclose(run["external_work"][1:], 10*x[1:], rtol=1e-6)
        speed = run["rigid_body/velocity[mass].x"]
        np.testing.assert_allclose(run["rigid_body/kinetic_energy[mass]"], 2.0*speed**2/2, rtol=1e-12)

    def test_a_spring_stores_and_its_damper_takes(self):
        # 2 kg on 50 N/m with 2 N s/m, from 1 m/s: what is gone from 1 J of motion is in the joint
        m = kjoint.Mechanism()
        mass = m.body(2.0, (1, 1, 1), at=(0, 0, 0), name="mass", velocity=(1, 0, 0))
        m.joint("translational", m.ground(), mass, at=(0, 0, 0), name="guide", k={"tx": 50.0}, c={"tx": 2.0})
        run = m.run(until=1.0, sample=0.1)
        x = run["joint/displacement[guide].x"]
        elastic, dissipated = run["joint/elastic_energy[guide]"], run["joint/dissipated_energy[guide]"]
        np.testing.assert_allclose(elastic, 50*x**2/2, rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(elastic + dissipated, run["joint/internal_energy[guide]"], rtol=1e-12, atol=1e-15)
        np.testing.assert_allclose(run["joint/internal_energy[guide]"],
                                   1.0 - run["rigid_body/kinetic_energy[mass]"], atol=1e-5)

    def test_a_run_is_watched_and_stopped(self):
        seen = []
        model = kjoint.Model(REV01, until=100.0, sample=1.0)
        model.run(lambda status: seen.append(status.time) or len(seen) > 2)
        self.assertLess(model.status.time, 100.0)
        self.assertGreater(len(seen), 2)

    def test_errors(self):
        with self.assertRaisesRegex(kjoint.Error, "no formulation"):
            kjoint.Model(REV01, formulation="fast")
        with self.assertRaisesRegex(kjoint.Error, "no option 'speed'"):
            kjoint.Model(REV01, speed=3)
        with self.assertRaises(kjoint.Error):
            kjoint.Model("no_such_0000.rad")
        model = kjoint.Model(REV01, until=0.1)
        with self.assertRaisesRegex(kjoint.Error, "no channel"):
            model["joint/farce"]
        with self.assertRaisesRegex(kjoint.Error, "not free"):
            m = kjoint.Mechanism()
            m.joint("revolute", m.ground(), m.body(1, (1, 1, 1), (1, 0, 0)), (0, 0, 0),
                    k={"ty": 1.0})


class Elements(unittest.TestCase):
    def march(self, h, until, break_at=None):
        """Body 2 of REV01 by a leap-frog in Python, its joint from the deck."""
        model = kjoint.Model(REV01, until=1.0, sample=0.1).start()
        joints = kjoint.Joints(2)
        x = np.array([model.body(id).position for id in (1, 2)])
        v, w = np.zeros((2, 3)), np.zeros((2, 3))
        q = np.array([[1.0, 0, 0, 0]]*2)
        v[1], w[1] = model.body(2).velocity, model.body(2).omega
        joints.take(model, [100, 200], q)
        q[1] = model.body(2).attitude             # where the joint bears its force, as the model
        for cycle in range(round(until/h)):
            f, m = np.zeros((2, 3)), np.zeros((2, 3))
            f[1, 2] = -9.81*2
            joints.forces(cycle*h, h if cycle else 0.0, x, v, w, f, m, q)
            kick = h if cycle else h/2
            r = matrix(q[1])
            j = r @ INERTIA @ r.T
            v[1] += kick*f[1]/2
            w[1] += kick*np.linalg.solve(j, m[1] - np.cross(w[1], j @ w[1]))
            x[1] += h*v[1]
            q[1] = turned(h*w[1], q[1])
            if cycle == break_at:                 # save, spoil, restore
                state = joints.state
                spare = kjoint.Joints(2)
                spare.take(model, [100, 200], np.array([[1.0, 0, 0, 0]]*2))
                spare.state = state
                joints = spare
        return x[1], joints

    def test_a_host_gives_what_the_model_gives(self):
        until = 0.04
        model = kjoint.Model(REV01, until=1.0, sample=0.1, dt_scale=0.1).start()
        model.advance(until)
        place = np.array(model.body(2).position)
        coarse = np.linalg.norm(self.march(4e-5, until)[0] - place)
        fine = np.linalg.norm(self.march(2e-5, until)[0] - place)
        # the joint of the host begins without a force, that of the model bears up to the weight: 2 kg g/Kn
        self.assertLess(fine, 2e-6 + 2*9.81/1e6)
        self.assertLess(fine, coarse)

    def test_a_restored_state_goes_on_with_the_same_bits(self):
        np.testing.assert_array_equal(self.march(4e-5, 0.004)[0],
                                      self.march(4e-5, 0.004, break_at=50)[0])

    def test_laws_step_and_energy(self):
        # a free joint along x: curve 20 q for q > 0; the host moves node 1 to q = 0.5 in one step:
        # force 10 on node 0, -10 on node 1, work (0 + 10)/2*0.5 = 2.5
        joints = kjoint.Joints(2)
        curve = joints.curve([-1, 0, 1], [-5, 0, 20])
        joints.add("free", (0, 1), k_curve={0: curve})
        x, zero, q = np.zeros((2, 3)), np.zeros((2, 3)), np.array([[1.0, 0, 0, 0]]*2)
        joints.start(x, [0, 4.0], np.ones((2, 3)), q)
        joints.forces(0.0, 0.0, x, zero, zero, np.zeros((2, 3)), np.zeros((2, 3)), q)
        x[1, 0] = 0.5
        f, m = np.ones((2, 3)), np.zeros((2, 3))
        joints.forces(0.1, 0.1, x, zero, zero, f, m, q)
        np.testing.assert_allclose(f, [[11, 1, 1], [-9, 1, 1]])
        self.assertAlmostEqual(joints.energy[0], 2.5, 12)
        # steepest slope 20, mass 4 against a held node: omega^2 = 5, h = 2/omega
        self.assertAlmostEqual(joints.critical_step, 2/np.sqrt(5), 9)
        self.assertEqual(len(joints), 1)
        self.assertEqual(joints.result(0).type, 9)
        with self.assertRaises(kjoint.Error):
            joints.forces(0.2, 0.1, x[:1], zero, zero, f, m, q)

    def test_each_of_many_joints_has_its_own_law(self):
        # springs of 5 and 7 along x, free and translational, all to node 0; at 0.1 each pulls back
        laws = [("free", 5.0), ("free", 5.0), ("translational", 5.0), ("free", 7.0),
                ("translational", 5.0), ("translational", 7.0), ("translational", 7.0)]*6
        n = len(laws)
        for formulation in ("consistent", "legacy"):
            joints = kjoint.Joints(n + 1, formulation)
            for i, (kind, k) in enumerate(laws):
                joints.add(kind, (0, i + 1), k=(k, 0, 0, 0, 0, 0), **({} if kind == "free" else {"kn": 100.0}))
            x, zero, q = np.zeros((n + 1, 3)), np.zeros((n + 1, 3)), np.tile([1.0, 0, 0, 0], (n + 1, 1))
            joints.start(x, [0.0] + [4.0]*n, np.ones((n + 1, 3)), q)
            x[1:, 0] = 0.1
            f, m = np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
            joints.forces(0.0, 0.0, x, zero, zero, f, m, q)
            np.testing.assert_allclose(f[1:, 0], [-0.1*k for _, k in laws], atol=1e-12)
            np.testing.assert_allclose(f[0, 0], 0.1*sum(k for _, k in laws), atol=1e-12)

    def test_legacy_friction_goes_by_the_mean_of_two_steps(self):
        # sticking: r grows by k qdot (h_before + h)/2, and Cr sqrt(k m) qdot damps, m = 1*2/(1 + 2).
        # 1 mm in 0.1, the step before it 0: 500*0.01*0.05; 1 mm in 0.3: 500*0.01/3*0.2 more
        m = kjoint.Mechanism("slider")
        m.joint("translational", m.ground(), m.body(2.0, (1, 1, 1), at=(0, 0, 0)), at=(0, 0, 0),
                friction={"tx": (1e6, 500.0)})
        joints = kjoint.Joints(6, "legacy")
        joints.take(m.model(until=1.0, sample=1.0, formulation="legacy"),
                    [1, 2, 1010, 1011, 1012, 1013])
        x, zero = np.zeros((6, 3)), np.zeros((6, 3))
        x[4, 0] = x[5, 1] = 1.0                       # the axes of the joint
        damping = 0.05*np.sqrt(500*2/3)
        for time, h, q, wanted in ((0.0, 0.0, 0.0, 0.0), (0.1, 0.1, 1e-3, 0.25 + damping*1e-3/0.1),
                                   (0.4, 0.3, 2e-3, 0.25 + 1/3 + damping*1e-3/0.3)):
            x[1, 0] = x[3, 0] = q
            f = np.zeros((6, 3))
            joints.forces(time, h, x, zero, zero, f, np.zeros((6, 3)))
            np.testing.assert_allclose(f[:2, 0], [wanted, -wanted], rtol=1e-12)

    def test_nodal_stiffness_bears_the_legacy_step(self):
        # legacy: k of a blocked direction is (C + sqrt(C^2 + k m))^2/m with C = cr sqrt(k m), and
        # the node gets twice that; m = 4 here, its other end is held: s = k (cr + sqrt(cr^2 + 1))^2
        joints = kjoint.Joints(2, "legacy")
        joints.add("spherical", (0, 1), kn=100.0, cr=0.5)
        x, zero = np.zeros((2, 3)), np.zeros((2, 3))
        joints.start(x, [0, 4.0], np.ones((2, 3)))
        joints.forces(0.0, 0.0, x, zero, zero, np.zeros((2, 3)), np.zeros((2, 3)))
        kn, kr = joints.stiffness()
        np.testing.assert_allclose(kn, 2*100*(0.5 + np.sqrt(1.25))**2, rtol=1e-12)


class Misuse(unittest.TestCase):
    """What a host in Python may do wrong: an exception, and the interpreter lives on."""

    def model(self, **options):
        return kjoint.Model(REV01, until=0.02, sample=1e-3, **options)

    def refused(self, call, status=2):
        with self.assertRaises(kjoint.Error) as caught:
            call()
        self.assertEqual(status, caught.exception.status)
        return str(caught.exception)

    def test_what_watch_raises_comes_out_of_the_run(self):
        for raised in (ValueError("enough"), KeyboardInterrupt(), SystemExit(3)):
            seen = []

            def watch(status):
                seen.append(status.cycle)
                raise raised

            model = self.model()
            with self.assertRaises(type(raised)) as caught:
                model.run(watch)
            self.assertIs(raised, caught.exception)
            self.assertEqual(1, len(seen))               # the run ended there
            self.assertEqual(0.02, model.run().status.time)

    def test_an_interrupt_ends_a_run(self):
        # signals that come while the run is in the library, and while it is in watch
        def send(status):
            os.kill(os.getpid(), signal.SIGINT)

        with self.assertRaises(KeyboardInterrupt):
            self.model().run(send)
        model = kjoint.Model(REV01, until=1e6, sample=1.0)
        before = signal.getsignal(signal.SIGINT)
        threading.Timer(0.2, send, [None]).start()
        with self.assertRaises(KeyboardInterrupt):
            model.run()
        self.assertIs(before, signal.getsignal(signal.SIGINT))

    def test_a_status_can_be_kept(self):
        kept = []
        self.model().run(lambda status: kept.append(status))
        cycles = [status.cycle for status in kept]
        self.assertEqual(sorted(set(cycles)), cycles[:-1])   # the last is told again at the end

    def test_a_running_model_is_only_read_by_who_watches_it(self):
        model = self.model()
        said = []

        def watch(status):
            self.assertEqual(status.cycle, model.status.cycle)
            for call in (model.run, model.start, model.step, lambda: model.advance(1.0),
                         model.sample, lambda: model.set_body_load(2)):
                said.append(self.refused(call))
            return True

        model.run(watch)
        self.assertLessEqual(6, len(said))
        for text in said:
            self.assertIn("runs", text)
        np.testing.assert_array_equal(self.model().run()["time"], model.run()["time"])

    def test_another_thread_is_refused(self):
        model, said = self.model(), []

        def other():
            for call in (model.run, model.start, lambda: model.status, lambda: model["time"],
                         lambda: model.write_history("x.h5"), lambda: model.title):
                said.append(self.refused(call))

        def watch(status):
            thread = threading.Thread(target=other)
            thread.start()
            thread.join()
            return True

        model.run(watch)
        self.assertLessEqual(6, len(said))
        for text in said:
            self.assertIn("another thread", text)

    def test_four_threads_on_one_model(self):
        model, ended = self.model(), []

        def use():
            for _ in range(5):
                try:
                    model.run()
                    ended.append("run")
                except kjoint.Error as error:
                    ended.append(error.status)

        threads = [threading.Thread(target=use) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(20, len(ended))
        self.assertIn("run", ended)
        self.assertLessEqual(set(ended), {"run", 2})

    def test_a_missing_file_is_a_file_error(self):
        self.refused(lambda: kjoint.Model("nowhere_0000.rad"), 3)
        self.refused(lambda: kjoint.Model(REV01, "nowhere_0001.rad"), 3)
        self.refused(lambda: self.model().run().write_history("/no/such/folder/x.h5"), 3)

    def test_a_text_is_one_text(self):
        with self.assertRaises(kjoint.Error):
            kjoint.Model(REV01, integrator="split2 islands=1")
        for call in (lambda: kjoint.Model(REV01 + "\0"), lambda: kjoint.Joints(2, "legacy\0"),
                     lambda: self.model().unit("time\0")):
            with self.assertRaises(kjoint.Error):
                call()

    def test_a_title_is_no_card(self):
        for text in ("a\n/END", "a\r/END", "/END", " /END", "# a", "$ a", "a\x1b[2J", "a\u2028b"):
            with self.assertRaises(kjoint.Error):
                kjoint.Mechanism(text)
            mechanism = kjoint.Mechanism("é, a title")
            with self.assertRaises(kjoint.Error):
                mechanism.body(1.0, (1, 1, 1), (0, 0, 0), name=text)
            body = mechanism.body(1.0, (1, 1, 1), (0, 0, 0))
            with self.assertRaises(kjoint.Error):
                mechanism.joint("revolute", mechanism.ground(), body, (0, 0, 0), name=text)
            mechanism.title = text
            with self.assertRaises(kjoint.Error):
                mechanism.deck()

    def test_a_number_stays_in_its_columns(self):
        # -1e-101 has an exponent of three digits: the next field must not be pushed away
        mechanism = kjoint.Mechanism("far")
        body = mechanism.body(2.0, (1, 1, 1), at=(-1e-101, -1.25, 2.5))
        mechanism.joint("free", mechanism.ground(), body, at=(0, 0, 0))
        model = mechanism.model(until=0.1, sample=0.1).start()
        np.testing.assert_array_equal([-1e-101, -1.25, 2.5], list(model.body(body).position))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
