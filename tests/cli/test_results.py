#!/usr/bin/env python3
"""Tests of what kjoint makes of a history for people and other programs.

usage: test_results.py KJOINT [unittest arguments]
"""
import csv
import io
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

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
        for t01 in sorted(SOURCE.glob("tests/parity*/*/*T01")):
            self.kjoint("convert", t01, "-o", "a.h5")
            self.kjoint("export", "a.h5", "-o", "AT01")
            self.assertIn("SAME", self.kjoint("diff", t01, "AT01", "--profile", "exact").stdout)
            times, first = read_t01(t01)
            again, second = read_t01(self.folder / "AT01")
            self.assertTrue(np.array_equal(times, again))
            for kind, channels in CHANNELS.items():
                codes = {start + k for start, n, _ in channels.values() for k in range(n)}
                codes |= {None: {SIE}, SPRING: {OFF}}.get(kind, set())
                for i, series in first.get(kind, {}).items():
                    for code in codes & set(series):
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


if __name__ == "__main__":
    test_cli.KJOINT = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
