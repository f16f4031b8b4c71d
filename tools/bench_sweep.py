#!/usr/bin/env python3
"""What a sweep gains over a loop of runs, and what it costs beside one large scene.

usage: bench_sweep.py KJOINT [--variants N] [--large N] [--rounds N]      (of a build folder that has libkjoint_c.so)

A chain of 10 joints whose stiffness varies, about 2000 cycles each, in turns: a loop of `kjoint run`,
two at a time; `kjoint sweep --threads 2`; sweeps of one thread by one and two ranks; a chain of many joints on
two threads. Prints processor and wall times, medians of the rounds.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import bench_scenes

UNTIL, EVERY = 0.345, 0.0345
NAME = "              &stiff"


def timed(*commands, at_a_time=1, **environment):
    """Wall and processor seconds of commands, so many at a time; what the last one says."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()

    def run(command):
        return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True,
                              env={**os.environ, **environment}).stdout

    with concurrent.futures.ThreadPoolExecutor(at_a_time) as pool:
        said = list(pool.map(run, commands))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.perf_counter() - start, sum(getattr(after, t) - getattr(before, t) for t in ("ru_utime", "ru_stime")), said[-1]


def measure(kjoint, folder, n, large):
    deck = folder / "chain_0000.rad"
    bench_scenes.write("chain", 10, folder / "chain")
    text = deck.read_text().replace(f"{bench_scenes.KN:20.12g}", NAME)
    assert text.count(NAME) == 10
    deck.write_text(text.replace("/NODE\n", "/PARAMETER/GLOBAL/REAL/1\nstiffness\nstiff" + "1e6".rjust(25) + "\n/NODE\n", 1))
    stiff = [1e6 + 1e5*k/n for k in range(n)]
    (folder / "all.csv").write_text("stiff\n" + "".join(f"{k}\n" for k in stiff))
    bench_scenes.write("chain", large, folder / "large")
    run = ["--until", UNTIL, "-q"]
    sweep = [kjoint, "sweep", deck, *run, "--every", EVERY, "--table", folder / "all.csv", "--measure", "joint/force[1].norm:max"]
    times = {}
    times["loop"] = timed(*([kjoint, "run", deck, *run, "--sample", EVERY, "--set", f"stiff={k}", "-o", folder / f"{i}.h5"]
                            for i, k in enumerate(stiff)), at_a_time=2)
    times["sweep"] = timed([*sweep, "--threads", 2, "-o", folder / "s.csv"])
    with open(folder / "s.csv") as file:
        cycles = sum(int(line.split(",")[-2]) for line in list(file)[1:])
    for ranks in (1, 2):
        command = [*sweep, "--threads", 1, "-o", folder / f"ranks{ranks}.csv"]
        times[f"ranks {ranks}"] = timed(*[command]*ranks, at_a_time=ranks, PMIX_NAMESPACE=f"bench{ranks}")
    times["large"] = timed([kjoint, "run", folder / "large_0000.rad", "--until", 60e-5, "--sample", 1, "--json", "-q", "--threads", 2,
                            "-o", folder / "large.h5"])
    scene = json.loads(times["large"][2])
    return {"loop over sweep, wall": times["loop"][0]/times["sweep"][0], "loop over sweep, processor": times["loop"][1]/times["sweep"][1],
            "ms a run, processor": 1e3*times["loop"][1]/n, "ms a variant, processor": 1e3*times["sweep"][1]/n,
            "ns a joint and cycle of the sweep, wall": 1e9*times["sweep"][0]/(10*cycles),
            f"ns a joint and cycle of {large} joints, wall": 1e9*scene["wall_solve"]/scene["joint_cycles"],
            "efficiency of 2 ranks": times["ranks 1"][0]/(2*times["ranks 2"][0]), "cycles a variant": cycles/n}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kjoint", type=pathlib.Path)
    parser.add_argument("--variants", type=int, default=256)
    parser.add_argument("--large", type=int, default=30000)
    parser.add_argument("--rounds", type=int, default=1)
    given = parser.parse_args()
    os.environ.setdefault("KJOINT_PYTHON", sys.executable)
    os.environ.setdefault("KJOINT_LIBRARY", str(given.kjoint.resolve().parent / "libkjoint_c.so"))
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (str(pathlib.Path(__file__).resolve().parent.parent / "python"),
                                                             os.environ.get("PYTHONPATH"))))
    with tempfile.TemporaryDirectory() as folder:
        rounds = [measure(given.kjoint.resolve(), pathlib.Path(folder), given.variants, given.large) for _ in range(given.rounds)]
    for what in rounds[0]:
        print(f"{what:50} {statistics.median(r[what] for r in rounds):10.3g}   ({', '.join(f'{r[what]:.3g}' for r in rounds)})")


if __name__ == "__main__":
    main()
