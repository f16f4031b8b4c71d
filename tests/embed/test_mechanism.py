#!/usr/bin/env python3
"""kjoint.Mechanism against closed forms, its errors, and what Model and Run show of a run."""
import os
import pathlib
import tempfile
import unittest

import numpy as np

import kjoint


def slider(**laws):
    """2 kg on a slider along x from the ground, at rest."""
    m = kjoint.Mechanism("slider")
    mass = m.body(2.0, (1, 1, 1), at=(0, 0, 0), name="mass")
    m.joint("translational", m.ground(), mass, at=(0, 0, 0), name="guide", **laws)
    return m


def where(run, body="mass", axis="x"):
    return run[f"rigid_body/position[{body}].{axis}"]


class Physics(unittest.TestCase):
    def test_a_spring_swings(self):
        # 2 kg on 50 N/m: omega = 5 rad/s; from 1 m/s at rest length x = sin(5 t)/5
        m = kjoint.Mechanism("spring")
        mass = m.body(2.0, (1, 1, 1), at=(1, 0, 0), velocity=(1, 0, 0), name="mass")
        m.spring(m.ground(), mass, (0, 0, 0), (1, 0, 0), k=50.0, name="coil")
        run = m.run(until=1.0, sample=0.1, dt_scale=0.01)
        np.testing.assert_allclose(where(run), 1 + np.sin(5*run["time"])/5, atol=1e-5)
        self.assertEqual(("coil",), run.channel("spring/force").labels)

    def test_a_spring_by_points_is_that_of_its_slope(self):
        runs = [self.sprung(k) for k in (50.0, [(-1, -50), (1, 50)])]
        np.testing.assert_allclose(*map(where, runs), atol=1e-12)

    @staticmethod
    def sprung(k):
        m = kjoint.Mechanism("spring")
        mass = m.body(2.0, (1, 1, 1), at=(1, 0, 0), velocity=(1, 0, 0), name="mass")
        m.spring(m.ground(), mass, (0, 0, 0), (1, 0, 0), k=k)
        return m.run(until=0.2, sample=0.1, dt_scale=0.01)

    def test_a_load_over_time_pushes(self):
        # 4 N over 0.5 s, then nothing: v = 1 m/s, x = t^2 = 0.25 m, then 0.5 m more
        m = slider()
        m.load("mass", force=(4.0, 0, 0), over=[(0, 1), (0.5, 1), (0.5001, 0), (9, 0)])
        run = m.run(until=1.0, sample=0.5, dt_scale=0.01)
        np.testing.assert_allclose(where(run), [0, 0.25, 0.75], atol=1e-3)

    def test_a_load_beside_the_centre_turns(self):
        # 1 N at 0.5 m from the hinge: 0.5 N m on 2 kg m2, angle = 0.125 t^2
        m = kjoint.Mechanism("lever")
        lever = m.body(1.0, (2.0, 2.0, 2.0), at=(0, 0, 0), name="lever")
        m.joint("revolute", m.ground(), lever, at=(0, 0, 0), axis=(0, 0, 1), name="hinge")
        m.load(lever, force=(0, 1.0, 0), at=(0.5, 0, 0))
        run = m.run(until=0.2, sample=0.1)
        np.testing.assert_allclose(run["joint/rotation[hinge].x"], 0.125*run["time"]**2, atol=1e-5)

    def test_a_driven_crank_turns_as_told(self):
        # about an axis that is none of the world's: 3 rad/s, from 0; the rotation is 3 t, or as the points say
        for axis in ((0, 1, 0), (0, -1, 0), (0, 3, 4), (1, 1, 1)):
            for motion, angle in ((dict(velocity=3.0), 1.5), (dict(displacement=[(0, 0), (1, 2.0)]), 1.0)):
                m = kjoint.Mechanism("crank")
                crank = m.body(1.0, (0.1, 0.1, 0.1), at=(0, 0, 0), omega=3*np.array(axis)/np.linalg.norm(axis)
                               if "velocity" in motion else (0, 0, 0), name="crank")
                m.joint("revolute", m.ground(), crank, at=(0, 0, 0), axis=axis, name="hinge")
                m.drive(crank, turn=axis, **motion)
                run = m.run(until=0.5, sample=0.5, dt_scale=0.5)
                self.assertAlmostEqual(angle, run["joint/rotation[hinge].x"][-1], 2, msg=(axis, motion))

    def test_a_driven_slider_moves_as_told(self):
        m = slider()
        m.drive("mass", along=(1, 0, 0), displacement=[(0, 0), (1, 0.5)])
        self.assertAlmostEqual(0.25, where(m.run(until=0.5, sample=0.5))[-1], 3)

    def test_stops_friction_curves_and_locks(self):
        pushed = lambda **laws: slider(**laws)
        # a stop at 0.1 m of 1e5 N/m: v^2 = 2*5*0.1 = 1 m2/s2, so it gives by v sqrt(m/k) = 0.0045 m, and a little
        m = pushed(stops={"tx": (-1.0, 0.1, 1e5)})
        m.load("mass", force=(10.0, 0, 0))
        most = where(m.run(until=0.3, sample=1e-4)).max()
        self.assertAlmostEqual(0.1046, most, 3)
        # friction of 5 N holds 4 N, and gives 1 N of 6: x = t^2/4, and 0.001 as it needs 5e-7 m to act
        for force, x in ((4.0, 0.0), (6.0, 0.25)):
            m = pushed(friction={"tx": (5.0, 1e7)})
            m.load("mass", force=(force, 0, 0))
            self.assertAlmostEqual(x, where(m.run(until=1.0, sample=1.0))[-1], 2)
        # a spring by points, 50 N/m: 10 N stretch it to twice 0.2 m at most
        m = pushed(k={"tx": [(-1, -50), (0, 0), (1, 50)]})
        m.load("mass", force=(10.0, 0, 0))
        self.assertAlmostEqual(0.4, where(m.run(until=1.0, sample=1e-3)).max(), 3)
        # locked until 0.5 s, then free: x = a (t - 0.5)^2/2, a = 2
        m = pushed(locked=(0.0, 0.5))
        m.load("mass", force=(4.0, 0, 0))
        self.assertAlmostEqual(0.25, where(m.run(until=1.0, sample=1.0))[-1], 2)

    def test_all_nine_types_run(self):
        from kjoint.mechanism import TYPES
        self.assertEqual(9, len(TYPES))
        for kind in TYPES:
            m = kjoint.Mechanism(kind, gravity=(0, 0, -9.81))
            bar = m.body(1.0, (0.1, 0.1, 0.1), at=(0.3, 0, 0))
            m.joint(kind, m.ground(), bar, at=(0, 0, 0), axis=(0, 1, 0), axis_2=(0, 0, 1), name="j")
            self.assertLess(abs(m.run(until=0.1, sample=0.05)["energy_error"]).max(), 1e-3, kind)

    def test_units_are_those_of_the_mechanism(self):
        m = kjoint.Mechanism("mm", gravity=(0, 0, -9.81e-3), units=("kg", "mm", "ms"))
        m.joint("free", m.ground(), m.body(1.0, (1, 1, 1), at=(0, 0, 0), name="ball"), at=(0, 0, 0))
        run = m.run(until=100.0, sample=100.0, dt_scale=0.5)      # 0.1 s of fall: 49.05 mm
        self.assertAlmostEqual(-49.05, where(run, "ball", "z")[-1], 3)
        self.assertEqual("mm", run.unit("rigid_body/position"))


