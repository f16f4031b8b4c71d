#!/usr/bin/env python3
"""The number of threads does not change a bit of a history.

usage: check_threads.py KJOINT WORK_FOLDER
"""
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "tools"))
import bench_scenes

# 2600 joints: more than two threads get their share (500 joints each)
SCENES = {"chain": 1000, "forest": 2600, "mix": 2600}
RUNS = {"legacy": ["--legacy"], "split2": [], "liemid": ["--integrator", "liemid"]}


def main(kjoint, folder):
    work = pathlib.Path(folder)
    work.mkdir(parents=True, exist_ok=True)
    failed = 0
    for scene, joints in SCENES.items():
        bench_scenes.write(scene, joints, work / scene, until=1e-3, sample=2e-4)
        for name, options in RUNS.items():
            files = []
            for threads in (1, 2, 5):
                files.append(work / f"{scene}_{name}_{threads}.h5")
                subprocess.run([kjoint, "run", work / f"{scene}_0000.rad", "-q", "--reproducible", "--threads",
                                str(threads), "-o", files[-1], *options], check=True, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
            same = len({file.read_bytes() for file in files}) == 1
            print(f"{'ok    ' if same else 'FAIL  '}{scene} of {joints} joints, {name}: 1, 2 and 5 threads")
            failed += not same
    wrong = subprocess.run([kjoint, "run", work / "chain_0000.rad", "--threads", "0"], capture_output=True, check=False)
    print(f"{'ok    ' if wrong.returncode == 2 else 'FAIL  '}--threads 0 is refused")
    return 1 if failed or wrong.returncode != 2 else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 3 else __doc__)
