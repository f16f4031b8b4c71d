#!/usr/bin/env python3
"""Measure what docs/accuracy.md claims: writes its tables and plots anew.

usage: accuracy_report.py [BUILD]      BUILD: folder of the build with its tests; default build/release

Runs the benchmarks at the default step, bisects the steps at which they blow up, and studies the
trade of the decks in STUDIES. Takes some minutes. Needs h5py, numpy and matplotlib, as in
build/venv/bin/python after tools/test.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "accuracy"))
import compare_benchmark  # noqa: E402
import h5py  # noqa: E402

PAGE = ROOT / "docs" / "accuracy.md"
BENCHMARKS = ROOT / "tests" / "benchmarks"
STUDIES = {"slider_crank": ROOT / "decks" / "slider_crank_0000.rad",
           "universal_shaft": ROOT / "decks" / "universal_shaft_0000.rad",
           "heavy_top": BENCHMARKS / "HTOP02" / "HTOP02_0000.rad"}


class Program:
    """The programs of a build, run in a folder of their own."""

    def __init__(self, build, work):
        self.kjoint, self.tests = build / "kjoint", build / "tests" / "accuracy_tests"
        self.work = work

    def run(self, *words):
        words = [str(word) for word in words]
        print("  ", *words[1:], flush=True)
        done = subprocess.run(words, cwd=self.work, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{' '.join(words)}: exit {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout


def table(head, rows):
    """Markdown; all columns but the first to the right."""
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def number(value):
    """Two digits: 2.4e-5"""
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def about_row(case, name):
    """First column of a row in the table of about.md: OpenRadioss at its default step."""
    text = (BENCHMARKS / case / "about.md").read_text(encoding="utf-8")
    return re.search(rf"^\| {name} \| *([0-9.e+-]+) \|", text, re.M)[1]


def benchmarks(program, limits):
    rows = []
    for case in sorted(limits):
        deck, history = BENCHMARKS / case / f"{case}_0000.rad", program.work / f"{case}.h5"
        program.run(program.kjoint, "run", "-q", deck, "-o", history)
        worst = compare_benchmark.errors_of(BENCHMARKS / case / "reference.csv", history)
        legacy = compare_benchmark.legacy_figures(BENCHMARKS / case / "about.md")
        share = max(worst[name] / limit for name, limit in limits[case].items())
        gain = min(legacy[name] / worst[name] for name in limits[case] if name in legacy)
        with h5py.File(history) as file:
            cycles = int(file["cycle"][-1])
        title = (BENCHMARKS / case / "about.md").read_text(encoding="utf-8").split("\n")[0].split(" - ")[1]
        rows.append([f"{case}: {title}", cycles, about_row(case, "cycles"), number(worst["node/position"]),
                     number(legacy["node/position"]), f"{gain:.3g}", f"{share:.2f}"])
    return table(["case", "cycles", "OpenRadioss", "position [m]", "OpenRadioss", "least gain", "worst over limit"],
                 rows)


def limits_of_steps(program, limits):
    rows = []
    for case in sorted(limits):
        deck = BENCHMARKS / case / f"{case}_0000.rad"
        scene = json.loads(program.run(program.kjoint, "check", "--json", deck))
        if not scene["joints"]:
            continue
        found = program.run(program.tests, "limit", BENCHMARKS, case)
        true = float(re.search(r"true limit over the bound +([0-9.E+-]+)", found)[1]) * scene["safe_step"]
        rows.append([case, *(f"{scene[name]:.3e}" for name in ("nodal_step", "safe_step", "exact_step")),
                     f"{true:.3e}", f"{0.9 * scene['safe_step'] / true:.2f}"])
    return table(["case", "nodal [s]", "safe", "exact", "run blows up", "default step over that"], rows)


def ledger(program):
    found = re.findall(r"(\w+)-like: S at the default step +(\S+).*\n.*order of S +(\S+)",
                       program.run(program.tests, "ledger"))
    return table(["deck like", "largest change of S", "order in the step"],
                 [[name, number(float(value)), f"{float(order):.2f}"] for name, value, order in found])


def study(program, name, deck):
    program.run(program.kjoint, "study", deck, "--threads", 2, "-o", name, "-q")
    plot = ROOT / "docs" / "img" / f"study_{name}.png"
    program.run(sys.executable, ROOT / "tools" / "plot_study.py", f"{name}.json", "-o", plot)
    found = json.loads((program.work / f"{name}.json").read_text(encoding="utf-8"))
    rows, seen = [], {}
    for one in found["settings"]:
        scheme = one["integrator"] + (f", Kn x {one['kn_scale']:g}" if one["kn_scale"] != 1 else "")
        seen[scheme] = seen.get(scheme, 0) + 1
        if scheme in ("liemid", "rkmk4") and seen[scheme] > 1 or scheme == "legacy" and seen[scheme] in (2, 3):
            continue
        cells = [one["name"]]
        if one["good"]:
            cells += [one["cycles"], f"{one['cpu_s']:.3f}", number(one["error"]),
                      number(one["error_of_steps"]), number(one["error_of_joints"]),
                      number(max(one["error_velocity"], one["error_angular_velocity"])),
                      number(max(one["error_force"], one["error_moment"])), number(one["energy_error"]),
                      number(one["violation_trans"])]
        rows.append(cells + ["failed"] * (10 - len(cells)))
    orders = ", ".join(f"{scheme} {order:.2f}" for scheme, order in found["orders"].items() if order)
    advice = found["recommendation"].split("\n")[0].replace(str(deck), deck.name)
    return (f"![{found['title']}: error over cost, and over the step](img/{plot.name})\n\n" +
            table(["setting", "cycles", "time [s]", "error", "of steps", "of joints", "velocities", "forces", "energy",
                   "gap [m]"], rows) + f"\n\nOrder in the step: {orders}. {advice}.")


def put(page, name, text):
    """Replace what stands between the marks of a name."""
    mark = re.compile(rf"(<!-- begin {name} -->\n).*?(<!-- end {name} -->)", re.S)
    if not mark.search(page):
        sys.exit(f"{PAGE}: no marks of {name}")
    return mark.sub(lambda found: found[1] + text + "\n" + found[2], page)


def main():
    if len(sys.argv) > 2 or sys.argv[1:] and sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    build = (pathlib.Path(sys.argv[1]) if len(sys.argv) == 2 else ROOT / "build" / "release").resolve()
    limits = json.loads((BENCHMARKS / "limits.json").read_text(encoding="utf-8"))
    limits.pop("_about")
    page = PAGE.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as work:
        program = Program(build, pathlib.Path(work))
        page = put(page, "benchmarks", benchmarks(program, limits))
        page = put(page, "limits", limits_of_steps(program, limits))
        page = put(page, "ledger", ledger(program))
        for name, deck in STUDIES.items():
            page = put(page, name, study(program, name, deck))
    PAGE.write_text(page, encoding="utf-8")
    print(PAGE)


if __name__ == "__main__":
    main()