class SetJoint(unittest.TestCase):
    def test_a_set_law_gives_the_bits_of_a_deck_with_it(self):
        m = slider(k={"tx": 50.0}, c={"tx": 1.0}, stops={"tx": (-0.1, 0.1)}, kn=3e6, cr=0.2)
        m.load("mass", force=(10.0, 0, 0))
        other = slider()
        other.load("mass", force=(10.0, 0, 0))
        model = other.model(until=0.5, sample=0.01)
        model.set_joint("guide", k={"tx": 50.0}, c={"tx": 1.0}, stops={"tx": (-0.1, 0.1)})
        model.set_joint(1, kn=3e6, cr=0.2)
        run = m.run(until=0.5, sample=0.01)
        for channel in ("rigid_body/position", "joint/force", "energy_error"):
            np.testing.assert_array_equal(run[channel], model.run()[channel])

    def test_one_joint_of_two_with_one_property(self):
        # /PROP/KJOINT of the slider-crank: the type has Krx
        deck = os.path.join(os.environ["KJOINT_SOURCE_DIR"], "decks", "slider_crank_0000.rad")
        plain = kjoint.Model(deck, until=1e-3, sample=1e-4).run()
        model = kjoint.Model(deck, until=1e-3, sample=1e-4).set_joint("main bearing", k={"rx": 1e4}).run()
        self.assertFalse(np.array_equal(plain["joint/moment"], model["joint/moment"]))
        self.assertEqual("901.K_rx=10000.0", model.options["joint"])

    def test_what_is_wrong_is_said_and_the_model_stays(self):
        model = slider().model(until=0.1, sample=0.1)
        for what, laws in (("no joint 'guido', did you mean 'guide'", dict(joint="guido", kn=1.0)),
                           ("no joint \"7\"", dict(joint=7, kn=1.0)),
                           ("has no number K_rx", dict(joint=1, k={"rx": 1.0})),
                           ("lower stop is positive", dict(joint=1, stops={"tx": (0.1, 0.2)}))):
            with self.assertRaisesRegex(kjoint.Error, what):
                model.set_joint(**laws)
        self.assertEqual(2, len(model.run()["time"]))


