#!/usr/bin/env python3
"""Runs that are stopped and go on: checkpoints, --restart, runs 2 and on, the control file.

usage: test_restart.py KJOINT [unittest arguments]
"""
import json
import signal
import subprocess
import sys
import time
import unittest

import h5py
import numpy as np

import test_cli
from test_cli import Program


def values(path):
    """Every series and constant of a history, by name, without what /run says of the run."""
    found = {}
    with h5py.File(path, "r") as file:
        file.visititems(lambda name, item: found.update({name: item[()]})
                        if isinstance(item, h5py.Dataset) and not name.startswith("input") else None)
    return found


def samples(path):
    with h5py.File(path, "r") as file:
        return len(file["time"])


class Restart(Program):
    def same(self, one, other):
        a, b = values(self.folder / one), values(self.folder / other)
        self.assertEqual(sorted(a), sorted(b))
        for name, value in a.items():
            if value.dtype.kind == "f":                    # to the bit, NaN of what is not there, too
                value, against = value.tobytes(), b[name].tobytes()
                self.assertEqual(value, against, name)
            else:
                np.testing.assert_array_equal(value, b[name], name)

    def run_deck(self, *words, **more):
        return self.kjoint("run", "-q", "REV01_0000.rad", *words, **more)

    def test_a_stopped_run_goes_on_with_the_same_bits(self):
        # ends between two samples of 2e-3, where consistent cuts its steps
        for formulation in ("legacy", "consistent"):
            self.run_deck("--formulation", formulation, "-o", "whole.h5")
            self.run_deck("--formulation", formulation, "-o", "part.h5", "--until", "0.0131", "--checkpoint")
            self.assertLess(samples(self.folder / "part.h5"), 9)
            done = self.kjoint("run", "--restart", "part.restart.h5", "--until", "0.0199")
            self.assertIn("part.h5", done.stdout)
            self.same("whole.h5", "part.h5")

    def test_a_run_that_a_signal_ends_leaves_a_checkpoint(self):
        self.engine.write_text(self.engine.read_text().replace("\n0.0199\n", "\n40\n", 1))
        run = subprocess.Popen([test_cli.KJOINT, "run", "REV01_0000.rad", "--sample", "0.01"], text=True,
                               cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        for line in run.stderr:
            if "E-" in line:                               # the first line of the listing
                break
        run.send_signal(signal.SIGUSR1)                    # a checkpoint, and on
        checkpoint = self.folder / "REV01.restart.h5"
        while not checkpoint.exists() and run.poll() is None:
            time.sleep(0.01)
        first = checkpoint.stat().st_mtime_ns
        run.send_signal(signal.SIGINT)
        said, _ = run.communicate()
        self.assertEqual(130, run.returncode)
        self.assertIn("checkpoint    REV01.restart.h5", said)
        self.assertNotEqual(first, checkpoint.stat().st_mtime_ns)
        with h5py.File(checkpoint) as file:
            end = float(file.attrs["time"]) + 0.05
        self.kjoint("run", "-q", "--restart", "REV01.restart.h5", "--until", repr(end))
        self.run_deck("--until", repr(end), "--sample", "0.01", "-o", "whole.h5")
        self.same("whole.h5", "REV01.h5")

    def test_run_2_goes_on_from_run_1(self):
        self.run_deck("-o", "whole.h5")
        text = self.engine.read_text()
        self.engine.write_text(text.replace("\n0.0199\n", "\n0.0107\n", 1) + "/RFILE\n0\n")
        (self.folder / "REV01_0002.rad").write_text(text.replace("/RUN/REV01/1", "/RUN/REV01/2"))
        for command in ("run", "check"):                   # both say the same before, between, and after
            early = self.kjoint(command, "-q", "REV01_0002.rad", code=3)
            self.assertIn("REV01.restart.h5", early.stderr)
            self.assertIn("/RFILE", early.stderr)
        self.run_deck()
        self.assertIn("0 errors", self.kjoint("check", "REV01_0002.rad").stdout)
        self.kjoint("run", "-q", "REV01_0002.rad")
        self.same("whole.h5", "REV01.h5")
        self.run_deck("--until", "0.02")
        late = self.kjoint("check", "REV01_0002.rad", code=2)
        self.assertIn("is at the end of the run already", late.stderr)
        self.assertIn("1 error, ", late.stdout)            # it counts what it says
        late = self.kjoint("run", "REV01_0002.rad", code=2)
        self.assertEqual("", late.stdout)                  # no summary of a run that was refused
        # a second run is none that starts by itself
        lone = self.folder / "second.rad"
        lone.write_text((self.folder / "REV01_0002.rad").read_text())
        for words in (("run", "-o", "lone.h5"), ("check",)):
            done = self.kjoint(*words, "REV01_0000.rad", "second.rad", code=2)
            self.assertIn("saved state of the run before", done.stderr)
        self.assertFalse((self.folder / "lone.h5").exists())

    def test_what_does_not_go_on_is_refused_and_loses_nothing(self):
        self.run_deck("--checkpoint")
        # the cut steps of the last interval are gone through again
        self.kjoint("run", "-q", "--restart", "REV01.restart.h5")
        history = (self.folder / "REV01.h5").read_bytes()
        restart = ("run", "-q", "--restart", "REV01.restart.h5")
        self.assertIn("at the end", self.kjoint(*restart, "--until", "0.01", code=2).stderr)
        self.assertIn("--legacy", self.kjoint(*restart, "--legacy", code=2).stderr)
        self.assertIn("kn_scale", self.kjoint(*restart, "--until", "1", "--kn-scale", "2", code=2).stderr)
        self.assertIn("no checkpoint", self.kjoint("run", "--restart", "REV01.h5", code=3).stderr)
        self.assertIn("no checkpoint", self.kjoint("run", "--restart", "none.h5", code=3).stderr)
        short = self.folder / "short.restart.h5"
        short.write_bytes((self.folder / "REV01.restart.h5").read_bytes()[:-1000])
        self.assertIn("damaged", self.kjoint("run", "--restart", short.name, code=3).stderr)
        self.starter.write_text(self.starter.read_text() + "# changed\n")
        self.assertIn("another deck", self.kjoint(*restart, "--until", "1", code=2).stderr)
        self.assertEqual(history, (self.folder / "REV01.h5").read_bytes())

    def test_a_history_of_its_own(self):
        self.run_deck("--until", "0.0101", "--checkpoint")
        before = (self.folder / "REV01.h5").read_bytes()
        self.kjoint("run", "-q", "--restart", "REV01.restart.h5", "--until", "0.0199", "--new-file")
        self.assertEqual(before, (self.folder / "REV01.h5").read_bytes())
        self.run_deck("-o", "whole.h5")
        whole, rest = values(self.folder / "whole.h5"), values(self.folder / "REV01.2.h5")
        n = samples(self.folder / "REV01.2.h5")
        self.assertLess(n, samples(self.folder / "whole.h5"))
        np.testing.assert_array_equal(whole["joint/force"][-n:], rest["joint/force"])
        (self.folder / "REV01.h5").unlink()                # rows that are gone are not made up
        done = self.kjoint("run", "--restart", "REV01.restart.h5", "--until", "0.0199", code=3)
        self.assertIn("--new-file", done.stderr)

    def test_the_control_file_tells_a_run_what_to_do(self):
        control = self.folder / "REV01_0001.ctl"
        run = subprocess.Popen([test_cli.KJOINT, "run", "REV01_0000.rad", "--until", "1e4", "--sample", "0.01"],
                               text=True, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        control.write_text("/INFO\n/RFILE\n/NIX\n")
        while "# /INFO" not in control.read_text() and run.poll() is None:
            time.sleep(0.05)
        answer = control.read_text()
        self.assertIn("cycles/s", answer)
        self.assertIn("/NIX: not known", answer)
        control.write_text("/STOP\n")
        said, _ = run.communicate()
        self.assertEqual(130, run.returncode)
        self.assertIn("STOPPED BY USER", said)
        self.assertTrue((self.folder / "REV01.restart.h5").exists())

    def test_stop_and_kill_limit_the_energy_error(self):
        # under legacy the energy error of this deck is far above 1e-12 after some samples
        for word, left in (("/KILL", False), ("/STOP", True)):
            text = self.engine.read_text()
            self.engine.write_text(text + f"{word}\n1e-12 0 0\n")
            done = self.run_deck("--legacy", code=1)
            self.engine.write_text(text)
            self.assertIn("energy error passed its limit", done.stderr)
            self.assertEqual(left, (self.folder / "REV01.restart.h5").exists())

    def test_the_least_step_of_dt_noda_stop_ends_a_run(self):
        # the step is the factor times the limit that check tells; a least one above it ends the run
        # at once, one below it never, as the limit of this deck hardly changes
        text = self.engine.read_text()
        for words, rule in (((), "safe_step"), (("--dt-rule", "nodal"), "nodal_step"), (("--legacy",), "nodal_step"),
                            (("--islands",), "safe_step")):
            limit = json.loads(self.kjoint("check", "REV01_0000.rad", "--json").stdout)[rule]
            for least, cycles in ((1.02*0.9*limit, 1), (0.9*0.9*limit, 1000000)):
                self.engine.write_text(text + f"/DT/NODA/STOP\n0.9 {least:.8e}\n")
                done = self.kjoint("run", "REV01_0000.rad", "--json", *words)
                self.assertEqual(cycles == 1, json.loads(done.stdout)["cycles"] <= 1, (words, done.stdout))
                self.assertEqual(cycles == 1, "KJ-9303" in done.stdout, (words, least))
        self.engine.write_text(text + f"/DT/NODA/STOP\n0.9 {limit}\n")
        self.assertIn("KJ-9303", self.kjoint("check", "REV01_0000.rad", "--json").stdout)

    def test_checkpoints_by_the_clock(self):
        self.run_deck("--until", "2", "--sample", "0.01", "--checkpoint-every", "0.05")
        self.assertTrue((self.folder / "REV01.restart.h5").exists())
        for text in ("0", "-1", "x"):
            self.assertIn("--checkpoint-every", self.run_deck("--checkpoint-every", text, code=2).stderr)


if __name__ == "__main__":
    test_cli.KJOINT = sys.argv.pop(1)
    unittest.main()
