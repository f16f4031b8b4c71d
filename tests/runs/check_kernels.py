#!/usr/bin/env python3
"""Kernels for x86-64, -v3 and -v4 give histories of the same bytes, and each of them runs when it is asked for.

usage: check_kernels.py KJOINT SOURCE. Exit code 77 where the build or the processor has kernels of one kind alone.
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "tools"))
import bench_scenes

MACHINES = "x86-64", "x86-64-v3", "x86-64-v4"
DECKS = "slider_crank", "knee", "door_hinge", "spring_mount", "four_bar"
RUNS = {"legacy": ["--legacy"], "split2": [], "liemid": ["--integrator", "liemid"], "rkmk4": ["--integrator", "rkmk4"],
        "compliant": ["--fast"]}
REFUSED = {("door_hinge", "rkmk4")}                # it has friction


def machine_of(kjoint, asked):
    said = subprocess.run([kjoint, "--version", "-v"], check=True, capture_output=True, text=True,
                          env={**os.environ, "KJOINT_KERNELS": asked}).stdout
    return said.split("kernels ")[1].strip()


def main(kjoint, source):
    machines = [m for m in MACHINES if machine_of(kjoint, m) == m]
    if len(machines) < 2:
        return 77
    best = machine_of(kjoint, "")
    print(f"{', '.join(machines)}; {best} by itself")
    failed = best != machines[-1] or machine_of(kjoint, "vax") != best
    with tempfile.TemporaryDirectory() as folder:
        decks = {name: Path(source) / f"decks/{name}_0000.rad" for name in DECKS}
        for scene in ("chain", "mix"):             # 130 joints: whole blocks of 64, and a part of one
            bench_scenes.write(scene, 130, f"{folder}/{scene}", until=2e-3, sample=2e-4)
            decks[scene] = Path(folder) / f"{scene}_0000.rad"
        for deck, path in decks.items():
            for name, options in RUNS.items():
                if (deck, name) in REFUSED:
                    continue
                files = [Path(folder) / f"{machine}.h5" for machine in machines]
                for machine, file in zip(machines, files):
                    subprocess.run([kjoint, "run", path, "-q", "--reproducible", "-o", file, *options], check=True,
                                   capture_output=True, env={**os.environ, "KJOINT_KERNELS": machine})
                same = len({file.read_bytes() for file in files}) == 1
                print(f"{'ok    ' if same else 'FAIL  '}{deck}, {name}")
                failed = failed or not same
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 3 else __doc__)