class Errors(unittest.TestCase):
    def test_each_is_said_at_the_call(self):
        def wrong(what, call):
            with self.assertRaisesRegex(kjoint.Error, what) as caught:
                call()
            self.assertEqual(2, caught.exception.status)

        m = slider()
        at = dict(at=(0, 0, 0))
        wrong("no joint type 'revolut', did you mean 'revolute'", lambda: m.joint("revolut", 1, 2, **at))
        wrong("no joint type 11", lambda: m.joint(11, 1, 2, **at))
        wrong("mass of arm is -1, it must be above 0", lambda: m.body(-1, (1, 1, 1), name="arm", **at))
        wrong("mass of arm is nan", lambda: m.body(np.nan, (1, 1, 1), name="arm", **at))
        wrong("least inertia of arm is 0", lambda: m.body(1, (1, 1, 0), name="arm", **at))
        wrong("no body has a principal moment, 3, above", lambda: m.body(1, (1, 1, 3), name="arm", **at))
        wrong("are not three numbers", lambda: m.body(1, (1, 1, 1), at=(0, 0)))
        wrong("there is a body 'mass' already", lambda: m.body(1, (1, 1, 1), name="mass", **at))
        wrong("no body 'mas', did you mean 'mass'", lambda: m.joint("revolute", 1, "mas", **at))
        wrong("no body 7: there are 1 mass, 2 ground", lambda: m.joint("revolute", 1, 7, **at))
        wrong("joins mass to itself", lambda: m.joint("revolute", 1, 1, **at))
        wrong("the axis of joint 2 is zero", lambda: m.joint("revolute", 1, 2, axis=(0, 0, 0), **at))
        wrong("parallel", lambda: m.joint("universal", 1, 2, axis=(1, 0, 0), axis_2=(2, 0, 0), **at))
        wrong("perpendicular", lambda: m.joint("universal", 1, 2, axis=(1, 0, 0), axis_2=(1, 1, 0), **at))
        wrong("ty is not free in a revolute joint, free are: rx",
              lambda: m.joint("revolute", 1, 2, k={"ty": 1.0}, **at))
        wrong("no direction 'xr'", lambda: m.joint("revolute", 1, 2, k={"xr": 1.0}, **at))
        wrong("is no .lower <= 0", lambda: m.joint("revolute", 1, 2, stops={"rx": (0.1, 1)}, **at))
        wrong("share one stiffness", lambda: m.joint("revolute", 1, 2, stops={"rx": (0, 1, 5.0)},
                                                     friction={"rx": (1.0, 6.0)}, **at))
        wrong("kn of joint 2 is -5", lambda: m.joint("revolute", 1, 2, kn=-5, **at))
        wrong("do not ascend", lambda: m.joint("revolute", 1, 2, k={"rx": [(1, 1), (0, 0)]}, **at))
        wrong("two points", lambda: m.joint("revolute", 1, 2, k={"rx": [(1, 1)]}, **at))
        wrong("ground is held", lambda: m.drive("ground", turn=(0, 0, 1), velocity=1.0))
        wrong("either along or turn", lambda: m.drive("mass", velocity=1.0))
        wrong("without force and moment", lambda: m.load("mass"))
        wrong("at one place", lambda: m.spring("mass", "ground", (0, 0, 0), (0, 0, 0), k=1.0))
        wrong("neither joints nor springs", lambda: kjoint.Mechanism().deck())
        wrong("no option 'untill', did you mean 'until'", lambda: kjoint.Model("x_0000.rad", untill=1))


