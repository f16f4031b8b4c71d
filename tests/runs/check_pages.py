#!/usr/bin/env python3
"""The arrays of a large scene lie on huge pages, where the system has them.

usage: check_pages.py KJOINT WORK_FOLDER

Looks into /proc while a run goes on. A chain of 10 000 joints goes through more than 10 MB a cycle under
each formulation: half of that must be on huge pages at least.
"""
import mmap
import pathlib
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "tools"))
import bench_scenes

MADV_COLLAPSE = 25
SKIPPED = 77
MB = 1024*1024
ENOUGH = 5*MB
SECONDS = 20


def system_can():
    room = mmap.mmap(-1, 8*MB, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    room.write(bytes(8*MB))
    try:
        room.madvise(MADV_COLLAPSE)
    except OSError:
        return False
    return huge_bytes("self") > 0


def huge_bytes(process):
    """On huge pages, of a process"""
    try:
        lines = pathlib.Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except (OSError, ProcessLookupError):
        return 0
    return next((1024*int(line.split()[1]) for line in lines if line.startswith("AnonHugePages:")), 0)


def most_huge(kjoint, deck, options, enough):
    """The most that a run has, until it is enough"""
    run = subprocess.Popen([kjoint, "run", deck, "-q", "--until", "1e3", "-o", deck.with_suffix(".h5"), *options],
                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    most, begin = 0, time.monotonic()
    while most < enough and run.poll() is None and time.monotonic() < begin + SECONDS:
        most = max(most, huge_bytes(run.pid))
        time.sleep(0.02)
    run.terminate()
    run.wait()
    return most


def main(kjoint, folder):
    if not system_can():
        print("no huge pages here")
        sys.exit(SKIPPED)
    work = pathlib.Path(folder)
    work.mkdir(parents=True, exist_ok=True)
    bench_scenes.write("chain", 10000, work / "large")
    failed = 0
    for options in (["--legacy"], ["--formulation", "consistent"]):
        most = most_huge(kjoint, work / "large_0000.rad", options, ENOUGH)
        print(f"{'ok    ' if most >= ENOUGH else 'FAIL  '}{options[-1]}: {most//MB} MB on huge pages")
        failed += most < ENOUGH
    sys.exit(failed > 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
