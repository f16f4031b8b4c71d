#!/usr/bin/env python3
"""Sweeps and fits of a deck: variants are single runs to the bit, what fails says so, what is done
stays done when a thread, a rank or the whole job is killed.

usage: test_sweep.py KJOINT REV01_0000.rad [unittest arguments]"""
import contextlib
import csv
import io
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np
import xarray as xr

import kjoint
from kjoint.fit import fit
from kjoint.variants import Measure, main, parse_vary, plan, read_reference, settings, sweep

KJOINT, REV01 = sys.argv[1], pathlib.Path(sys.argv[2])
OPTIONS = dict(until=0.02, sample=1e-3, formulation="legacy")
FORCE, TURN = "joint/force[900].x:final", "joint/rotation[900].x:max"
MPIRUN = shutil.which("mpirun")


class Folder(unittest.TestCase):
    formulation = "legacy"                                 # of start()

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

    def start(self, *words, before=(), **options):
        """`kjoint sweep` of 200 variants into sweep.h5, under way."""
        return subprocess.Popen([*before, KJOINT, "sweep", self.deck, "--vary", "spring=0:80:200", "--measure", TURN,
                                 "--until", "0.2", "--every", "1e-3", "--formulation", self.formulation, "--reproducible", "-o", self.folder / "sweep.h5",
                                 *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)

    def finished(self, process, code=0):
        said = process.communicate(timeout=600)[0]
        self.assertEqual(code, process.returncode, said)
        return said

    def wait_for_rows(self, least):
        """Rows that are done of a sweep under way."""
        for _ in range(6000):
            n = sum(path.read_text().count("\n") for path in self.folder.glob("sweep.h5.rows/*.csv"))
            if n >= least:
                return n
            time.sleep(0.01)
        self.fail("no rows")

    def whole(self):
        """The file that a sweep in one go writes, and its table as text."""
        self.finished(self.start("--threads", "1"))
        wanted = (self.folder / "sweep.h5").read_bytes(), (self.folder / "sweep.csv").read_text()
        (self.folder / "sweep.h5").unlink()
        return wanted

    def is_whole(self, wanted):
        self.assertEqual(wanted[1], (self.folder / "sweep.csv").read_text())
        self.assertEqual(wanted[0], (self.folder / "sweep.h5").read_bytes())
        self.assertFalse((self.folder / "sweep.h5.rows").exists())


class Sweeps(Folder):
    def test_variants_are_single_runs_to_the_bit(self):
        for formulation in ("legacy", "consistent"):
            words = ["--until", "0.02", "--formulation", formulation, "-q"]
            self.finished(subprocess.Popen([KJOINT, "sweep", self.deck, "--vary", "spring=uniform(0,80)", "--vary",
                                            "stiff=1e5:1e7:50:log", "--sample", "100", "--sobol", "--measure", FORCE, "--measure", TURN,
                                            *words, "--every", "1e-3", "--threads", "2", "-o", self.folder / "s.csv"],
                                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True))
            table = self.columns("s.csv")
            self.assertEqual(100, len(table[TURN]))
            for k in random.Random(1).sample(range(100), 20):
                subprocess.run([KJOINT, "run", self.deck, *words, "--sample", "1e-3", "-o", self.folder / "one.h5", "--set",
                                f"spring={table['spring'][k]},stiff={table['stiff'][k]}"], check=True)
                with self.program():
                    _, force = read_reference(self.folder / "one.h5", FORCE.rpartition(":")[0])
                    _, turn = read_reference(self.folder / "one.h5", TURN.rpartition(":")[0])
                self.assertEqual((force[-1], turn.max()), (float(table[FORCE][k]), float(table[TURN][k])))

    def columns(self, name):
        """A CSV file as texts by column."""
        with open(self.folder / name, newline="") as file:
            rows = list(csv.DictReader(file))
        return {key: [row[key] for row in rows] for key in rows[0]}

    @contextlib.contextmanager
    def program(self):
        os.environ["KJOINT_PROGRAM"] = KJOINT
        yield
        del os.environ["KJOINT_PROGRAM"]

    def test_a_variant_that_fails_says_so_in_its_row(self):
        table = sweep(self.deck, {"stiff": [1e6, -1.0, 2e6]}, ["internal_energy:final"], **OPTIONS)
        self.assertIn("negative", table["status"].values[1])                 # refused
        self.assertTrue(np.isnan(table["internal_energy:final"].values[1]))
        alone = sweep(self.deck, {"stiff": [1e6, 2e6]}, ["internal_energy:final"], **OPTIONS)
        np.testing.assert_array_equal(alone["internal_energy:final"].values, table["internal_energy:final"].values[[0, 2]])
        # blows up at fifty times its critical step, within the energy limit of a run
        table = sweep(self.deck, {"spring": [40.0]}, ["internal_energy:final"], dt_scale=50.0, energy_limit=15.0, **OPTIONS)
        self.assertRegex(table["status"].values[0], "energy|finite|step")

        # among others that march beside it
        stiff = [1e6 + 1e4*k for k in range(96)]
        stiff[50] = -1.0
        options = dict(until=0.02, sample=1e-3)
        table = sweep(self.deck, {"stiff": stiff}, [TURN], **options)
        self.assertEqual([50], [k for k, text in enumerate(table["status"].values) if text])
        alone = [sweep(self.deck, {"stiff": [stiff[k]]}, [TURN], **options)[TURN].values[0] for k in (49, 51)]
        np.testing.assert_array_equal(alone, table[TURN].values[[49, 51]])

    def test_scenes_side_by_side_have_the_bits_that_they_have_alone(self):
        """Each with its own step, more of them than places; stops that are met, a driven joint, springs; scenes that end
        early, one that blows up, one that is none of theirs."""
        for name in ("door_hinge", "slider_tolerance", "spring_mount"):
            subprocess.run([KJOINT, "new", name], cwd=self.folder, check=True, stdout=subprocess.DEVNULL)
        door = self.folder / "door_hinge_0000.rad"
        # a disc on a hinge: a force on its rim in axes that turn with it, a moment and a force on its main node that
        # follow time, place and velocity, and a condition in those axes
        disc = self.folder / "node_axes_0000.rad"
        loads = [f"/CLOAD/{i}\nload\n{1:10}{way:>10}{skew:10}{0:10}{group:10}{kind:10}{1.0:20}{size:20}\n" for i, (way, skew, group, kind, size) in
                 enumerate((("Y", 5, 1009, 0, 2.0), ("ZZ", 0, 1005, 0, 0.7), ("X", 0, 1005, 2, 3.0), ("Y", 5, 1009, 3, 0.5)), 1)]
        disc.write_text((REV01.parents[2] / "runs" / disc.name).read_text().replace("2022", "2023", 1).replace("/TH/NODE/11\n", (
            "/FUNCT/1\nrising\n" + f"{-9.0:20}{-9.0:20}\n{9.0:20}{9.0:20}\n" + f"/GRNOD/NODE/1009\nrim\n{202:10}\n" + "".join(loads)
            + f"/BCS/9\nin its plane\n   001 000{5:10}{1005:10}\n/TH/NODE/11\n"), 1))
        for deck, n, options in ((self.deck, 70, dict(until=0.02, sample=1e-3)), (door, 12, {}),
                                 (disc, 9, dict(until=0.05, sample=5e-3)), (self.folder / "slider_tolerance_0000.rad", 5, dict(until=0.01, sample=1e-4)),
                                 (self.folder / "spring_mount_0000.rad", 5, dict(until=0.1, sample=1e-2))):
            def models():
                made = [kjoint.Model(deck, **{**options, "dt_scale": 0.9 - 0.7*k/n}) for k in range(n)]
                if deck == self.deck:
                    made[7] = kjoint.Model(deck, **{**options, "dt_scale": 50.0})
                    made[8] = kjoint.Model(deck, **{**options, "until": 0.004})
                    made[9] = kjoint.Model(door, until=0.1, sample=0.01)
                return made

            beside, alone = models(), models()
            found = kjoint.run_beside(beside)
            self.assertEqual([7] if deck == self.deck else [], [k for k, error in enumerate(found) if error])
            for k, (a, b) in enumerate(zip(beside, alone)):
                if found[k]:
                    with self.assertRaises(kjoint.Error) as error:
                        b.run()
                    self.assertEqual(str(error.exception), str(found[k]))
                else:
                    b.run()
                self.assertEqual(b.status.cycle, a.status.cycle)
                for channel in b.channels:
                    np.testing.assert_array_equal(b[channel], a[channel], err_msg=f"{deck} {k} {channel}")
            self.assertGreater(len({model.status.cycle for model in alone}), 1)
            if deck == door:                               # the stop lies at 90 degrees
                self.assertGreater(max(abs(b["joint/rotation"]).max() for b in alone), np.pi/2)
        with self.assertRaisesRegex(kjoint.Error, "twice"):
            kjoint.run_beside([beside[0], beside[0]])

    def test_what_no_variant_could_do_is_an_error(self):
        for vary, measure, word in (({"nothing": [1]}, "mass:max", "no parameter"), ({"spring": [1]}, "joint/nothing[900]:max", "nothing"),
                                    ({"spring": [1]}, "joint/force:max", "curves")):
            with self.assertRaisesRegex(kjoint.Error, word):
                sweep(self.deck, vary, [measure], **OPTIONS)
        with self.assertRaises(kjoint.Error):
            sweep(self.folder / "none_0000.rad", {"spring": [1]}, ["mass:max"], **OPTIONS)

    def test_the_file_is_a_table_for_xarray_and_pandas(self):
        out = self.folder / "sweep.h5"
        sweep(self.deck, {"spring": [0.0, 40.0]}, [FORCE, "joint/rotation[900].x:tmax"], output=out, keep=[2], **OPTIONS)
        with xr.open_dataset(out) as table:
            self.assertEqual({"variant": 2}, dict(table.sizes))
            self.assertEqual(["kg m s-2", "s"], [table[name.replace("/", "|")].units for name in (FORCE, "joint/rotation[900].x:tmax")])
            frame = table.to_dataframe()
        self.assertEqual([0.0, 40.0], list(frame["spring"]))
        self.assertEqual(list(frame[FORCE.replace("/", "|")]), list(map(float, self.columns("sweep.csv")[FORCE])))
        self.assertEqual(["variant_00002.h5"], os.listdir(self.folder / "sweep.h5.runs"))

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
        self.assertEqual("more=1,a=3,b=0.1", settings(["a", "b"], [3.0, 0.1], "more=1"))     # an integer may take a

    def test_measures_of_a_curve(self):
        time, y = np.array([0.0, 1.0, 3.0]), np.array([2.0, -4.0, 1.0])
        for function, value in (("max", 2), ("min", -4), ("range", 6), ("final", 1), ("tmin", 1), ("mean", -1 / 3),
                                ("rms", np.sqrt(7)), ("at(2)", -1.5)):
            self.assertAlmostEqual(value, Measure(f"mass:{function}").of(time, y), 12)
        for text in ("mass", "mass:most", "mass:at", "mass:max(3)", "mass:rmse"):
            with self.assertRaises(ValueError):
                Measure(text)

    def test_a_history_is_compared_with_another(self):
        reference = self.folder / "ref.h5"
        kjoint.Model(self.deck, set="spring=40", **OPTIONS).run().write_history(reference)
        with self.program():
            names = [f"joint/rotation[900].x:{function}({reference})" for function in ("rmse", "iso18571")]
            table = sweep(self.deck, {"spring": [40.0, 60.0]}, names, **OPTIONS)
        self.assertEqual([0.0, 1.0], [table[name].values[0] for name in names])              # the same curve
        a, b = (kjoint.Model(self.deck, set=f"spring={k}", **OPTIONS).run().curve("joint/rotation[900].x") for k in (40, 60))
        self.assertAlmostEqual(np.sqrt(np.mean((a - b)**2)), table[names[0]].values[1], 12)
        self.assertTrue(0 < table[names[1]].values[1] < 1)

    def test_the_command_line(self):
        out = self.folder / "table.csv"
        with contextlib.redirect_stdout(io.StringIO()) as said:
            code = main([str(self.deck), "--vary", "spring=0,80", "--measure", TURN, "--output", str(out),
                         "--run", "until=0.02", "--every", "0.001", "--run", "formulation=legacy"])
        self.assertEqual(0, code)
        self.assertIn("2 variants, 0 failed", said.getvalue())
        self.assertEqual(f"variant,spring,{TURN},cycles,status", out.read_text().splitlines()[0])
        (self.folder / "in.csv").write_text("spring,stiff\n0,1e6\n80,1e6\n")
        first = out.read_text().splitlines()
        main([str(self.deck), "--table", str(self.folder / "in.csv"), "--measure", TURN, "--output", str(out),
              "--run", "until=0.02", "--every", "0.001", "--run", "formulation=legacy", "--quiet"])
        self.assertEqual([row.split(",")[2] for row in first[1:]], [row.split(",")[3] for row in out.read_text().splitlines()[1:]])
        for words, reason in ((["--vary", "spring=1"], "--measure"), (["--measure", TURN], "--vary"),
                              (["--vary", "spring=1", "--measure", TURN, "--lhs"], "--sample"),
                              (["--vary", "spring=1", "--vary", "spring=2", "--measure", TURN], "once"),
                              (["--vary", "spring=1", "--measure", TURN, "--keep", "x"], "--keep")):
            with contextlib.redirect_stderr(io.StringIO()) as wrong:
                self.assertEqual(2, main([str(self.deck), *words, "--output", str(self.folder / "no.csv")]))
            self.assertIn(reason, wrong.getvalue())
        # argparse of Python 3.11 makes an empty list of --NAME=--
        for word in ("--measure=--", "--vary=--", "--sample=--", "--run=threads=--", "--seed=x"):
            done = subprocess.run([sys.executable, "-m", "kjoint.variants", self.deck, "--vary", "spring=1", "--measure", TURN, word,
                                   "--output", self.folder / "no.csv"], capture_output=True, text=True)
            self.assertEqual((2, 1), (done.returncode, len(done.stderr.splitlines())), done.stderr)
            self.assertRegex(done.stderr, "^error: ")


class Killed(Folder):
    def test_a_job_that_is_killed_goes_on(self):
        for blow in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, "side by side"):
            if blow == signal.SIGKILL:
                wanted = self.whole()
            if blow == "side by side":
                self.formulation, blow = "consistent", signal.SIGKILL
                wanted = self.whole()
            process = self.start("--threads", "2")
            done = self.wait_for_rows(20)
            process.send_signal(blow)
            process.communicate(timeout=60)
            self.assertEqual(-9 if blow == signal.SIGKILL else 130, process.returncode)
            # the last row may be cut, and one that is there is not done again
            path = max(self.folder.glob("sweep.h5.rows/*.csv"), key=lambda path: path.stat().st_size)
            rows = path.read_text().splitlines()
            with open(path, "a") as file:
                file.write("3,1.5,0.")
            self.finished(self.start("--resume", "--threads", "1"))
            self.is_whole(wanted)
            (self.folder / "sweep.h5").unlink()
            self.assertGreaterEqual(done, 20)
            self.assertTrue(set(row.split(",")[1] for row in rows) <= set(wanted[1].replace("\n", ",").split(",")))

    def test_what_is_there_is_taken(self):
        process = self.start("--threads", "1")
        self.wait_for_rows(20)
        process.kill()
        process.communicate()
        path = min(self.folder.glob("sweep.h5.rows/*.csv"))
        rows = path.read_text().splitlines(keepends=True)
        path.write_text("1,7.0,5,\n" + "".join(rows[1:]))
        self.finished(self.start("--resume"))
        self.assertIn("1,0.0,7.0,5,", (self.folder / "sweep.csv").read_text())

    def test_another_sweep_is_told_apart(self):
        process = self.start("--threads", "1")
        self.wait_for_rows(5)
        self.assertIn("another sweep writes", self.finished(self.start(), 2))
        process.kill()
        process.communicate()
        self.assertIn("is of another sweep", self.finished(self.start("--resume", "--kn-scale", "2"), 2))
        self.finished(self.start())                        # without --resume it begins anew

    def test_whoever_joins_shares_the_work(self):
        wanted = self.whole()
        first = self.start("--threads", "1")
        self.wait_for_rows(3)
        second = self.start("--threads", "1", "--resume")
        self.finished(first)
        self.finished(second)
        self.is_whole(wanted)

    def test_a_rank_that_is_killed_costs_what_it_was_at(self):
        wanted = self.whole()
        ranks = [self.start("--threads", "1", env={**os.environ, "PMIX_NAMESPACE": "a", "OMPI_COMM_WORLD_RANK": str(rank)})
                 for rank in range(3)]
        self.wait_for_rows(20)
        ranks[1].kill()
        ranks[1].communicate()
        self.assertNotEqual("", self.finished(ranks[0]))
        self.assertEqual("", self.finished(ranks[2]))      # one rank speaks
        self.is_whole(wanted)

    @unittest.skipUnless(MPIRUN, "mpirun is not installed")
    def test_ranks_of_mpirun_write_the_same_file(self):
        wanted = self.whole()
        environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        for n in (1, 2, 4):
            said = self.finished(self.start(before=[MPIRUN, "--oversubscribe", "-n", str(n)], env=environment))
            self.assertEqual(1, said.count("200 variants"), said)
            self.is_whole(wanted)
            (self.folder / "sweep.h5").unlink()
        process = self.start(before=[MPIRUN, "--oversubscribe", "-n", "2"], env=environment)
        self.wait_for_rows(20)
        process.terminate()                                # mpirun ends its ranks
        process.communicate(timeout=60)
        self.finished(self.start("--resume"))
        self.is_whole(wanted)


