"""What a position costs: split2, compliant, and MuJoCo and Exudyn where this Python has them, on mechanisms.

The truth is compliant with rigid joints in 20000 steps; the others come to it within 4e-7. For each scene and program the
cheapest run is looked for whose largest error of the positions of bodies, over the largest way of a body, is below 1e-3 and
1e-5: split2 over the stiffness of joints (its error is that of the compliance), compliant with --kn inf over --error, the
others over the step and what bench_mechanisms.py says. Time is the least of the rounds that the steps took: the start, which
builds the model, is left out, as it is of the others.
"""
import importlib.util
import json
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "accuracy"))
import bench_mechanisms as mechanisms
import compliant_scenes as scenes

TARGETS = (1e-3, 1e-5)
SCENES = {"bricard": (scenes.bricard, 1.0), "four-bar": (scenes.four_bars, 0.7), "slider-crank": (scenes.slider_crank, 1.0),
          "governor": (scenes.governor, 1.0), "chain of 50": (lambda: scenes.chain(50), 0.3)}
SAMPLES, FINE, SECONDS = 20, 20000, 60
SETTINGS = {"compliant": [["--integrator", "compliant", "--kn", "inf", "--error", f"{10**(-k/4):.2e}"] for k in range(4, 28)],
            "split2": [["--kn-scale", f"{10.0**k:.0e}"] for k in range(-2, 4)]}


def run(kjoint, root, out, words):
    try:
        done = subprocess.run([kjoint, "run", f"{root}_0000.rad", "--json", "-o", out, *words], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True, check=False, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return None
    return json.loads(done.stdout) if done.returncode == 0 else None


def steps_of(told):
    return told["wall_solve"] - told["wall_start"]


def places(path):
    import h5py
    with h5py.File(path) as file:
        return file["rigid_body/position"][()]


def measure(kjoint, folder, rounds):
    """Rows: scene, integrator, target, steps, error, milliseconds"""
    import numpy as np
    rows = []
    for name, (build, until) in SCENES.items():
        root, out = folder / "precision", folder / "precision.h5"
        scene = build()
        scene.write(root, until, until / SAMPLES)
        run(kjoint, root, out, ["--integrator", "compliant", "--kn", "inf", "--error", "1e3", "--turn", "1e3",
                                "--sample", f"{until/FINE:.12g}"])
        exact = places(out)[::FINE // SAMPLES]
        way = np.linalg.norm(exact - exact[0], axis=2).max()
        for integrator, settings in SETTINGS.items():
            left = list(TARGETS)
            for words in settings:
                if not left:
                    break
                told = run(kjoint, root, out, words)
                if told is None:
                    continue
                error = np.linalg.norm(places(out) - exact, axis=2).max() / way
                if error > left[0]:
                    continue
                solve = steps_of(told)
                for _ in range(rounds if solve < 0.1 else 0):      # a long run is as good as several
                    solve = min(solve, steps_of(run(kjoint, root, out, words)))
                while left and error <= left[0]:
                    rows.append({"scene": name, "integrator": integrator, "target": left.pop(0), "steps": told["cycles"],
                                 "error": error, "ms": 1e3 * solve, "options": " ".join(words)})
        for peer in filter(importlib.util.find_spec, mechanisms.PEERS):
            rows += [{"scene": name, "integrator": peer, **row} for row in measure_peer(peer, scene, until, exact, way, rounds)]
    return rows


def measure_peer(peer, scene, until, exact, way, rounds):
    """The cheapest run below each target"""
    import numpy as np
    best = {}
    for kind in mechanisms.KINDS[peer]:
        left = list(TARGETS)
        for step in mechanisms.STEPS:
            places, _, steps = mechanisms.PEERS[peer](scene, until, SAMPLES, (step, kind))
            error = np.linalg.norm(places - exact, axis=2).max() / way
            if not error <= left[0]:
                continue
            ms = 1e3 * min(mechanisms.PEERS[peer](scene, until, SAMPLES, (step, kind))[1] for _ in range(rounds))
            while left and error <= left[0]:
                target = left.pop(0)
                if target not in best or ms < best[target]["ms"]:
                    best[target] = {"target": target, "steps": steps, "error": error, "ms": ms, "options": str(kind)}
            if not left:
                break
    return [best[t] for t in TARGETS if t in best]


def table(rows):
    lines = ["| scene | integrator | error wanted | steps | error | ms |", "|---|---|---|---|---|---|"]
    lines += [f"| {r['scene']} | {r['integrator']} | {r['target']:.0e} | {r['steps']} | {r['error']:.1e} | {r['ms']:.2f} |"
              for r in rows]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(table(measure(sys.argv[1], pathlib.Path(sys.argv[2]), 3)))
