#!/usr/bin/env python3
"""A run that is killed leaves a history that every reader opens, with whole rows up to 2 s before.

usage: check_kills.py KJOINT WORK_FOLDER KILLS

Three scenes: one that samples every cycle, one of 1000 joints, one of 10 that hardly ever fills a chunk. Each is
run undisturbed, then KILLS times until it is killed at a random moment. Every dataset of what is left is read to its
end and equals the undisturbed run; `kjoint info` reads it; rows that are lost are younger than 2 s, which the
listing tells: its lines say how far the run had come when.
"""
import pathlib
import random
import signal
import subprocess
import sys
import threading
import time

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "tools"))
import bench_scenes

PROMISED, SLACK = 2.0, 0.5          # [s]: how old a row gets before it can be read; a busy machine
WANTED = 8.0                        # [s]: what an undisturbed run shall take, about

# name, joints, end time of a first run, which tells how fast it is, sample interval [s]
SCENES = (("every cycle", 3, 8.0, 0.0), ("1000 joints", 1000, 0.25, 5e-4), ("10 joints", 10, 12.0, 0.02))


class Run:
    """A run that notes when its listing said what"""

    def __init__(self, kjoint, deck, out, until, sample):
        self.said = []
        self.process = subprocess.Popen(
            [kjoint, "run", "-v", deck, "--until", str(until), "--sample", str(sample), "-o", out],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        self.thread = threading.Thread(target=self.listen)
        self.thread.start()

    def listen(self):
        for line in self.process.stderr:
            words = line.split()
            if len(words) > 6 and words[0].isdigit():
                self.said.append((time.monotonic(), float(words[1])))

    def end(self):
        self.process.wait()
        self.thread.join()


def names_of(file):
    """Every dataset; attributes are read on the way"""
    names = ["time"]                             # which is visited by another name

    def take(name, thing):
        dict(thing.attrs)
        if isinstance(thing, h5py.Dataset):
            names.append(name)

    file.visititems(take)
    dict(file.attrs)
    return set(names)


def difference(left, whole):
    """What differs in the rows that there are, read to the end; None if nothing does. And the time of the last"""
    with h5py.File(left) as found, h5py.File(whole) as wanted:
        if names_of(found) != names_of(wanted):
            return f"other datasets: {names_of(found) ^ names_of(wanted)}", None
        rows = len(found["time"])
        for name in sorted(names_of(found)):
            values, of_all = found[name][()], wanted[name]
            if name.startswith("input/") or not of_all.ndim:
                continue
            if of_all.maxshape[0] is None and len(values) < rows:
                return f"{name} has {len(values)} of {rows} rows", None
            if not numpy.array_equal(values, of_all[:len(values)], equal_nan=values.dtype.kind == "f"):
                return f"{name} differs", None
        if found["run"].attrs["status"] != "RUNNING":
            return f"status {found['run'].attrs['status']}", None
        return None, found["time"][-1] if rows else None


def complaint(kjoint, left, whole, reached):
    """What is wrong with what a killed run left; None if nothing is"""
    wrong, last = difference(left, whole)
    if wrong:
        return wrong
    if reached > 0 and (last is None or last < reached):
        return f"the last row is of {last}, where {reached} was due"
    told = subprocess.run([kjoint, "info", left], capture_output=True, text=True)
    return told.stderr if told.returncode else None


def is_history(path):
    """Not one that was about to be created"""
    with open(path, "rb") as file:
        return file.read(4) == b"\x89HDF"


def undisturbed(kjoint, deck, out, until, sample):
    """Seconds that a run takes to its end"""
    out.unlink(missing_ok=True)
    started = time.monotonic()
    run = Run(kjoint, deck, out, until, sample)
    run.end()
    return time.monotonic() - started


def main(kjoint, folder, kills):
    work = pathlib.Path(folder)
    work.mkdir(parents=True, exist_ok=True)
    seed = int(time.time())
    random.seed(seed)
    print("seed", seed)
    failed = 0
    for name, joints, until, sample in SCENES:
        root = work / name.replace(" ", "_")
        bench_scenes.write("chain", joints, root)
        engine = root.with_name(root.name + "_0001.rad")
        engine.write_text(engine.read_text().replace("/PRINT/", "/PRINT/-50\n#/PRINT/"), encoding="utf-8")
        deck, out = f"{root}_0000.rad", root.with_suffix(".h5")
        until *= WANTED/undisturbed(kjoint, deck, out, until, sample)
        lasted = undisturbed(kjoint, deck, out, until, sample)
        whole = out.replace(root.with_suffix(".whole.h5"))
        with h5py.File(whole) as file:
            all_rows = len(file["time"])
        rows = 0
        for _ in range(int(kills)):
            out.unlink(missing_ok=True)
            started = time.monotonic()
            run = Run(kjoint, deck, out, until, sample)
            try:
                run.process.wait(random.uniform(0.02, 0.9*lasted))
            except subprocess.TimeoutExpired:
                pass
            killed = time.monotonic()
            run.process.send_signal(signal.SIGKILL)
            run.end()
            if run.process.returncode != -signal.SIGKILL:
                continue                         # it was faster than before
            left = [path for path in work.glob(out.name + "*") if is_history(path)]
            due = [t for when, t in run.said if when < killed - PROMISED - SLACK]
            wrong = "nothing is left" if due and not left else None
            if left:
                wrong = complaint(kjoint, left[0], whole, max(due, default=0.0) - sample)
                with h5py.File(left[0]) as file:
                    rows = max(rows, len(file["time"]))
            if wrong:
                print(f"FAIL  {name}, killed after {killed - started:.3f} s: {wrong}")
                failed += 1
            for path in work.glob(out.name + ".*.part"):
                path.unlink()
        print(f"{name}: {all_rows} rows in {lasted:.1f} s, up to {rows} found after {kills} kills", flush=True)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
