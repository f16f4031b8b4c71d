#!/usr/bin/env python3
"""A disk that gets full ends a run with an error, and the file has every row up to there; what else is written there is
whole or not at all. A folder without rights.

usage: check_full_disk.py KJOINT WORK_FOLDER

The disks are small ones in memory, which takes the right to mount: 20 MB are full before the first flush
of the file, 300 MB after it.
"""
import contextlib
import pathlib
import subprocess
import sys

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "tools"))
import bench_scenes

FILE_ERROR, SKIPPED = 3, 77


def complaint(kjoint, deck, history):
    """What is wrong with the end of a run that fills its disk; None if nothing is"""
    run = subprocess.run([kjoint, "run", deck, "--legacy", "-q", "--until", "10", "--sample", "5e-4", "-o", history],
                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if run.returncode != FILE_ERROR or "cannot write rows" not in run.stderr:
        return f"exit code {run.returncode}: {run.stderr}"
    with h5py.File(history) as file:
        rows = len(file["time"])
        status = file["run"].attrs["status"]
        if not status.startswith("ERROR TERMINATION"):
            return f"status {status}"
        if rows < 8 or not numpy.all(numpy.diff(file["time"][:]) > 0):
            return f"{rows} rows, times {file['time'][:]}"
        force = file["joint/force"][:rows]
        if not numpy.all(numpy.any(force != 0, axis=(1, 2))[1:]):
            return "rows of zeros"
    return None


def others(kjoint, deck, disk):
    """The same for what is written beside a history: listing, checkpoint, exports; None if nothing is wrong"""
    history, old = disk / "x.h5", disk / "oldT01"
    subprocess.run([kjoint, "run", deck, "-q", "--until", "0.002", "--sample", "1e-3", "-o", history], check=True)
    subprocess.run([kjoint, "export", history, "-o", old], check=True, stdout=subprocess.DEVNULL)
    before = old.read_bytes(), history.read_bytes()
    with contextlib.suppress(OSError), open(disk / "fill", "wb", buffering=0) as file:
        while True:
            file.write(bytes(1024))
    elsewhere = disk.parent / "elsewhere.h5"
    for words, said in ((["export", history, "-o", old], "cannot write"),
                        (["export", history, "joint/force", "-o", disk / "a.csv"], "cannot write"),
                        (["run", deck, "-q", "--until", "0.002", "--sample", "1e-3", "-o", history], "no room"),
                        (["run", deck, "-q", "--until", "0.002", "--sample", "1e-3", "-o", elsewhere, "--listing",
                          disk / "list"], "cannot write")):
        done = subprocess.run([kjoint, *words], capture_output=True, text=True)
        if done.returncode != FILE_ERROR or said not in done.stderr:
            return f"{words[0]}: exit code {done.returncode}: {done.stderr}"
    if (old.read_bytes(), history.read_bytes()) != before or len(list(disk.iterdir())) != 4:
        return f"left: {list(disk.iterdir())}"
    return None


def no_rights(kjoint, deck, work):
    """A folder that may not be written to: nothing is left, and the message names the file. Root may write anywhere but
    where a disk is read only"""
    history = work / "x.h5"
    done = subprocess.run([kjoint, "run", deck, "-q", "--until", "0.002", "--sample", "1e-3", "-o", history],
                          capture_output=True, text=True)
    if done.returncode != FILE_ERROR or f"cannot create {history}: " not in done.stderr:
        return f"exit code {done.returncode}: {done.stderr}"
    return None


def main(kjoint, folder):
    work = pathlib.Path(folder)
    disk = work / "disk"
    disk.mkdir(parents=True, exist_ok=True)
    bench_scenes.write("chain", 1000, work / "chain")
    failed = 0
    deck = work / "chain_0000.rad"
    bench_scenes.write("chain", 3, work / "few")
    for size, check in (("20m", lambda: complaint(kjoint, deck, disk / "full.h5")),
                        ("300m", lambda: complaint(kjoint, deck, disk / "full.h5")),
                        ("2m", lambda: others(kjoint, work / "few_0000.rad", disk)),
                        ("2m,ro", lambda: no_rights(kjoint, work / "few_0000.rad", disk))):
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", disk], stderr=subprocess.DEVNULL).returncode:
            print("no right to mount a small disk")
            sys.exit(SKIPPED)
        try:
            wrong = check()
        except (OSError, KeyError) as error:
            wrong = str(error)
        finally:
            subprocess.run(["umount", disk], check=True)
        print(f"FAIL  {size}: {wrong}" if wrong else f"ok    {size}")
        failed += wrong is not None
    sys.exit(failed > 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
