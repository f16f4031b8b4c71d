#!/usr/bin/env python3
"""Run a case and check the layout of its history, in every reader.

usage: run_layout.py KJOINT
"""
import pathlib
import subprocess
import sys
import tempfile

TESTS = pathlib.Path(__file__).parents[1]


def main(kjoint):
    with tempfile.TemporaryDirectory() as folder:
        for place, case in (("parity", "REV01"), ("parity", "UNI01"), ("parity45", "KTRA3")):
            history = pathlib.Path(folder) / f"{case}.h5"
            starter = TESTS / place / case / f"{case}_0000.rad"
            subprocess.run([kjoint, "run", "--legacy", "-q", starter, "-o", history], check=True)
            check = [sys.executable, TESTS / "layout" / "check_layout.py", history]
            if subprocess.run(check, check=False).returncode != 0:
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
