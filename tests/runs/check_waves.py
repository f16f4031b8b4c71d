#!/usr/bin/env python3
"""Several steps in one pass over the scene give the bits of steps one by one, at any number of threads.

usage: check_waves.py KJOINT WORK_FOLDER

/DTIX holds the step at a power of two that the scene allows, so that times are exact. A run with samples
at that step takes its steps one by one, with samples at eight of them all eight from one sample to the
next: at the times that both have, their values are the same.
"""
import pathlib
import subprocess
import sys

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "tools"))
import bench_scenes

EACH, SAMPLES = 8, 5
SCENES = {"chain": (2600, 2.0**-14), "forest": (2600, 2.0**-14), "grid": (2600, 2.0**-18), "mix": (4000, 2.0**-18)}


def values(path, stride):
    """All channels at every so many samples"""
    found = {}

    def keep(name, item):
        if isinstance(item, h5py.Dataset) and name.split("/")[0] != "run" and item.ndim and \
                item.dtype.kind == "f" and item.shape[0] == stride*(SAMPLES - 1) + 1:
            found[name] = item[::stride]

    with h5py.File(path) as run:
        run.visititems(keep)
        assert numpy.all(run["cycle"][::stride] == EACH*numpy.arange(SAMPLES)), run["cycle"][:]
    return found


def main(kjoint, folder):
    work = pathlib.Path(folder)
    work.mkdir(parents=True, exist_ok=True)
    failed = 0
    for scene, (joints, step) in SCENES.items():
        bench_scenes.write(scene, joints, work / scene, until=(SAMPLES - 1)*EACH*step)
        with open(work / f"{scene}_0001.rad", "a") as engine:
            engine.write(f"/DTIX\n0 {step!r}\n")
        for integrator in ("split2", "liemid"):
            def run(name, sample, threads):
                path = work / f"{scene}_{name}.h5"
                subprocess.run([kjoint, "run", work / f"{scene}_0000.rad", "-q", "-o", path, "--sample", repr(sample),
                                "--threads", str(threads), "--integrator", integrator], check=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                return path

            single = values(run("single", step, 1), EACH)
            for threads in (1, 2, 3):
                wave = values(run("wave", EACH*step, threads), 1)
                other = [name for name in single if not numpy.array_equal(single[name], wave[name], equal_nan=True)]
                ok = not other and len(single) > 20 and numpy.any(single["joint/force"] != 0)
                print(f"{'ok    ' if ok else 'FAIL  '}{scene}, {integrator}, threads {threads}: {len(single)} channels, "
                      f"differ: {other}")
                failed += not ok
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 3 else __doc__)
