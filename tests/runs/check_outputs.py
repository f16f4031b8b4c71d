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
import xarray

WELL, RAN_AGAINST, INPUT, FILE = 0, 1, 2, 3


class Commands(unittest.TestCase):
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
        with open(self.folder / "said", "w", encoding="utf-8") as said:
            run = subprocess.Popen([KJOINT, "run", "s_0000.rad", "-q", "--until", "1e3", "-o", out, *more],
                                   cwd=self.folder, stderr=said)
        self.addCleanup(run.wait)
        self.addCleanup(run.kill)
        while not (self.folder / out).exists() and run.poll() is None:
            time.sleep(0.05)
        return run

    def attributes(self, name):
        with h5py.File(self.folder / name) as file:
            return dict(file["run"].attrs), len(file["time"])


class Outputs(Commands):
    """What may be written, and by whom"""

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
            self.do("export", "a.T01", "--to", "t01", "-o", name, code=INPUT)
        os.mkfifo(self.folder / "p.restart.h5")
        self.do("run", "s_0000.rad", "--checkpoint", "-o", "p.h5", code=INPUT)
        self.assertEqual(len(list(self.folder.iterdir())), 8)
        self.assertTrue((self.folder / "p.restart.h5").is_fifo())
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

    def test_older_files_stay_when_new_ones_find_no_room(self):
        """T01 and checkpoint: written beside, whole or not at all; what is left of the new one is nothing"""
        self.do("export", "a.T01", "-o", "oldT01")
        self.do("run", "s_0000.rad", "-q", "--until", "0.001", "--checkpoint", "-o", "x.h5")
        before = {path: path.read_bytes() for path in self.folder.iterdir() if path.name != "x.h5"}

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (3000, resource.RLIM_INFINITY))
        self.assertIn("cannot write oldT01: ", self.do("export", "a.T01", "-o", "oldT01", code=FILE, preexec_fn=limit))
        self.assertIn("cannot write knee_0000.rad: ", self.do("new", "knee", code=FILE, preexec_fn=limit))
        self.assertEqual(before, {path: path.read_bytes() for path in self.folder.iterdir() if path.name != "x.h5"})

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


