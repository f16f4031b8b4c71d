#!/usr/bin/env python3
"""A disk that gets full ends a run with an error, and the file has every row up to there.

usage: check_full_disk.py KJOINT WORK_FOLDER

The disks are small ones in memory, which takes the right to mount: 20 MB are full before the first flush
of the file, 300 MB after it.
"""
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


def main(kjoint, folder):
    work = pathlib.Path(folder)
    disk = work / "disk"
    disk.mkdir(parents=True, exist_ok=True)
    bench_scenes.write("chain", 1000, work / "chain")
    failed = 0
    for size in ("20m", "300m"):
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", disk], stderr=subprocess.DEVNULL).returncode:
            print("no right to mount a small disk")
            sys.exit(SKIPPED)
        try:
            wrong = complaint(kjoint, work / "chain_0000.rad", disk / "full.h5")
        except (OSError, KeyError) as error:
            wrong = str(error)
        finally:
            subprocess.run(["umount", disk], check=True)
        print(f"FAIL  {size}: {wrong}" if wrong else f"ok    {size}")
        failed += wrong is not None
    sys.exit(failed > 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
