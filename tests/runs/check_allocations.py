"""A cycle allocates nothing: 1000 cycles more of a run are no call of malloc more, but for one where the safe bound is
renewed, about every eighth cycle.

usage: check_allocations.py KJOINT COUNTER SOURCE

COUNTER is a library that counts what a program allocates (support/count_allocations.c). A scene is
run to three times, a sample at the end alone. Between the first two the steps of the start come to
their end; what the third run has more than the second are cycles alone."""
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

CYCLES = 1000


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
        for deck, begin in (("revolute_pendulum", 0.5),):
            path = source / "decks" / f"{deck}_0000.rad"
            for name, options in (("consistent", []), ("legacy", ["--legacy"])):
                cycles, before = run(kjoint, counter, path, begin, options, out)
                end = begin*(1 + 2*CYCLES/cycles)
                middle, first = run(kjoint, counter, path, begin*(1 + CYCLES/cycles), options, out)
                last, second = run(kjoint, counter, path, end, options, out)
                more, each = second - first, (second - first)/(last - middle)
                print(f"{deck} {name}: {more} allocations more in {last - middle} cycles")
                failed = failed or each > 0.15 or last - middle < CYCLES//2   # buffers of a longer file are no cycle's
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], Path(sys.argv[3])))
