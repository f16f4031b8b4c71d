#!/usr/bin/env python3
"""`kjoint study` as a user runs it.

usage: test_study.py KJOINT DECK_FOLDER WORK_FOLDER
"""
import csv
import json
import pathlib
import subprocess
import sys


def study(kjoint, work, *arguments):
    return subprocess.run([kjoint, "study", *arguments], cwd=work, capture_output=True, text=True, timeout=1200)


def main(kjoint, decks, work):
    work = pathlib.Path(work)
    work.mkdir(parents=True, exist_ok=True)
    deck = str(pathlib.Path(decks) / "revolute_pendulum_0000.rad")

    done = study(kjoint, work, deck, "--until", "0.2", "--error", "1e-4", "--stiffness", "0.1")
    assert done.returncode == 0, done.stderr
    table = json.loads((work / "revolute_pendulum_study.json").read_text())
    rows = list(csv.DictReader((work / "revolute_pendulum_study.csv").read_text().splitlines()))
    # three integrators at four steps, rkmk4 at two, one softer Kn, compliant twice, and what was foretold
    assert 3 * 4 + 2 + 1 + 2 <= len(table["settings"]) == len(rows) <= 3 * 4 + 2 + 1 + 2 + 2
    for setting, row in zip(table["settings"], rows):
        assert setting["integrator"] == row["integrator"]
        assert setting["good"] and row["good"] == "1", setting
        assert abs(float(row["error"]) - setting["error"]) <= 1e-6 * setting["error"]
        assert setting["cycles"] > 0 and setting["cpu_s"] > 0 and setting["violation_trans"] > 0

    # Kn, 4 Kn and 16 Kn agree on ideal joints; compliant, which has them, is as near as it wants to be
    assert table["extrapolated"] and table["error_of_extrapolation"] < 0.1*table["error_of_joints"], table
    ideal = [s for s in table["settings"] if s["ideal_joints"]]
    assert len(ideal) == 2 and all(s["error"] < 0.2*table["error_of_joints"] for s in ideal), ideal
    # at Kn joints rule; a tenth of Kn gives way ten times as far
    settings = {s["name"]: s for s in table["settings"]}
    for name, share in (("split2 0.9", 1), ("split2 0.9, Kn x 0.1", 10)):
        part = settings[name]["error_of_joints"]/table["error_of_joints"]
        assert abs(part/share - 1) < 0.05, (name, part)
        assert abs(settings[name]["error"]/settings[name]["error_of_joints"] - 1) < 0.1, settings[name]
    assert settings["split2 0.9"]["error_of_steps"] < 1e-3*settings["split2 0.9"]["error"]

    # second order for split2, and the softer joint has about ten times the gap
    assert abs(table["orders"]["split2"] - 2.0) < 0.15, table["orders"]
    soft, plain = settings["split2 0.9, Kn x 0.1"], settings["split2 0.9"]
    assert 5 < soft["violation_trans"] / plain["violation_trans"] < 20

    # the one recommendation is the cheapest setting within the wanted error, and runs
    fit = [s for s in table["settings"] if max(s["error"], s["energy_error"]) <= 1e-4]
    best = table["settings"][table["recommended"] - 1]
    assert best in fit and best["cpu_s"] <= 1.25 * min(s["cpu_s"] for s in fit)
    assert done.stdout.count("For an error of 1.0E-04: kjoint run") == 1, done.stdout
    words = table["recommendation"].split(": kjoint ", 1)[1].split("  (")[0].split()
    run = subprocess.run([kjoint, *words, "-q", "--until", "0.2", "-o", str(work / "run.h5")],
                         capture_output=True, text=True, timeout=1200)
    assert run.returncode == 0, run.stderr

    # what nothing beats: falling errors over rising cost, and none of the others between
    front = sorted((s for s in table["settings"] if s["unbeaten"]), key=lambda s: s["cpu_s"])
    assert all(a["error"] > b["error"] for a, b in zip(front, front[1:]))
    for s in table["settings"]:
        assert s["unbeaten"] or any(f["cpu_s"] < s["cpu_s"] and f["error"] <= s["error"] for f in front), s
    assert [row["unbeaten"] == "1" for row in rows] == [s["unbeaten"] for s in table["settings"]]

    # two at a time give the same errors
    again = study(kjoint, work, deck, "--until", "0.2", "--stiffness", "0.1", "--threads", "2", "--json", "-o", "two")
    assert again.returncode == 0, again.stderr
    two = json.loads(again.stdout)
    assert two["exit_code"] == 0
    assert [s["error"] for s in two["settings"]][:15] == [s["error"] for s in table["settings"]][:15]
    assert (work / "two.json").exists() and (work / "two.csv").exists()

    # four threads that read the same deck again and again
    for _ in range(8):
        short = study(kjoint, work, deck, "--until", "1e-3", "--sample", "1e-4", "--threads", "4", "--json", "-o", "four")
        assert all(s["good"] for s in json.loads(short.stdout)["settings"]), short.stdout

    # a free body: /DTIX rules its step, and there is no stiffness to scale
    free = str(pathlib.Path(decks).parent / "tests" / "benchmarks" / "DZHA01" / "DZHA01_0000.rad")
    done = study(kjoint, work, free, "--until", "4", "--scales", "1,0.5,0.25")
    assert done.returncode == 0, done.stderr
    table = json.loads((work / "DZHA01_study.json").read_text())
    assert len(table["settings"]) == 3 * 3 + 2 + 2
    assert not table["extrapolated"] and table["error_of_joints"] == 0
    assert abs(table["orders"]["split2"] - 2.0) < 0.15 and abs(table["orders"]["legacy"] - 1.0) < 0.15
    assert "/DTIX" in table["recommendation"]

    for wrong in (["--scales", "0.1,0.9"], ["--scales", "0.9,x"], ["--stiffness", "-1"], ["--error", "0"]):
        assert study(kjoint, work, deck, *wrong).returncode == 2, wrong
    assert study(kjoint, work, "nothing_0000.rad").returncode == 3
    assert study(kjoint, work, deck, "-o", "no_such_folder/table", "--until", "0.01").returncode == 3
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) == 4 else __doc__)
