#!/usr/bin/env python3
"""A four-bar linkage in ten lines: crank, coupler and rocker fall under gravity.

usage: four_bar.py [PICTURE.png]     PYTHONPATH: PREFIX/lib/kjoint/python
"""
import sys

import numpy as np

from kjoint import Mechanism

linkage = Mechanism("four-bar", gravity=(0, 0, -9.81))
ground = linkage.ground()
crank = linkage.body(0.5, (1e-4, 2e-3, 2e-3), at=(0, 0, 0.1), name="crank")
coupler = linkage.body(1.0, (2e-4, 2e-2, 2e-2), at=(0.2, 0, 0.25), name="coupler")
rocker = linkage.body(0.8, (2e-4, 1e-2, 1e-2), at=(0.4, 0, 0.15), name="rocker")
linkage.joint("revolute", ground, crank, at=(0, 0, 0), axis=(0, 1, 0), kn=1e6)
linkage.joint("spherical", crank, coupler, at=(0, 0, 0.2), kn=1e6)
linkage.joint("universal", coupler, rocker, at=(0.4, 0, 0.3), axis=(0, 1, 0), axis_2=(0, 0, 1), kn=1e6)
linkage.joint("revolute", ground, rocker, at=(0.4, 0, 0), axis=(0, 1, 0), kn=1e6)
run = linkage.model(until=0.5, sample=2e-3)
run.start()
run.set_body_velocity(crank, (0.2, 0, 0), omega=(0, 2, 0))      # a push
while run.status.time < 0.5:
    run.sample()
    run.advance(run.status.time + 2e-3)

# crank and rocker stay on their circles; energy: what the push gave, and gravity
place = run["rigid_body/position"]
radius = np.linalg.norm(place[:, 1], axis=1), np.linalg.norm(place[:, 3] - (0.4, 0, 0), axis=1)
error = max(abs(radius[0] - 0.1).max(), abs(radius[1] - 0.15).max())
balance = abs(run["energy_error"]).max()
print(f"kjoint: {len(place)} samples, circles within {error:.1e} m, energy within {balance:.1e}, "
      f"largest pin force {np.linalg.norm(run['joint/force'], axis=2).max():.1f} N")
if len(sys.argv) > 1:
    try:
        run.plot("rigid_body/position", "joint/force", path=sys.argv[1])
    except ImportError:
        print("matplotlib is not installed: no picture")
sys.exit(error > 1e-4 or balance > 1e-3 or len(place) < 250)
