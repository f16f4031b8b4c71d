#!/usr/bin/env python3
"""Run a benchmark by the consistent formulation and hold its errors against limits.json.

usage: run_benchmark.py KJOINT CASE_DIR WORK_DIR
"""
import pathlib
import subprocess
import sys

import compare_benchmark


def main(kjoint, case_dir, work_dir):
    case, work = pathlib.Path(case_dir), pathlib.Path(work_dir)
    work.mkdir(parents=True, exist_ok=True)
    history = work / f"{case.name}.h5"
    subprocess.run([kjoint, "run", "-q", case / f"{case.name}_0000.rad", "-o", history], check=True)
    limits = case.parent / "limits.json"
    return compare_benchmark.main(case / "reference.csv", history, limits, case.name)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 4 else __doc__)
