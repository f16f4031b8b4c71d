#!/usr/bin/env python3
"""Run one parity case: its decks through kjoint, then the history against OpenRadioss's.

usage: run_case.py KJOINT CASE_DIR WORK_DIR [TOLERANCE]

The verdict is asked twice: of compare_t01.py, which shares no code with kjoint, and of
`kjoint diff --profile parity`. TOLERANCE (of the peak of each channel) replaces 1e-7.
"""
import pathlib
import subprocess
import sys

import compare_t01


def main(kjoint, case_dir, work_dir, *tolerance):
    case, work = pathlib.Path(case_dir), pathlib.Path(work_dir)
    work.mkdir(parents=True, exist_ok=True)
    history, reference = work / f"{case.name}.h5", case / f"{case.name}T01"
    history.unlink(missing_ok=True)
    subprocess.run([kjoint, "run", "--legacy", case / f"{case.name}_0000.rad", "-o", history],
                   check=True)
    status = compare_t01.main(reference, history, *tolerance)
    if subprocess.run([kjoint, "help", "diff"], capture_output=True, check=False).returncode == 0:
        diff = [kjoint, "diff", reference, history, "--profile", "parity"]
        diff += ["--rtol", *tolerance] if tolerance else []
        status = subprocess.run(diff, check=False).returncode or status
    return status


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) in (4, 5) else __doc__)
