"""What a position costs: split2 and compliant on mechanisms, against rigid joints in fine steps.

For each scene and integrator the cheapest run is looked for whose largest error of the positions of
bodies, over the largest way of a body, is below 1e-3 and 1e-5: split2 over the stiffness of joints
(its error is that of the compliance), compliant with --kn inf over --error. Time is the least of the
rounds that the solver took.
"""
import json
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "accuracy"))
import compliant_scenes as scenes

TARGETS = (1e-3, 1e-5)
SCENES = {"bricard": (scenes.bricard, 1.0), "four-bar": (scenes.four_bars, 0.7), "slider-crank": (scenes.slider_crank, 1.0),
          "governor": (scenes.governor, 1.0), "chain of 50": (lambda: scenes.chain(50), 0.3)}
SAMPLES, FINE = 20, 20000
SETTINGS = {"compliant": [["--integrator", "compliant", "--kn", "inf", "--error", f"{10**(-k/2):.2e}"] for k in range(2, 16)],
            "split2": [["--kn-scale", f"{10.0**k:.0e}"] for k in range(-2, 4)]}


def run(kjoint, root, out, words):
    done = subprocess.run([kjoint, "run", f"{root}_0000.rad", "--json", "-o", out, *words], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True, check=False, timeout=600)
    return json.loads(done.stdout) if done.returncode == 0 else None


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
        build().write(root, until, until / SAMPLES)
        run(kjoint, root, out, ["--integrator", "compliant", "--kn", "inf", "--error", "1e3", "--turn", "1e3",
                                "--sample", f"{until/FINE:.12g}"])
        exact = places(out)[::FINE // SAMPLES]
        way = np.linalg.norm(exact - exact[0], axis=2).max()
        for integrator, settings in SETTINGS.items():
            left = list(TARGETS)
            for words in settings:
                told = run(kjoint, root, out, words)
                if told is None or not left:
                    continue
                error = np.linalg.norm(places(out) - exact, axis=2).max() / way
                if error > left[0]:
                    continue
                solve = min(run(kjoint, root, out, words)["wall_solve"] for _ in range(rounds))
                while left and error <= left[0]:
                    rows.append({"scene": name, "integrator": integrator, "target": left.pop(0), "steps": told["cycles"],
                                 "error": error, "ms": 1e3 * solve, "options": " ".join(words)})
    return rows


def table(rows):
    lines = ["| scene | integrator | error wanted | steps | error | ms |", "|---|---|---|---|---|---|"]
    lines += [f"| {r['scene']} | {r['integrator']} | {r['target']:.0e} | {r['steps']} | {r['error']:.1e} | {r['ms']:.2f} |"
              for r in rows]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    print(table(measure(sys.argv[1], pathlib.Path(sys.argv[2]), 3)))
