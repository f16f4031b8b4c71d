#!/usr/bin/env python3
"""A run that is killed at a random moment goes on from its last checkpoint with the bits of one that went through.

usage: check_kill_restart.py KJOINT WORK_FOLDER KILLS

Each scene is run without an end in sight, with a checkpoint every few hundredths of a second, and killed some time after
the first one is there; the run that goes on from it is killed, too. What the last checkpoint leads to is compared with a
run that nothing stopped, dataset by dataset, to some samples beyond it. Nothing here hangs on the clock but the moments of
the kills.
"""
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

import h5py

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "tools"))
import bench_scenes

DECKS = pathlib.Path(__file__).parents[2] / "decks"
NO_END, EVERY, MOST_DELAY = "1e4", "0.03", 0.5      # end of the run; [s] between checkpoints, to the kill

# deck, or the joints of a chain; sample interval; words of the run
SCENES = (
    ("slider_crank", 1e-4, ()),
    ("slider_crank", 1e-5, ("--legacy",)),
    (10, 1e-2, ("--islands",)),
    (10, 2e-3, ("--integrator", "rkmk4")),
    ("knee", 1e-3, ("--live",)),
    ("door_hinge", 1e-3, ("--fast",)),
)


def series(path, rows=None):
    """All datasets as bytes, which tell NaN from NaN and 0 from -0 as well; of those over time the first rows"""
    found = {}

    def take(name, thing):
        if isinstance(thing, h5py.Dataset) and thing.dtype.kind in "fi":
            over_time = thing.maxshape[0] is None
            found[name] = (thing[:rows] if over_time else thing[()]).tobytes()

    with h5py.File(path) as file:
        file.visititems(take)
    return found


def regular_rows(path):
    """Samples at the times of all runs; 0 of a file that is not there yet"""
    if not path.exists():
        return 0
    with h5py.File(path) as file:
        return len(file["time"]) - int(file["final"][-1])


def kill(words, work):
    """Start a run and kill it, some time after it wrote a checkpoint or where it began. None, or why it ended before"""
    checkpoint = work / "x.restart.h5"
    run = subprocess.Popen(words, cwd=work, stderr=subprocess.PIPE, text=True)
    while not checkpoint.exists() and run.poll() is None:
        time.sleep(0.002)
    time.sleep(random.uniform(0.0, MOST_DELAY))
    run.send_signal(signal.SIGKILL)
    _, said = run.communicate()
    return None if run.returncode == -signal.SIGKILL else f"ended with {run.returncode} before it was killed: {said}"


def trial(kjoint, deck, sample, words, work):
    """Kill a run, let it go on, kill that, let it go on to an end. What is wrong, None if nothing is; what was seen"""
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    start = [kjoint, "run", deck, "-q", "--energy-limit", "1e9", "--sample", repr(sample), *words]
    go_on = [kjoint, "run", "-q", "--restart", "x.restart.h5"]
    often = ["--checkpoint-every", EVERY]
    wrong = kill([*start, "-o", "x.h5", "--until", NO_END, *often], work) or kill([*go_on, *often], work)
    if wrong:
        return wrong, ""
    with h5py.File(work / "x.restart.h5") as file:
        reached = float(file.attrs["time"])
    done = subprocess.run([*go_on, "--until", repr(reached + 7.5*sample)], cwd=work, capture_output=True, text=True)
    if done.returncode:
        return f"does not go on from {reached}: {done.stderr}", ""
    rows = regular_rows(work / "x.h5")
    run = subprocess.Popen([*start, "-o", "whole.h5", "--until", NO_END], cwd=work, stderr=subprocess.DEVNULL)
    while regular_rows(work / "whole.h5") < rows and run.poll() is None:
        time.sleep(0.05)
    run.terminate()
    run.wait()
    went_on, whole = series(work / "x.h5", rows), series(work / "whole.h5", rows)
    if went_on.keys() != whole.keys():
        return f"other datasets: {went_on.keys() ^ whole.keys()}", ""
    other = [name for name in whole if went_on[name] != whole[name]]
    return (f"differs after {reached}: {other}" if other else None), f"t = {reached:g}, {rows} rows"


def main(kjoint, folder, kills):
    work = pathlib.Path(folder).resolve()
    work.mkdir(parents=True, exist_ok=True)
    seed = int(time.time())
    random.seed(seed)
    print("seed", seed)
    bench_scenes.write("chain", 10, work / "chain")
    failed = 0
    for i in range((int(kills) + 1)//2):
        name, sample, words = SCENES[i % len(SCENES)]
        deck = work / "chain_0000.rad" if name == 10 else DECKS / f"{name}_0000.rad"
        wrong, seen = trial(kjoint, deck, sample, words, work / "trial")
        print(f"{'FAIL' if wrong else 'ok'}    {name} {' '.join(words)}: {wrong or seen}", flush=True)
        failed += wrong is not None
    sys.exit(failed > 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