class Shown(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.model = kjoint.example().run(until=0.5, sample=0.1)
        self.path = os.path.join(folder.name, "run.h5")
        self.model.write_history(self.path)
        self.run_ = kjoint.Run.open(self.path)

    def test_a_file_shows_what_the_model_shows(self):
        channels = set(self.model.channels)
        self.assertLessEqual(channels, set(self.run_.channels))
        for name in channels:
            np.testing.assert_array_equal(self.model[name], self.run_[name])
            self.assertEqual(self.model.channel(name), self.run_.channel(name))

    def test_tables_have_names_units_and_labels(self):
        for samples in (self.model, self.run_):
            data = samples.to_xarray("joint/force", "rigid_body/position", "mass")
            self.assertEqual("kg m s-2", data["joint/force"].units)
            np.testing.assert_array_equal(data["rigid_body/position"].sel(body="bar", axis="x"),
                                          samples["rigid_body/position[bar].x"])
            table = samples.to_pandas("joint/force.norm", "*energy*")
            self.assertEqual("kg m s-2", table.attrs["units"]["joint/force[hinge].norm"])
            self.assertEqual(0.5, table.index[-1])
            self.assertEqual(set(samples.channels) - {"time"}, set(samples.to_xarray().data_vars))

    def test_curves_are_those_of_the_library(self):
        for name in ("joint/force[hinge].norm", "joint/force[1].z", "rigid_body/orientation[bar].w", "mass"):
            np.testing.assert_allclose(self.model.curve(name), self.model.curves(name)[0].values, rtol=1e-15)

    def test_names_that_mean_nothing(self):
        for name, what in (("joint/farce", "no channel 'joint/farce', did you mean 'joint/force'"),
                           ("joint/force[hings]", "no entity of joint/force, 'hings', did you mean 'hinge'"),
                           ("joint/force.q", "no component of joint/force, 'q'"), ("joint/force.x.y", "no name")):
            for samples in (self.model, self.run_):
                with self.assertRaisesRegex(kjoint.Error, what):
                    samples.curves(name)
        with self.assertRaisesRegex(kjoint.Error, "means 3 curves"):
            self.model["joint/force[hinge]"]

    def test_plots_have_legends(self):
        figure = self.run_.plot("rigid_body/position.z", "*energy", path=self.path + ".png")
        self.assertEqual("position of the main node [m]", figure.axes[0].get_ylabel())
        self.assertEqual(["position[wall].z", "position[bar].z"],
                         [text.get_text() for text in figure.axes[0].get_legend().get_texts()])
        self.assertEqual("time [s]", figure.axes[1].get_xlabel())

    def test_without_an_interval_there_are_500_samples(self):
        self.assertEqual(501, len(kjoint.example().run(until=0.5)["time"]))

    def test_written_decks_give_the_bits_of_the_mechanism(self):
        root = os.path.join(os.path.dirname(self.path), "pendulum")
        deck, engine = kjoint.example().write(root, until=0.5, sample=0.1)
        run = kjoint.Model(deck, engine).run()
        np.testing.assert_array_equal(run["joint/force"], self.model["joint/force"])

    def test_no_history(self):
        folder = pathlib.Path(self.path).parent
        whole = pathlib.Path(self.path).read_bytes()
        (folder / "cut.h5").write_bytes(whole[:len(whole)//2])
        (folder / "cutT01").write_bytes(b"no T01")       # the program has something to say, or is not there
        for name in ("nowhere.h5", "cut.h5", "cutT01"):
            with self.assertRaises(kjoint.Error) as caught:
                kjoint.Run.open(folder / name)
            self.assertIn(caught.exception.status, (3,) if name.endswith(".h5") else (2, 3))

    def test_a_grid_of_settings(self):
        found = kjoint.example().grid(0.1, 0.1, {"n": lambda run: run.status.cycle},
                                      formulation=["legacy", "consistent"], dt_scale=[0.5, 0.25])
        n = found.n.sel(formulation="consistent")
        self.assertAlmostEqual(2.0, float(n.sel(dt_scale=0.25)/n.sel(dt_scale=0.5)), 1)


if __name__ == "__main__":
    unittest.main()
