#!/usr/bin/env python3
"""The arm of a dummy (decks/full): what its comments claim of mass, centre and motion.

usage: check_arm.py KJOINT"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import h5py

DECK = pathlib.Path(__file__).parents[2] / "decks" / "full" / "dummy_arm_0000.rad"
# three bricks of 0.04 x 0.04 x 0.08 m and a shell of 0.08 x 0.04 x 0.005 m, 1100 kg/m^3
BRICKS, HAND = 3*1100*0.04*0.04*0.08, 1100*0.08*0.04*0.005
MASS, CENTRE = BRICKS + HAND, (BRICKS*0.12 + HAND*0.28)/(BRICKS + HAND)


def turning_point():
    """Root of m g c sin a = 1/2 k (a - 1.2)^2 above the stop, by halving."""
    low, high = 1.2, 1.6
    for _ in range(60):
        a = 0.5*(low + high)
        if MASS*9.81*CENTRE*math.sin(a) > 0.5*50*(a - 1.2)**2:
            low = a
        else:
            high = a
    return low


def main(kjoint):
    with tempfile.TemporaryDirectory() as work:
        mech, history = pathlib.Path(work, "mech_0000.rad"), pathlib.Path(work, "arm.h5")
        told = subprocess.run([kjoint, "extract", DECK, "-o", mech, "--json"], capture_output=True, text=True,
                              check=True)
        report = json.loads(told.stdout)
        forearm = next(b for b in report["bodies"] if b["name"] == "forearm")
        assert abs(forearm["mass"] - MASS) < 1e-12, forearm
        assert abs(forearm["centre"][0] - CENTRE) < 1e-12, forearm
        assert report["groups"] == 1 and report["kept"]["joints"] == 1, report["kept"]
        assert [a["bodies"] for a in report["acts"]] == [[1, 2]], report["acts"]
        assert [f["id"] for f in report["findings"] if f["severity"] != "note"] == ["KJ-9426"], report["findings"]
        subprocess.run([kjoint, "run", DECK, "--mechanism", "-q", "-o", history], check=True)
        with h5py.File(history) as file:
            most = file["joint/rotation"][:, 0, 0].max()
        assert abs(most - turning_point()) < 1e-3, (most, turning_point())
        own = subprocess.run([kjoint, "extract", DECK, "-o", DECK], capture_output=True, check=False)
        assert own.returncode == 2 and DECK.read_text().startswith("#RADIOSS"), own


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 2 else __doc__)
