#!/usr/bin/env python3
"""--legacy says what its defects cost a run, by their effect over the run and not by a step.

usage: check_legacy_cost.py KJOINT      (needs numpy and h5py; exit 1 and a line at the first failure)

The decks, with what is right (Euler equations, integrated by DOP853):
ballspring3  ball joint, equal springs, three inertias: 8 rad/s at 1 s, legacy is 1.45 off, energy +2.2 %
prodin       body with products of inertia on a ball joint: legacy is 1.9 of 12 rad/s off, energy +4.9 %
lightweld    two light bodies welded, 72 rad/s, 8.5e-4 rad a step: 44 rad/s off, energy +3.2 %
spin1, spin3 an arm driven at 1.5 rad/s in steps of 1e-3 s, 8000 of them: its tip at 1.2 m. With one
             secondary node the radius shrinks by (1.5e-3)^2/2 a step, 0.9 %; with three it grows by
             (1.5e-3)^4/8 a step, 5e-9.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

FOLDER = pathlib.Path(__file__).parent / "legacy_cost"
SPIN, NODES, SUMS = "KJ-9206", "KJ-9211", "KJ-9212"


def run(kjoint, deck, *words):
    done = subprocess.run([kjoint, "run", "--json", FOLDER / f"{deck}_0000.rad", *words],
                          capture_output=True, text=True, check=False)
    return json.loads(done.stdout)


def costs(result):
    """Message of each warning of a cost, by its id."""
    return {f["id"]: f["message"] for f in result["findings"] if f["id"] in (SPIN, NODES, SUMS)}


def first_number(pattern, text):
    return float(re.search(pattern, text)[1])


def near(value, wanted, tolerance, what):
    if not abs(value - wanted) <= tolerance:
        sys.exit(f"{what}: {value}, wanted {wanted} +- {tolerance}")


def same(value, wanted, what):
    if value != wanted:
        sys.exit(f"{what}: {value}, wanted {wanted}")


def main(kjoint):
    kjoint = pathlib.Path(kjoint).resolve()
    with tempfile.TemporaryDirectory() as name:
        out = ["-o", pathlib.Path(name, "x.h5")]
        for deck, ids in (("ballspring3", {SPIN, SUMS}), ("prodin", {SPIN}), ("lightweld", {SPIN}),
                          ("spin1", {NODES}), ("spin3", set())):
            result = run(kjoint, deck, "--legacy", *out)
            found = costs(result)
            same(set(found), ids, f"{deck}: warnings")
            if SPIN in ids:
                # nothing else brings energy: the warning accounts for what the ledger shows
                near(first_number(r"by (-?[0-9.]+) %", found[SPIN]), 100*result["energy_error"], 0.3,
                     f"{deck}: energy brought by the spin")
            if NODES in ids:
                near(first_number(r"now ([0-9.]+) %", found[NODES]), 100*8000*1.5e-3**2/2, 0.01,
                     f"{deck}: drift")
                same("nearer to" in found[NODES], True, f"{deck}: inward")
            if SUMS in ids:
                same(first_number(r"up to ([0-9.]+) rad", found[SUMS]) > 0.1, True, f"{deck}: sums")
            same(costs(run(kjoint, deck, *out)), {}, f"{deck}: consistent has none")
        # the cost of the spin falls with the step, and the warning with it
        small = costs(run(kjoint, "ballspring3", "--legacy", "--dt-scale", "0.02", *out))
        same(set(small), {SUMS}, "ballspring3 with a step 45 times shorter: only the sums are left")
        short = costs(run(kjoint, "lightweld", "--legacy", "--until", "0.2", *out))
        same(short, {}, "a tenth of lightweld costs a hundredth of an attitude")
    print("what defects cost is said")


if __name__ == "__main__":
    main(sys.argv[1]) if len(sys.argv) == 2 else sys.exit(__doc__)
