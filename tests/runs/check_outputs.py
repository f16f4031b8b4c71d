#!/usr/bin/env python3
"""What commands write, and where: no input, no device, one run at a time; how runs end that something stops.

usage: check_outputs.py KJOINT TESTS_FOLDER WORK_FOLDER
"""
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest

import h5py

WELL, RAN_AGAINST, INPUT, FILE = 0, 1, 2, 3


class Outputs(unittest.TestCase):
    """Each test in a folder of its own, with a deck and a T01"""

    def setUp(self):
        self.folder = WORK / self.id().split(".")[-1]
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        case = next(path for path in sorted((TESTS / "parity").glob("*/*T01")))
        shutil.copy(case, self.folder / "a.T01")
        for number in ("0000", "0001"):
            shutil.copy(TESTS.parent / "decks" / f"slider_crank_{number}.rad", self.folder / f"s_{number}.rad")

    def do(self, *words, code=WELL, **more):
        done = subprocess.run([KJOINT, *words], cwd=self.folder, capture_output=True, text=True, **more)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout + done.stderr

    def start(self, out, *more):
        """A run that takes far longer than a test, when its first row can be read"""
        run = subprocess.Popen([KJOINT, "run", "s_0000.rad", "-q", "--until", "1e3", "-o", out, *more], cwd=self.folder,
                               stderr=open(self.folder / "said", "w", encoding="utf-8"))
        self.addCleanup(run.kill)
        while not (self.folder / out).exists() and run.poll() is None:
            time.sleep(0.05)
        return run

    def attributes(self, name):
        with h5py.File(self.folder / name) as file:
            return dict(file["run"].attrs), len(file["time"])

    def test_inputs_stay(self):
        """By any spelling of the path, through links of both kinds"""
        os.symlink("s_0000.rad", self.folder / "soft")
        os.link(self.folder / "s_0001.rad", self.folder / "hard")
        self.do("convert", "a.T01", "-o", "b.h5")
        before = {path: path.read_bytes() for path in self.folder.iterdir()}
        for words in (("run", "s_0000.rad", "-o", "s_0000.rad"), ("run", "s_0000.rad", "-o", "./s_0001.rad"),
                      ("run", "s_0000.rad", "-o", "soft"), ("run", "s_0000.rad", "-o", "hard"),
                      ("convert", "a.T01", "-o", "../test_inputs_stay/a.T01"), ("diff", "a.T01", "b.h5", "--junit", "a.T01"),
                      ("diff", "a.T01", "b.h5", "--junit", "b.h5"), ("export", "b.h5", "-o", "b.h5", "--to", "csv"),
                      ("export", "b.h5", "-o", "b.h5", "--to", "t01")):
            self.assertIn("is an input", self.do(*words, code=INPUT))
        self.assertEqual(before, {path: path.read_bytes() for path in self.folder.iterdir()})

    def test_only_files_are_replaced(self):
        os.mkfifo(self.folder / "pipe")
        os.mkdir(self.folder / "folder")
        os.symlink("/dev/null", self.folder / "null")
        os.symlink("nowhere", self.folder / "dangling")
        for name in ("pipe", "folder", "null", "dangling", "/dev/null", ""):
            self.do("run", "s_0000.rad", "-o", name, code=INPUT)
            self.do("convert", "a.T01", "-o", name, code=INPUT)
            self.do("diff", "a.T01", "a.T01", "--junit", name, code=INPUT)
        self.assertEqual(len(list(self.folder.iterdir())), 7)
        os.symlink("real.h5", self.folder / "link.h5")
        (self.folder / "real.h5").touch()
        self.do("convert", "a.T01", "-o", "link.h5")
        self.assertTrue((self.folder / "link.h5").is_symlink())
        self.attributes("real.h5")

    def test_second_run_is_refused(self):
        first = self.start("x.h5")
        self.assertIn("another run is writing x.h5", self.do("run", "s_0000.rad", "-o", "x.h5", code=FILE))
        self.assertIn("another run is writing x.h5", self.do("convert", "a.T01", "-o", "x.h5", code=FILE))
        self.assertIn("RUNNING\n", self.do("info", "x.h5"))
        first.send_signal(signal.SIGINT)
        self.assertEqual(first.wait(), 130)
        self.assertEqual(self.attributes("x.h5")[0]["exit_code"], 130)

    def test_who_loses_the_file_says_so(self):
        first = self.start("x.h5")
        (self.folder / "x.h5").unlink()
        self.do("convert", "a.T01", "-o", "x.h5")
        before = (self.folder / "x.h5").read_bytes()
        first.send_signal(signal.SIGTERM)
        first.wait()
        self.assertIn("was removed or replaced", (self.folder / "said").read_text(encoding="utf-8"))
        self.assertEqual((self.folder / "x.h5").read_bytes(), before)

    def test_signals(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            run = self.start(f"{number}.h5")
            run.send_signal(number)
            self.assertEqual(run.wait(), 128 + number)
            facts, rows = self.attributes(f"{number}.h5")
            self.assertEqual((facts["exit_code"], facts["status"]), (128 + number, "STOPPED BY USER"))
            self.assertGreater(rows, 0)

    def test_older_history(self):
        """Stays when a run fails, with the place of its rows; gives way to one that is stopped"""
        self.do("convert", "a.T01", "-o", "x.h5")
        before = (self.folder / "x.h5").read_bytes()
        said = self.do("run", "s_0000.rad", "--energy-limit", "0", "-o", "x.h5", code=RAN_AGAINST)
        part, = self.folder.glob("x.h5.*.part")
        self.assertIn(part.name, said)
        self.assertGreater(self.attributes(part.name)[1], 0)
        self.assertEqual((self.folder / "x.h5").read_bytes(), before)
        part.unlink()
        run = subprocess.Popen([KJOINT, "run", "s_0000.rad", "-q", "--until", "1e3", "-o", "x.h5"], cwd=self.folder)
        while not list(self.folder.glob("x.h5.*.part")):
            time.sleep(0.05)
        time.sleep(0.2)
        run.terminate()
        self.assertEqual(run.wait(), 143)
        self.assertEqual(self.attributes("x.h5")[0]["exit_code"], 143)
        self.assertEqual(list(self.folder.glob("x.h5.*.part")), [])

    def test_killed_run_is_found(self):
        (self.folder / "x.h5").touch()
        run = subprocess.Popen([KJOINT, "run", "s_0000.rad", "-q", "--until", "1e3", "-o", "x.h5"], cwd=self.folder)
        while not list(self.folder.glob("x.h5.*.part")):
            time.sleep(0.05)
        (self.folder / "x.h5").unlink()
        self.assertIn("a run that is to become it writes x.h5.", self.do("info", "x.h5", code=FILE))
        run.kill()
        run.wait()
        self.assertIn("a run that did not end left x.h5.", self.do("info", "x.h5", code=FILE))

    def test_limit_of_the_size_of_files(self):
        """Too small for a beginning: no file; else the rows before it"""
        for most, rows in ((100000, None), (3000000, 100)):
            def limit():
                resource.setrlimit(resource.RLIMIT_FSIZE, (most, resource.RLIM_INFINITY))
            self.do("run", "s_0000.rad", "-q", "--until", "1e3", "-o", "x.h5", code=FILE, preexec_fn=limit)
            self.assertEqual((self.folder / "x.h5").exists(), rows is not None)
        facts, found = self.attributes("x.h5")
        self.assertGreaterEqual(found, rows)
        self.assertTrue(facts["status"].startswith("ERROR TERMINATION: cannot write rows"))
        self.assertEqual(facts["exit_code"], FILE)


if __name__ == "__main__":
    KJOINT, TESTS, WORK = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3]).resolve()
    unittest.main(argv=sys.argv[:1])
