#!/usr/bin/env python3
"""Run some cases and check the layout of their histories, in every reader.

The last is so wide that a row is several chunks.

usage: run_layout.py KJOINT
"""
import pathlib
import subprocess
import sys
import tempfile

TESTS = pathlib.Path(__file__).parents[1]
sys.path.insert(0, str(TESTS.parent / "tools"))
import bench_scenes


def main(kjoint):
    with tempfile.TemporaryDirectory() as folder:
        runs = [(TESTS / place / case / f"{case}_0000.rad", ["--legacy"])
                for place, case in (("parity", "REV01"), ("parity", "UNI01"), ("parity45", "KTRA3"))]
        runs += [(TESTS.parent / "decks" / "spring_mount_0000.rad", [])]
        wide = pathlib.Path(folder) / "wide"
        bench_scenes.write("chain", 9000, wide, until=1e-3, sample=5e-4)
        runs.append((f"{wide}_0000.rad", []))
        for starter, options in runs:
            history = pathlib.Path(folder) / "run.h5"
            subprocess.run([kjoint, "run", *options, "-q", starter, "-o", history], check=True)
            check = [sys.executable, TESTS / "layout" / "check_layout.py", history]
            if subprocess.run(check, check=False).returncode != 0:
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
