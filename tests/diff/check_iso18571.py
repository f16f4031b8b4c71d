#!/usr/bin/env python3
"""Compare the ISO/TS 18571 ratings of `kjoint diff` with the package objective-rating-metrics.

usage: check_iso18571.py KJOINT      (exit 1 when they differ, 77 without the package)

Curves: sums of sines with another amplitude, shift and some noise, 12 to 400 samples, so that
shifts, warping bands and windows of every parity occur.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from t01_writer import GLOBALS, write_t01

try:
    from objective_rating_metrics.rating import ISO18571
except ImportError:
    print("objective-rating-metrics is not installed: nothing is compared")
    sys.exit(77)

SEED, ROUNDS, TOLERANCE = 18571, 12, 1e-9
PARTS = {"iso_z": "corridor_rating", "iso_p": "phase_rating", "iso_m": "magnitude_rating",
         "iso_s": "slope_rating", "iso": "overall_rating"}


def make_curves(random, n):
    """A reference and a curve that resembles it."""
    t = np.arange(n) / n
    curve, reference = np.zeros(n), np.zeros(n)
    shift = random.uniform(-0.25, 0.25)
    for _ in range(4):
        amplitude, phase = random.normal(), random.uniform(0, 2 * np.pi)
        frequency = 2 * np.pi * random.uniform(0.5, 5)
        reference += amplitude * np.sin(frequency * t + phase)
        curve += amplitude * random.uniform(0.8, 1.2) * np.sin(frequency * (t + shift) + phase)
    return reference, curve + 0.05 * random.normal(size=n)


def ratings_of_kjoint(kjoint, folder, time, pairs):
    """Metrics of every channel, by name."""
    for side, name in enumerate(("REFT01", "RUNT01")):
        write_t01(folder / name, time, {code: pair[side] for code, pair in pairs.items()})
    text = subprocess.run(
        [kjoint, "diff", "REFT01", "RUNT01", "--metrics", "iso18571", "--json"],
        cwd=folder, stdout=subprocess.PIPE, check=False).stdout
    return {c["name"]: c["metrics"] for c in json.loads(text)["channel"]}


def main(kjoint):
    random = np.random.default_rng(SEED)
    kjoint, worst, n_compared = pathlib.Path(kjoint).resolve(), 0.0, 0
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(ROUNDS):
            n = int(random.choice([random.integers(12, 60), 10 * random.integers(2, 30),
                                   random.integers(60, 400)]))
            time = 1e-4 * np.arange(n)
            pairs = {code: make_curves(random, n) for code in GLOBALS}
            ours = ratings_of_kjoint(kjoint, pathlib.Path(folder), time, pairs)
            for code, (reference, curve) in pairs.items():
                theirs = ISO18571(np.column_stack([time, reference]),
                                  np.column_stack([time, curve]))
                for column, method in PARTS.items():
                    expected = getattr(theirs, method)(-1)
                    found = ours[GLOBALS[code]][column][0]
                    n_compared += 1
                    worst = max(worst, abs(found - expected))
                    if not abs(found - expected) <= TOLERANCE:
                        print(f"n={n} {GLOBALS[code]} {column}: expected {expected} found {found}")
                        return 1
    print(f"{n_compared} ratings agree within {worst:.1e}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
