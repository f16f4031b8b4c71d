"""A cycle allocates nothing, in a mechanism with conditions and drives, stops and friction, springs with laws, under each
integrator.

usage: check_allocations.py KJOINT COUNTER SOURCE

COUNTER is a library that counts what a program allocates (support/count_allocations.c). A scene runs to two times, a
sample at the end alone. What the longer run allocates more may be texts and buffers of a longer file, some hundred at
most; an allocation in each of thirty cycles would be more.
"""
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

CYCLES = 30000
DECKS = ("revolute_pendulum", "slider_crank", "knee", "door_hinge", "spring_mount")
INTEGRATORS = {"legacy": ["--legacy"], "split2": [], "liemid": ["--integrator", "liemid"],
               "rkmk4": ["--integrator", "rkmk4"], "compliant": ["--integrator", "compliant"]}
REFUSED = {("door_hinge", "rkmk4")}                # it has friction


def run(kjoint, counter, deck, until, options, out):
    """Cycles and allocations of a run"""
    done = subprocess.run([kjoint, "run", deck, "-q", "--json", "-o", out, "--until", repr(until), "--sample", "1e9",
                           "--threads", "1", *options], capture_output=True, text=True, check=True,
                          env={**os.environ, "LD_PRELOAD": counter})
    return json.loads(done.stdout)["cycles"], int(re.search(r"allocations: (\d+)", done.stderr).group(1))


def main(kjoint, counter, source):
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run.h5"
        for deck in DECKS:
            path = source / "decks" / f"{deck}_0000.rad"
            for name, options in INTEGRATORS.items():
                if (deck, name) in REFUSED:
                    continue
                begin = 0.3 if name == "compliant" else 0.01   # its first steps are long
                cycles, before = run(kjoint, counter, path, begin, options, out)
                last, after = run(kjoint, counter, path, begin*(1 + CYCLES/cycles), options, out)
                print(f"{deck} {name}: {after - before} allocations more in {last - cycles} cycles")
                failed = failed or after - before > (last - cycles)/30
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], Path(sys.argv[3])))
