#!/usr/bin/env python3
"""Sweeps of a deck: variants are single runs, rows that are done stay done.

usage: test_sweep.py REV01_0000.rad"""
import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

import numpy as np

import kjoint
from kjoint.sweep import Measure, main, parse_vary, plan, sweep

REV01 = pathlib.Path(sys.argv[1])
OPTIONS = dict(until=0.02, sample=1e-3, formulation="legacy")


class Sweeps(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.deck = self.folder / "rev_0000.rad"
        text = REV01.read_text()
        card = "           1000000.0                40.0         0"
        self.assertIn(card, text)                          # Kn, Krx, f_Krx
        text = text.replace(card, "              &stiff             &spring         0")
        text = text.replace("/NODE\n", "/PARAMETER/GLOBAL/REAL/1\nstiffness\n" + "stiff".ljust(10)
                            + "1e6".rjust(20) + "\n/PARAMETER/GLOBAL/REAL/2\nspring\n" + "spring".ljust(10)
                            + "40.0".rjust(20) + "\n/NODE\n", 1)
        self.deck.write_text(text)

    def test_variants_are_single_runs_to_the_bit(self):
        table = sweep(self.deck, {"spring": "0:80:3", "stiff": [1e6, 2e6]}, ["joint/force[900].x:final",
                                                                          "joint/rotation[900].x:max"], workers=2, **OPTIONS)
        self.assertEqual(6, table.sizes["variant"])
        self.assertEqual([0, 0, 40, 40, 80, 80], list(table["spring"].values))
        for k in (1, 4):
            values = ",".join(f"{name}={float(table[name].values[k])!r}" for name in ("spring", "stiff"))
            one = kjoint.Model(self.deck, set=values, **OPTIONS).run()
            self.assertEqual(one.curve("joint/force[900].x")[-1], table["joint/force[900].x:final"].values[k])
            self.assertEqual(one.curve("joint/rotation[900].x").max(), table["joint/rotation[900].x:max"].values[k])

    def test_a_variant_that_fails_says_so_in_its_row(self):
        table = sweep(self.deck, {"stiff": [1e6, -1.0]}, ["internal_energy:final"], **OPTIONS)
        self.assertEqual("", table["status"].values[0])
        self.assertNotEqual("", table["status"].values[1])
        self.assertTrue(np.isfinite(table["internal_energy:final"].values[0]) and np.isnan(table["internal_energy:final"].values[1]))

    def test_rows_that_are_done_stay_done(self):
        rows = self.folder / "rows.csv"
        first = sweep(self.deck, {"spring": [0.0, 40.0]}, ["internal_energy:final"], resume=rows, **OPTIONS)
        lines = rows.read_text().splitlines()
        self.assertEqual(3, len(lines))
        changed = [lines[0], lines[1].replace(repr(float(first["internal_energy:final"].values[int(lines[1][0]) - 1])), "7.0")]
        rows.write_text("\n".join(changed) + "\n" + lines[2][:4])      # the last row is cut
        again = sweep(self.deck, {"spring": [0.0, 40.0]}, ["internal_energy:final"], resume=rows, **OPTIONS)
        self.assertIn(7.0, list(again["internal_energy:final"].values))          # taken from the file
        with self.assertRaisesRegex(ValueError, "another sweep"):
            sweep(self.deck, {"spring": [1.0, 40.0]}, ["internal_energy:final"], resume=rows, **OPTIONS)

    def test_values_of_a_parameter(self):
        np.testing.assert_allclose(parse_vary("1:100:3:log").values, [1, 10, 100])
        np.testing.assert_array_equal(parse_vary("3,1").values, [3, 1])
        # the median of a normal distribution, and one deviation above: 84.1344746 % of all are below
        np.testing.assert_allclose(parse_vary("normal(5,2)").at(np.array([0.5, 0.841344746])), [5, 7], rtol=1e-8)
        np.testing.assert_allclose(parse_vary("uniform(2,4)").at(np.array([0.25])), [2.5])
        for text in ("", "1:2", "a,b", "1:2:0", "0:1:3:log", "uniform(2,1)", "normal(0,0)"):
            with self.assertRaises(ValueError):
                parse_vary(text)
        # of Latin hypercube draws each tenth of a range holds one
        _, drawn = plan({"a": "uniform(0,10)"}, sample=10, method="lhs", seed=3)
        self.assertEqual(list(range(10)), sorted(int(x) for x in drawn[:, 0]))

    def test_measures_of_a_curve(self):
        time, y = np.array([0.0, 1.0, 3.0]), np.array([2.0, -4.0, 1.0])
        for function, value in (("max", 2), ("min", -4), ("range", 6), ("final", 1), ("tmin", 1), ("mean", -1 / 3),
                                ("rms", np.sqrt(7)), ("at(2)", -1.5)):
            self.assertAlmostEqual(value, Measure(f"mass:{function}").of(time, y), 12)
        for text in ("mass", "mass:most", "mass:at", "mass:max(3)"):
            with self.assertRaises(ValueError):
                Measure(text)

    def test_the_command_line(self):
        out = self.folder / "table.csv"
        with contextlib.redirect_stdout(io.StringIO()) as said:
            code = main([str(self.deck), "--vary", "spring=0,80", "--measure", "joint/rotation[900].x:max", "-o", str(out),
                         "--options", "until=0.02 sample=0.001 formulation=legacy"])
        self.assertEqual(0, code)
        self.assertIn("2 variants, 0 failed", said.getvalue())
        self.assertEqual("variant,spring,joint/rotation[900].x:max,status", out.read_text().splitlines()[0])
        with contextlib.redirect_stderr(io.StringIO()) as wrong:
            self.assertEqual(2, main([str(self.deck), "--vary", "spring=1"]))
        self.assertIn("--measure", wrong.getvalue())


if __name__ == "__main__":
    del sys.argv[1]
    unittest.main()
