#!/usr/bin/env python3
"""Tests of what kjoint makes of a history for people and other programs.

usage: test_results.py KJOINT [unittest arguments]
"""
import csv
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np
import PIL.Image

import test_cli
from test_cli import SOURCE, Program

sys.path.insert(0, str(SOURCE / "tests" / "parity"))
from compare_t01 import CHANNELS, SPRING, read_t01

sys.path.pop(0)
CRANK = SOURCE / "decks" / "slider_crank_0000.rad"
OFF, SIE = 1, 10                                  # codes of a T01 that follow from others


class Results(Program):
    """A short run of the slider-crank, once for all tests of a class."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.place = pathlib.Path(folder.name)
        cls.run_h5 = cls.place / "crank.h5"
        subprocess.run([test_cli.KJOINT, "run", "-q", CRANK, "--until", "0.02", "--sample", "1e-3",
                        "-o", cls.run_h5], check=True)

    def short(self):
        pass

    def colours(self, picture):
        """Different colours of a picture: one of them is a blank page."""
        return len(np.unique(np.asarray(PIL.Image.open(picture).convert("RGB")).reshape(-1, 3), axis=0))


class Export(Results):
    def table(self, *words, delimiter=","):
        text = self.kjoint("export", self.run_h5, *words).stdout
        rows = list(csv.reader(io.StringIO(text), delimiter=delimiter))
        return rows[0], rows[1:]

    def test_csv_holds_the_numbers_of_the_file(self):
        head, rows = self.table("joint/force[wrist pin].x", "joint/moment[901].norm", "cycle")
        self.assertEqual(["time [s]", "joint/force[wrist pin].x [kg m s-2]",
                          "joint/moment[main bearing].norm [kg m2 s-2]", "cycle [1]"], head)
        values = np.array(rows, float)
        with h5py.File(self.run_h5) as run:
            self.assertTrue(np.array_equal(values[:, 0], run["time"]))
            self.assertTrue(np.array_equal(values[:, 1], run["joint/force"][:, 2, 0]))
            norm = np.linalg.norm(run["joint/moment"][:, 0], axis=1)
            self.assertLess(abs(values[:, 2] - norm).max(), 1e-14 * norm.max())
            self.assertEqual([str(n) for n in run["cycle"]], [row[3] for row in rows])

    def test_all_channels_of_all_entities_come_without_names(self):
        head, rows = self.table()
        with h5py.File(self.run_h5) as run:
            groups = [run[name] for name in ("/", "joint", "rigid_body", "node") if name in run]
            n = sum(int(np.prod(item.shape[1:])) for group in groups for item in group.values()
                    if isinstance(item, h5py.Dataset) and item.maxshape[:1] == (None,))
        self.assertEqual(n - len(groups) + 1, len(head))     # the time of each group is one
        self.assertEqual(21, len(rows))

    def test_globs_stand_for_names(self):
        head = self.table("joint/*[*pin].norm")[0]
        self.assertIn("joint/force[crank pin].norm [kg m s-2]", head)
        self.assertIn("joint/position[wrist pin].norm [m]", head)
        self.assertFalse([name for name in head if "bearing" in name or "frame" in name])
        self.assertEqual(5, len(self.table("momentum_?", "mass")[0]))
        self.assertEqual(6, len(self.table("joint/force[90?].y mass")[0]))

    def test_spreadsheets_of_other_places_are_served(self):
        head, rows = self.table("joint/length", "--decimal", ",", delimiter=";")
        self.assertEqual(5, len(head))
        self.assertRegex(rows[1][0], r"^1,0+E-003$")
        self.assertEqual("\t", self.kjoint("export", self.run_h5, "mass", "--separator",
                                           "tab").stdout[8])
        self.kjoint("export", self.run_h5, "mass", "--separator", ".", code=2)

    def test_json_says_what_each_series_is(self):
        self.kjoint("export", self.run_h5, "joint/force[wrist pin]", "-o", "pin.json")
        with open(self.folder / "pin.json", encoding="utf-8") as file:
            found = json.load(file)
        x = found["series"][0]
        self.assertEqual(("joint/force[wrist pin].x", 903, "wrist pin", "x", "kg m s-2"),
                         tuple(x[key] for key in ("name", "entity", "label", "component", "units")))
        with h5py.File(self.run_h5) as run:
            self.assertEqual(list(run["joint/force"][:, 2, 0]), x["values"])

    def test_a_name_that_means_nothing_says_what_there_is(self):
        for name, hint in (("joint/forc", 'did you mean "joint/force"?'),
                           ("joint/force[pin]", "main bearing, crank pin, wrist pin, cylinder"),
                           ("joint/force.w", "x, y, z, norm"), ("mass.x", "it is one number")):
            self.assertIn(hint, self.kjoint("export", self.run_h5, name, code=2).stderr)

    def test_every_t01_comes_back_as_it_was(self):
        """convert and export: all codes that have a channel, and those that follow from others"""
        for t01 in sorted(SOURCE.glob("tests/*/*/*T01")):
            self.kjoint("convert", t01, "-o", "a.h5")
            self.kjoint("export", "a.h5", "-o", "AT01")
            self.assertIn("SAME", self.kjoint("diff", t01, "AT01", "--profile", "exact").stdout)
            times, first = read_t01(t01)
            again, second = read_t01(self.folder / "AT01")
            self.assertTrue(np.array_equal(times, again))
            for kind, channels in CHANNELS.items():
                codes = {start + k for start, n, _ in channels.values() for k in range(n)}
                codes |= {None: {SIE}}.get(kind, set())
                for i, series in first.get(kind, {}).items():
                    # no channel says that a spring failed: OFF is written as that of one that holds
                    holds = {OFF} if kind == SPRING and np.all(series.get(OFF, 1) == 1) else set()
                    for code in (codes | holds) & set(series):
                        self.assertTrue(np.array_equal(series[code], second[kind][i][code]),
                                        f"{t01.name}: {kind} {i} {code}")

    def test_a_single_precision_t01_stays_one(self):
        t01 = SOURCE / "tests" / "parity" / "REV01" / "REV01T01.float32"
        self.kjoint("convert", t01, "-o", "a.h5")
        self.kjoint("export", "a.h5", "-o", "AT01")
        self.assertIn("SAME", self.kjoint("diff", t01, "AT01", "--profile", "exact").stdout)
        self.assertEqual((0, 0, 0, 84), tuple((self.folder / "AT01").read_bytes()[:4]))

    def test_a_run_becomes_the_t01_of_radioss(self):
        self.kjoint("run", "--legacy", "-q", test_cli.CASE / "REV01_0000.rad", "-o", "run.h5")
        self.kjoint("export", "run.h5", "-o", "RUNT01")
        self.kjoint("diff", test_cli.CASE / "REV01T01", "RUNT01")
        names = (self.folder / "RUNT01_TITLES").read_text().split()
        self.assertEqual(["6", "OFF", "6", "FX"], names[44:48])
        # it is written beside, and replaces what a link leads to, but not what it is made of
        (self.folder / "OLDT01").write_text("old")
        (self.folder / "LINKT01").symlink_to("OLDT01")
        self.kjoint("export", "run.h5", "-o", "LINKT01")
        self.assertEqual((self.folder / "RUNT01").read_bytes(), (self.folder / "OLDT01").read_bytes())
        self.assertTrue((self.folder / "LINKT01").is_symlink())
        self.kjoint("export", "run.h5", "--to", "t01", "-o", "run.h5", code=2)
        self.assertEqual([], list(self.folder.glob("*.part")))

    def test_diff_compares_the_channels_that_it_is_told(self):
        self.kjoint("run", "-q", CRANK, "--until", "0.02", "--sample", "1e-3", "--kn-scale", "0.5",
                    "-o", "soft.h5")
        done = self.kjoint("diff", self.run_h5, "soft.h5", "--channels",
                           "joint/force[wrist pin].x time_step", "--json", code=1)
        found = json.loads(done.stdout)
        self.assertEqual(["time", "time_step", "joint/force[903].x"],
                         [channel["name"] for channel in found["channel"]])
        self.kjoint("diff", self.run_h5, "soft.h5", "--channels", "mass")
        self.assertIn("norms", self.kjoint("diff", self.run_h5, "soft.h5", "--channels",
                                           "joint/force.norm", code=2).stderr)

    def test_json_is_json_also_when_the_call_is_wrong(self):
        for words in (("diff", "--json", "--bogus"), ("diff", "--json", "none.h5", "none.h5")):
            done = subprocess.run([test_cli.KJOINT, *words], capture_output=True, text=True,
                                  check=False)
            found = json.loads(done.stdout)
            self.assertEqual(done.returncode, found["exit_code"])
            self.assertEqual("error", found["findings"][0]["severity"])


class Worst(Program):
    """What gave way most. The bar on a hinge (1.5 kg, 1 m, from the horizontal): at the bottom its rate is
    sqrt(3 g/L) = 5.425 rad/s and the hinge holds 2.5 m g = 36.79 N, which Kn 1e6 N/m gives 3.68e-5 m for."""

    DECK = SOURCE / "decks" / "revolute_pendulum_0000.rad"
    FORCE, ARM = 36.7875, 0.5
    BOTTOM = [(0.25 + 0.5*k)*1.9333 for k in range(3)]     # three times alike: 0.483, 1.450, 2.417 s

    def short(self):
        pass

    def test_run_and_info_name_joint_time_and_force(self):
        said = self.kjoint("run", self.DECK, "-o", "a.h5").stdout
        at = r"at t = (0\.48\d?|1\.45|2\.4[12])"
        for line in (r"time step     8\.0+E-05  hinge \(901\)",
                     rf"largest gap   3\.68e-5 m  hinge \(901\) {at}, force 36\.8 N",
                     r"half of it    Kn 2e6 instead of 1e6 N/m: 41 % more cycles",
                     rf"peak force    36\.8 N  hinge \(901\) {at}",
                     rf"fastest turn  5\.42 rad/s  hinge \(901\) {at}"):
            self.assertRegex(said, line)
        again = self.kjoint("info", "a.h5").stdout
        for line in said.splitlines()[6:11]:
            self.assertIn(line.strip(), again)
        worst = json.loads(self.kjoint("info", "--json", "a.h5").stdout)["worst"]
        self.assertLess(abs(worst["force"]["value"]/self.FORCE - 1), 1e-3)
        self.assertLess(abs(worst["gap"]["value"]*1e6/self.FORCE - 1), 1e-3)
        self.assertLess(min(abs(worst["force"]["time"]/t - 1) for t in self.BOTTOM), 3e-3)
        self.assertEqual("hinge (901)", worst["gap"]["name"])
        # of 1.57 rad - (-0.02 rad) of the door it is the upper stop that is passed
        door = json.loads(self.kjoint("run", "--json", SOURCE / "decks" / "door_hinge_0000.rad").stdout)
        self.assertLess(door["worst"]["stop_gap_rotation"]["value"], 0)
        self.assertEqual("hinge (901)", door["time_step_owner_name"])

    def test_a_stiffer_joint_costs_no_steps_where_it_does_not_hold_them(self):
        for words, wanted in (([], "41 % more cycles"), (["--fast"], "no more cycles"),
                              (["--fast", "--kn", "inf"], None), (["--fast", "--kn", "inf", "--kn-scale", "1e9"], None)):
            said = self.kjoint("run", self.DECK, "-o", "a.h5", "--until", "0.5", *words).stdout
            again = self.kjoint("info", "a.h5").stdout
            for text in (said, again):
                if wanted:
                    self.assertRegex(text, f"instead of 1e6 N/m: {wanted}")
                else:
                    self.assertNotIn("half of it", text)

    def test_a_joint_that_gives_way_too_much_is_a_warning(self):
        # 1 % of the arm are 5 mm: 36.8 N are 18 mm at Kn 2e3, 0.37 mm at 1e5
        for scale, gives in (("2e-3", True), ("0.1", False)):
            done = json.loads(self.kjoint("run", "--json", self.DECK, "--kn-scale", scale).stdout)
            found = [f for f in done["findings"] if f["id"] == "KJ-9302"]
            gap = done["worst"]["gap"]["value"]
            self.assertEqual(gives, gap > 0.01*self.ARM)
            self.assertEqual(gives, len(found) == 1)
            if gives:
                self.assertTrue(self.FORCE/2e3 < gap < 2*self.FORCE/2e3)
                self.assertEqual(f"joint hinge (901) gave way by {100*gap/self.ARM:.0f} % of its arm, "
                                 f"{gap:.1E} of 5.0E-01", found[0]["message"])

    def test_a_blocked_turn_is_a_warning_too(self):
        """The hammer at rest but for its head, which turns about the weld's x axis at 10 rad/s: with 0.001 and
        0.005 kg m2 about that axis the weld is twisted by 10 sqrt(8.33e-4/Kn), and no force acts. At Kn 200
        N m/rad these are 0.0204 rad, a few percent less by its damping of 2.5 %; at 1e4 0.0029."""
        text = (SOURCE / "decks" / "rigid_weld_0000.rad").read_text()
        for old, new in (("         Z         0      1003", "         X         0      1003"),
                         ("       100       200\n#---", "       200\n#---"),
                         ("                 3.0                 0.0                 4.0                10.0",
                          "                 0.0                 0.0                 0.0                10.0")):
            self.assertEqual(1, text.count(old))
            text = text.replace(old, new)
        (self.folder / "twist_0000.rad").write_text(text)
        engine = (SOURCE / "decks" / "rigid_weld_0001.rad").read_text()
        (self.folder / "twist_0001.rad").write_text(engine)
        for kn, twist in ((200.0, 0.0204), (1e4, 0.0029)):
            done = json.loads(self.kjoint("run", "--json", "twist_0000.rad", "--kn-scale", f"{kn/1e6}",
                                          "--until", "0.05", "--sample", "1e-4", "-o", "twist.h5").stdout)
            found = done["worst"]["blocked_rotation"]["value"]
            self.assertTrue(0.94*twist < found < 1.01*twist, found)
            wanted = [f"joint weld (901) gave way by {found:.1E} rad in a blocked rotation"] if kn < 1e3 else []
            self.assertEqual(wanted, [f["message"] for f in done["findings"] if f["id"] == "KJ-9302"])

    def test_info_reads_a_t01_as_another_reader_does(self):
        t01 = SOURCE / "tests" / "parity" / "REV01" / "REV01T01"
        times, data = read_t01(t01)
        told = json.loads(self.kjoint("info", "--json", t01).stdout)
        self.assertEqual(("T01", len(times), times[-1]), (told["kind"], told["samples"], told["last_time"]))
        (joint, series), = data[SPRING].items()
        start, n, _ = CHANNELS[SPRING]["force"]
        norm = np.linalg.norm([series[start + k] for k in range(n)], axis=0)
        worst = told["worst"]["force"]
        self.assertEqual((joint, times[norm.argmax()]), (worst["joint"], worst["time"]))
        self.assertLess(abs(worst["value"]/norm.max() - 1), 1e-14)
        text = self.kjoint("info", t01).stdout
        for word in ("OpenRadioss", f"{len(times)} samples", "1 joint, 2 rigid bodies, 4 nodes", "peak force    686"):
            self.assertIn(word, text)

    def test_info_says_why_a_file_does_not_open(self):
        self.assertIn("there is no none.h5", self.kjoint("info", "none.h5", code=3).stderr)
        self.assertIn("no file", self.kjoint("info", ".", code=3).stderr)
        (self.folder / "text.h5").write_text("not a history")
        self.assertIn("text.h5", self.kjoint("info", "text.h5", code=3).stderr)
        self.kjoint("run", "-q", self.DECK, "-o", "a.h5", "--until", "0.1")
        data = (self.folder / "a.h5").read_bytes()
        (self.folder / "cut.h5").write_bytes(data[:len(data)//2])
        self.assertIn("damaged", self.kjoint("info", "cut.h5", code=3).stderr)
        self.assertIn("error: it is no HDF5 file, or cut off", self.kjoint("recover", "cut.h5", code=3).stderr)
        self.assertIn("there is no none.h5", self.kjoint("watch", "none.h5", code=3).stderr)
        with h5py.File(self.folder / "open.h5", "w"):
            for command in ("info", "watch"):
                self.assertIn("another program holds it open", self.kjoint(command, "open.h5", code=3).stderr)
        if os.geteuid() != 0:                        # root reads all
            (self.folder / "cut.h5").chmod(0)
            self.assertIn("ermission denied", self.kjoint("info", "cut.h5", code=3).stderr)


class Show(Results):
    """Pictures, films, pages and files for ParaView, by the Python package."""

    def kjoint(self, *words, code=0, **environment):
        return super().kjoint(*words, code=code, KJOINT_PYTHON=sys.executable, **environment)

    def soft(self):
        self.kjoint("run", "-q", CRANK, "--until", "0.02", "--sample", "1e-3", "--kn-scale", "0.3",
                    "-o", "soft.h5")
        return self.folder / "soft.h5"

    def test_a_plot_overlays_runs_in_the_units_asked_for(self):
        self.kjoint("plot", self.run_h5, "joint/force[*pin].norm", self.soft(), "--units", "kN,mm,ms",
                    "-o", "plot.png")
        self.assertGreater(self.colours(self.folder / "plot.png"), 50)
        self.kjoint("plot", self.run_h5, "mass", "-o", "plot.svg")
        text = (self.folder / "plot.svg").read_text()
        self.assertIn("mass", text)
        self.assertIn("there is no channel", self.kjoint("plot", self.run_h5, "joint/forc",
                                                         code=2).stderr)
        self.assertIn("no unit", self.kjoint("plot", self.run_h5, "mass", "--units", "stone",
                                             code=2).stderr)

    def test_units_of_plots_are_those_of_mechanics(self):
        """1000 Mg mm s-2 are 1 kN; 1 N m is 1000 N mm; pi rad are 180 deg; 1 m/s is 1 mm/ms"""
        sys.path.insert(0, str(SOURCE / "python"))
        from kjoint._show import Units
        si = {"unit_si": [1.0, 1.0, 1.0], "unit_symbol": ["kg", "m", "s"]}
        mm = {"unit_si": [1e3, 1e-3, 1.0], "unit_symbol": ["Mg", "mm", "s"]}

        def of(history, wanted, power, kind="", angle=False):
            factor, unit = Units(wanted, history).of({"dimension": power, "class": kind,
                                                      "angle": angle})
            return round(factor, 12), unit
        self.assertEqual((1e-3, "kN"), of(mm, "kN", [1, 1, -2], "force"))
        self.assertEqual((1e3, "N mm"), of(si, "N,mm", [1, 2, -2], "moment"))
        self.assertEqual((1e-3, "J"), of(mm, "N,m", [1, 2, -2], "energy"))
        self.assertEqual((57.295779513082, "deg"), of(si, "deg", [0, 0, 0], "", True))
        self.assertEqual((1.0, "mm ms\u207b\u00b9"), of(si, "mm,ms", [0, 1, -1]))

    def test_a_difference_is_drawn(self):
        self.kjoint("diff", self.run_h5, self.soft(), "--plot", "worst.png", code=1)
        self.assertGreater(self.colours(self.folder / "worst.png"), 50)

    def test_films_and_pictures_move(self):
        for name in ("film.gif", "film.mp4", "still.png"):
            self.kjoint("animate", self.run_h5, "-o", name, "--seconds", "0.4")
            self.assertGreater((self.folder / name).stat().st_size, 5000)
        with PIL.Image.open(self.folder / "film.gif") as film:
            self.assertEqual(10, film.n_frames)
            film.seek(0)
            first = film.convert("RGB").tobytes()
            film.seek(5)
            self.assertNotEqual(first, film.convert("RGB").tobytes())
        self.assertIn("no such", self.kjoint("animate", "none.h5", code=3).stderr.lower())

    def test_paraview_finds_joints_and_bodies_at_every_time(self):
        self.kjoint("export", self.run_h5, "-o", "run.vtkhdf")
        self.kjoint("export", self.run_h5, "-o", "run.pvd")
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
        temporal, single = vtk.vtkHDFReader(), vtk.vtkXMLPolyDataReader()
        temporal.SetFileName(str(self.folder / "run.vtkhdf"))
        temporal.UpdateInformation()
        with h5py.File(self.run_h5) as run:
            n = len(run["time"])
            self.assertEqual(n, temporal.GetNumberOfSteps())
            for i in (0, n // 2, n - 1):
                temporal.SetStep(i)
                temporal.Update()
                single.SetFileName(str(self.folder / "run" / f"run_{i:05d}.vtp"))
                single.Update()
                self.assertEqual(run["time"][i], temporal.GetTimeValue())
                for grid in (temporal.GetOutputDataObject(0), single.GetOutput()):
                    points = vtk_to_numpy(grid.GetPoints().GetData())
                    self.assertTrue(np.array_equal(run["joint/position"][i], points[-4:]))
                    gap = vtk_to_numpy(grid.GetPointData().GetArray("gap"))
                    self.assertTrue(np.array_equal(run["joint/violation_trans"][i], gap[-4:]))
                    self.assertEqual(6 + 4, grid.GetNumberOfCells())   # segments and joints
        text = (self.folder / "run.pvd").read_text()
        self.assertEqual(n, text.count("<DataSet "))

    def test_what_is_missing_is_named(self):
        done = super().kjoint("plot", self.run_h5, "mass", code=2, KJOINT_PYTHON="/usr/bin/python3",
                              PYTHONPATH=str(self.empty_numpy()))
        self.assertIn("pip install numpy", done.stderr)
        done = super().kjoint("sweep", SOURCE / "decks" / "slider_tolerance_0000.rad", "--vary", "radius=1", "--measure",
                              "mass:max", code=3, KJOINT_PYTHON="/usr/bin/python3", PYTHONPATH=str(self.folder))
        self.assertIn("pip install numpy", done.stderr)
        done = super().kjoint("plot", self.run_h5, "mass", code=3, KJOINT_PYTHON="/none/python")
        self.assertIn("KJOINT_PYTHON", done.stderr)

    def empty_numpy(self):
        """A folder whose numpy cannot be imported."""
        (self.folder / "numpy").mkdir()
        (self.folder / "numpy" / "__init__.py").write_text("raise ModuleNotFoundError(name='numpy')")
        return self.folder


class Report(Results):
    """The page in a browser."""

    def test_the_page_shows_the_mechanism_and_moves_it(self):
        import browser
        if browser.find() is None:
            self.skipTest("there is no Chromium")
        self.kjoint("run", "-q", CRANK, "--until", "0.02", "--sample", "1e-3", "--kn-scale", "0.3",
                    "-o", "soft.h5")
        self.kjoint("report", self.run_h5, "soft.h5", "-o", "run.html", KJOINT_PYTHON=sys.executable)
        with browser.Browser() as page:
            page.open(self.folder / "run.html")
            text = page.value("document.body.innerText")
            for word in ("largest gap", "crank pin (902)", "NORMAL TERMINATION", "DIFFERENT",
                         "slider_crank_0000.rad", "Kn"):
                self.assertIn(word, text)
            first = page.picture("#mechanism")
            self.assertGreater(self.colours(io.BytesIO(first)), 20, "the canvas is blank")
            places = "JSON.stringify([0, 1].map(k => document.getElementById('mechanism').data[k].y))"
            before = page.value(places)
            page.value("(s => { s.value = s.max; s.dispatchEvent(new Event('input')); })"
                       "(document.getElementById('slider'))")
            self.assertNotEqual(before, page.value(places), "the slider moves no body")
            page.value("new Promise(done => setTimeout(done, 500))")
            self.assertNotEqual(first, page.picture("#mechanism"), "the picture stands still")
            with h5py.File(self.run_h5) as run:
                last = run["joint/position"][-1, :, 1]
            shown = page.value("document.getElementById('mechanism').data[1].y")
            self.assertLess(abs(np.array(shown) - last).max(), 1e-5)    # 16 bits of 0.22 m
            page.value("document.querySelectorAll('#joints tbody tr')[2].click()")
            self.assertEqual("Curves of wrist pin (903)",
                             page.value("document.getElementById('curves-of').textContent"))
            self.assertEqual([], page.errors)
            self.assertEqual([], [url for url in page.requests
                                  if not url.startswith(("file:", "data:", "blob:"))])

    def test_a_page_of_2000_samples_and_30_joints_is_below_6_mb(self):
        sys.path.insert(0, str(SOURCE / "tools"))
        import bench_scenes
        bench_scenes.write("chain", 30, self.folder / "chain", until=0.2, sample=1e-4)
        self.kjoint("run", "-q", "chain_0000.rad")
        with h5py.File(self.folder / "chain.h5") as run:
            self.assertGreaterEqual(run["joint/force"].shape[0], 2000)
            self.assertGreaterEqual(run["joint/force"].shape[1], 30)
        self.kjoint("report", "chain.h5", KJOINT_PYTHON=sys.executable)
        self.assertLess((self.folder / "chain.html").stat().st_size, 6e6)


if __name__ == "__main__":
    test_cli.KJOINT = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
