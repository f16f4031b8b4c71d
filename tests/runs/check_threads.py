#!/usr/bin/env python3
"""The number of threads does not change a bit of a history; threads that wait sleep; there are no
more than processors; what two cost against one beside busy processes is printed.

usage: check_threads.py KJOINT WORK_FOLDER
"""
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "tools"))
import bench_scenes

# 2600 joints: more than two threads get their share (500 joints each), where there are processors
SCENES = {"chain": 1000, "forest": 2600, "mix": 2600}
RUNS = {"legacy": ["--legacy"], "split2": [], "liemid": ["--integrator", "liemid"]}


BUSY = 4                                      # processes


def environment(**more):
    return {**{k: v for k, v in os.environ.items() if not k.startswith(("OMP_", "GOMP_"))}, **more}


def waiting(run, threads, **more):
    """What libgomp says of itself at each start of the program: policies, turns it spins"""
    said = subprocess.run([*run, "--threads", threads], check=True, capture_output=True, text=True,
                          env=environment(OMP_DISPLAY_ENV="verbose", **more)).stderr
    return re.findall(r"OMP_WAIT_POLICY = '(\w+)'", said), re.findall(r"GOMP_SPINCOUNT = '(\d+)'", said)


def check_waiting(kjoint, deck, file):
    run = [kjoint, "run", deck, "-q", "-o", file]
    policy, turns = waiting(run, "2")
    if not turns:
        return {"what libgomp says: not there": True}
    several = len(os.sched_getaffinity(0)) > 1
    lone = subprocess.run([*run, "--threads", "2"], check=True, env=environment(),
                          preexec_fn=lambda: os.sched_setaffinity(0, [min(os.sched_getaffinity(0))]))
    info = subprocess.run([kjoint, "info", file], check=True, capture_output=True, text=True).stdout
    return {"threads that wait sleep": not several or (policy[-1], turns[-1]) == ("PASSIVE", "0"),
            "one thread: the program starts once": len(waiting(run, "1")[1]) == 1,
            "what the environment says of waiting holds":
                waiting(run, "2", OMP_WAIT_POLICY="active")[0] == ["ACTIVE"],
            "one processor, one thread": lone.returncode == 0 and "threads: 1" in info}


def print_load(kjoint, deck, file):
    """Wall time of two threads over that of one, beside busy processes, in turns"""
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(BUSY)]
    try:
        times = {1: [], 2: []}
        for _ in range(5):
            for threads, seen in times.items():
                out = subprocess.run([kjoint, "run", deck, "-q", "--json", "--until", "0.02", "--sample", "1", "--threads",
                                      str(threads), "-o", file], check=True, capture_output=True, env=environment()).stdout
                seen.append(json.loads(out)["wall_solve"])
    finally:
        for process in busy:
            process.kill()
            process.wait()
    one, two = (statistics.median(times[n]) for n in (1, 2))
    print(f"beside {BUSY} busy processes: two threads take {two/one:.2f} of the time of one ({one:.2f} s)")


def main(kjoint, folder):
    work = pathlib.Path(folder)
    work.mkdir(parents=True, exist_ok=True)
    failed = 0
    for scene, joints in SCENES.items():
        bench_scenes.write(scene, joints, work / scene, until=1e-3, sample=2e-4)
        for name, options in RUNS.items():
            files = []
            for threads in (1, 2, 5):
                files.append(work / f"{scene}_{name}_{threads}.h5")
                subprocess.run([kjoint, "run", work / f"{scene}_0000.rad", "-q", "--reproducible", "--threads",
                                str(threads), "-o", files[-1], *options], check=True, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
            same = len({file.read_bytes() for file in files}) == 1
            print(f"{'ok    ' if same else 'FAIL  '}{scene} of {joints} joints, {name}: 1, 2 and 5 threads")
            failed += not same
    wrong = subprocess.run([kjoint, "run", work / "chain_0000.rad", "--threads", "0"], capture_output=True, check=False)
    print(f"{'ok    ' if wrong.returncode == 2 else 'FAIL  '}--threads 0 is refused")
    for claim, holds in check_waiting(kjoint, work / "chain_0000.rad", work / "waiting.h5").items():
        print(f"{'ok    ' if holds else 'FAIL  '}{claim}")
        failed += not holds
    print_load(kjoint, work / "chain_0000.rad", work / "load.h5")
    return 1 if failed or wrong.returncode != 2 else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 3 else __doc__)
