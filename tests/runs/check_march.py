#!/usr/bin/env python3
"""The march between samples: integrators keep their order, and the step follows the scene however rare samples are.

usage: check_march.py KJOINT      (needs numpy and h5py; exit 1 and a line at the first failure)
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

SOURCE = pathlib.Path(os.environ.get("KJOINT_SOURCE_DIR", pathlib.Path(__file__).parents[2]))
BENCHMARKS = SOURCE / "tests" / "benchmarks"


class Runner:
    def __init__(self, kjoint, folder):
        self.kjoint, self.folder = pathlib.Path(kjoint).resolve(), pathlib.Path(folder)

    def __call__(self, deck, channel, *words):
        """Last value of a channel, and what the run says"""
        out = self.folder / "x.h5"
        done = subprocess.run([self.kjoint, "run", "--json", deck, "-o", out, *map(str, words)],
                              capture_output=True, text=True, check=False)
        with h5py.File(out) as file:
            return file[channel][-1].ravel(), json.loads(done.stdout)


def fourth_order(run):
    """A body free of forces, inertias 1 2 3 (Dzhanibekov): half the step is a sixteenth of the error, but for
    what is left of higher orders; third order would give an eighth. Steps of 1e-3 s are exact to rounding beside."""
    deck = BENCHMARKS / "DZHA01" / "DZHA01_0000.rad"
    words = ["--integrator", "rkmk4", "--until", 4, "--sample", 4, "--dt-max-scale"]
    exact, _ = run(deck, "rigid_body/orientation", *words, 1)
    coarse, fine = (np.abs(run(deck, "rigid_body/orientation", *words, scale)[0] - exact).max() for scale in (100, 50))
    if not (12 < coarse/fine < 20 and coarse < 5e-8):
        sys.exit(f"rkmk4: errors {coarse}, {fine} are not of fourth order")



def rare_samples(run):
    """Two bodies slide apart by 10 m, turning: the lever of the blocked forces, and the stiffness they see, grows with
    the square of the distance, so the step must halve. With one sample, at the end, it does as with many; steps of the
    start would blow up."""
    deck = SOURCE / "tests" / "runs" / "telescope_0000.rad"
    many, _ = run(deck, "rigid_body/position", "--until", 0.1, "--sample", 0.002)
    one, said = run(deck, "rigid_body/position", "--until", 0.1, "--sample", 0.1)
    if said["exit_code"] != 0 or not abs(said["energy_error"]) < 1e-7:
        sys.exit(f"one sample: {said['status']}, energy error {said['energy_error']}")
    if not np.abs(one - many).max() < 1e-6:
        sys.exit(f"one sample: the end is {np.abs(one - many).max()} m from that of many")


def main(kjoint):
    with tempfile.TemporaryDirectory() as folder:
        run = Runner(kjoint, folder)
        fourth_order(run)
        rare_samples(run)
    print("the march holds between samples")


if __name__ == "__main__":
    main(sys.argv[1]) if len(sys.argv) == 2 else sys.exit(__doc__)