class Fits(Folder):
    def test_a_value_is_met_as_by_hand(self):
        # the rotation falls as the spring stiffens; what a run with 50 shows is to be found again
        wanted = kjoint.Model(self.deck, set="spring=50", **OPTIONS).run().curve("joint/rotation[900].x").max()
        found = fit(self.deck, {"spring": (1.0, 200.0)}, [(TURN, wanted)], **OPTIONS)
        self.assertAlmostEqual(50.0, found.values["spring"], 4)
        self.assertEqual([], found.at_bound)
        self.assertIn("spring", found.report())

    def test_a_curve_is_followed(self):
        reference = self.folder / "ref.h5"
        kjoint.Model(self.deck, set="spring=50", **OPTIONS).run().write_history(reference)
        done = subprocess.run([KJOINT, "fit", self.deck, "--vary", "spring=1:200", "--measure", "joint/rotation[900].x", "--target",
                               reference, "--until", "0.02", "--sample", "1e-3", "--formulation", "legacy", "-o", self.folder / "fit.json"],
                              capture_output=True, text=True, check=True)
        found = json.loads((self.folder / "fit.json").read_text())
        self.assertAlmostEqual(50.0, found["values"]["spring"], 4)
        self.assertIn("misfit", done.stdout)

    def test_a_target_out_of_reach_ends_at_a_bound(self):
        found = fit(self.deck, {"spring": (1.0, 20.0)}, [(TURN, 0.0)], **OPTIONS)
        self.assertEqual(["spring"], found.at_bound)
        self.assertAlmostEqual(20.0, found.values["spring"], 2)

    def test_what_cannot_be_fitted_is_refused(self):
        for vary, targets in (({"spring": (2.0, 1.0)}, [(TURN, 1.0)]), ({"spring": (1.0, 2.0, 3.0)}, [(TURN, 1.0)]),
                              ({}, [(TURN, 1.0)]), ({"spring": (1.0, 2.0)}, [])):
            with self.assertRaises(ValueError):
                fit(self.deck, vary, targets, **OPTIONS)
        with self.assertRaises(kjoint.Error):
            fit(self.deck, {"nothing": (1.0, 2.0)}, [(TURN, 1.0)], **OPTIONS)


if __name__ == "__main__":
    del sys.argv[1:3]
    unittest.main()