class Life(Commands):
    """A run is watched, followed by h5py, killed and put right"""

    def polled(self, swmr, *more):
        """Rows that a reader saw, one look after the other, of a run that goes on"""
        self.start("x.h5", *more)
        seen = []
        file = h5py.File(self.folder / "x.h5", "r", swmr=swmr)
        time_, force = file["time"], file["joint/force"]
        while len(seen) < 4:
            if swmr:
                time_.refresh()
                force.refresh()
            else:
                file = h5py.File(self.folder / "x.h5")
                time_, force = file["time"], file["joint/force"]
            times = time_[:]
            self.assertTrue((times[1:] > times[:-1]).all())
            self.assertTrue(abs(force[:][1:len(times)]).max(axis=(1, 2)).all())       # whole rows
            if not seen or len(times) > seen[-1]:
                seen.append(len(times))
            if not swmr:
                file.close()
            time.sleep(0.2)
        file.close()
        return seen

    def test_readers_of_a_run(self):
        self.polled(False)
        self.assertIn("samples", self.do("info", "x.h5"))

    def test_readers_that_follow_a_run(self):
        """Opened once by SWMR; other readers open it, too"""
        self.polled(True, "--live")
        self.attributes("x.h5")

    def test_handles_one_after_the_other_follow_a_run(self):
        """From one open file: each look opens its datasets, and refreshes them"""
        self.start("x.h5", "--live")
        seen = 0
        with h5py.File(self.folder / "x.h5", "r", swmr=True) as file:
            for look in range(3):
                rows = seen
                while rows == seen:
                    time.sleep(0.1)
                    file["time"].refresh()
                    rows = len(file["time"])
                force = file["joint/force"]
                force.refresh()
                self.assertTrue(abs(force[:][1:rows]).max(axis=(1, 2)).all(), look)
                del force
                seen = rows

    def rows_of(self, name):
        """As another process sees them, which has not opened the file before"""
        look = f"import h5py; print(len(h5py.File('{name}')['time']))"
        return int(subprocess.run([sys.executable, "-c", look], cwd=self.folder, capture_output=True, check=True).stdout)

    def test_datasets_that_are_opened_late_can_be_read(self):
        """A reader has the file open while the run goes on, and only then opens what is in it: rows of then"""
        self.start("x.h5")
        for _ in range(3):
            with h5py.File(self.folder / "x.h5") as file:
                before = rows = self.rows_of("x.h5")
                while rows == before:
                    time.sleep(0.1)
                    rows = self.rows_of("x.h5")
                self.assertGreaterEqual(len(file["joint/force"][:]), rows)
                self.assertGreaterEqual(len(file["rigid_body/position"][:]), rows)

    def test_xarray_reads_a_run(self):
        """The root, a group, and all as a tree, by both of its engines, as the run goes on"""
        self.start("x.h5")
        seen = 0
        for engine in ("netcdf4", "h5netcdf", "netcdf4"):
            while self.rows_of("x.h5") == seen:
                time.sleep(0.1)
            path = self.folder / "x.h5"
            with xarray.open_dataset(path, engine=engine) as run:
                rows = run.sizes["time"]
                self.assertTrue((run.kinetic_energy_trans.values[1:] > 0).all())
            with xarray.open_dataset(path, engine=engine, group="joint") as joint:
                self.assertGreaterEqual(joint.sizes["time"], rows)
                self.assertTrue(abs(joint.force.values[1:]).max(axis=(1, 2)).all())
            with xarray.open_datatree(path, engine=engine) as tree:
                self.assertGreaterEqual(tree["rigid_body"].position.values.shape[0], rows)
            self.assertGreater(rows, seen)
            seen = rows

    def test_watch_ends_with_the_run(self):
        run = self.start("x.h5")
        watch = subprocess.Popen([KJOINT, "watch", "x.h5", "joint/force[901].y"], cwd=self.folder, stdout=subprocess.PIPE,
                                 text=True)
        self.assertRegex(watch.stdout.readline(),
                         "^RUNNING  .* samples  t .* dt .*kinetic .*gap .*joint 90.*force.*y .*[\u2581-\u2588]")
        run.send_signal(signal.SIGINT)
        self.assertIn("STOPPED BY USER", watch.stdout.read())
        self.assertEqual(watch.wait(), WELL)
        watch.stdout.close()
        killed = self.start("y.h5")
        killed.kill()
        killed.wait()
        self.assertIn("the run was killed", self.do("watch", "y.h5", code=RAN_AGAINST))
        self.do("watch", "none.h5", code=FILE)

    def test_recover(self):
        """The outcome, lengths, rows that cannot be read, marks of an open file; a sound file stays as it is"""
        self.do("convert", "a.T01", "-o", "sound.h5")
        before = (self.folder / "sound.h5").read_bytes()
        self.assertIn("sound.h5 is sound", self.do("recover", "sound.h5"))
        self.assertEqual((self.folder / "sound.h5").read_bytes(), before)
        run = self.start("x.h5", "--live")
        self.assertIn("a run is writing", self.do("recover", "x.h5", code=FILE))
        run.kill()
        run.wait()
        with h5py.File(self.folder / "x.h5") as file:
            rows, last = len(file["time"]), file["time"][-1]
        self.assertIn("the run did not end", self.do("recover", "x.h5"))
        with h5py.File(self.folder / "x.h5") as file:
            self.assertEqual((len(file["time"]), file["time"][-1]), (rows, last))
            self.assertEqual(file["run"].attrs["exit_code"], 137)
        self.assertIn("x.h5 is sound", self.do("recover", "x.h5"))
        with h5py.File(self.folder / "x.h5", "a") as file:
            file["joint/force"].resize(rows + 3, axis=0)
        self.assertIn(f"have: {rows} of {rows + 3}", self.do("recover", "x.h5"))
        self.do("info", "x.h5")
        with h5py.File(self.folder / "x.h5") as file:
            self.assertEqual(len(file["joint/force"]), rows)
        self.do("run", "s_0000.rad", "-q", "--until", "0.02", "--sample", "1e-4", "-o", "z.h5")
        with h5py.File(self.folder / "z.h5") as file:
            place = file["joint/moment"].id.get_chunk_info(0).byte_offset
            rows = len(file["time"])
        with open(self.folder / "z.h5", "r+b") as file:
            file.seek(place + 40)
            file.write(bytes(200))
        self.do("info", "z.h5", code=FILE)
        with h5py.File(self.folder / "sound.h5", "a"):
            self.assertIn("another program holds sound.h5 open", self.do("recover", "sound.h5", code=FILE))
        self.do("recover", "z.h5", code=FILE)                # its first chunk: there is no row left


if __name__ == "__main__":
    KJOINT, TESTS, WORK = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3]).resolve()
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
