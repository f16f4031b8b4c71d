#!/usr/bin/env python3
"""Full decks against OpenRadioss: bodies of `kjoint extract`, and the motion of `run --mechanism`.

usage: run_full.py KJOINT FOLDER [CASE ...]      (exit 1 where a case fails)

A case is FOLDER/NAME with NAME_0000.rad, NAME_0001.rad, body.csv, perhaps NAMET01. Mass, centre (over
the size of the deck) and principal inertia agree within 1e-9, or the digits that body.csv has; with a
T01 the history under --legacy is the same within the parity profile of `kjoint diff`; the extract runs
to the bits of --mechanism. body.csv: mass, centre, principal inertia as the starter of OpenRadioss lists
them."""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np


def call(*words):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=600, check=False)


def limit(digits):
    return max(1.0e-9, 0.6*10.0**(1 - int(digits)))


def compare_bodies(folder, report):
    """Largest differences of mass, centre and principal inertia, each over its limit."""
    worst = [0.0, 0.0, 0.0]
    bodies = {b["id"]: b for b in report["bodies"]}
    rows = list(csv.DictReader((folder / "body.csv").open()))
    size = max([1.0] + [abs(float(r[c])) for r in rows for c in "xyz"])
    for row in rows:
        body = bodies[int(row["id"])]
        worst[0] = max(worst[0], abs(body["mass"]/float(row["mass"]) - 1)/limit(row["mass_digits"]))
        centre = [float(row[c]) for c in "xyz"]
        off = max(abs(a - b) for a, b in zip(body["centre"], centre))/size
        worst[1] = max(worst[1], off/limit(row["xyz_digits"]))
        inertia = sorted((float(row[f"I{i}"]) for i in (1, 2, 3)), reverse=True)
        mine = sorted(body["principal"], reverse=True)
        worst[2] = max(worst[2], max(abs(a/b - 1) for a, b in zip(mine, inertia))/1.0e-9)
    return worst


def same_bits(a, b):
    equal = True
    with h5py.File(a) as x, h5py.File(b) as y:
        def visit(name, thing):
            nonlocal equal
            if isinstance(thing, h5py.Dataset) and not name.startswith("input") and thing.dtype.kind == "f":
                equal = equal and name in y and np.array_equal(thing[...], y[name][...], equal_nan=True)
        x.visititems(visit)
    return equal


def run_case(kjoint, folder, work):
    """A line about the case, and whether it is right."""
    name = folder.name
    deck, mech = folder / f"{name}_0000.rad", work / f"{name}_m_0000.rad"
    done = call(kjoint, "extract", deck, "-o", mech, "--json")
    try:
        report = json.loads(done.stdout)
    except json.JSONDecodeError:
        return f"{name:20} no JSON: {done.stderr[-300:]}", False
    line, right = f"{name:20} ", True
    if "bodies" in report and (folder / "body.csv").exists():
        worst = compare_bodies(folder, report)
        right = max(worst) <= 1.0
        line += "mass, centre, inertia over their limits {:7.1e} {:7.1e} {:7.1e} ".format(*worst)
    if report["exit_code"] != 0:
        errors = [f"{f['id']} {f['message']}" for f in report["findings"] if f["severity"] == "error"]
        return line + f"rc {report['exit_code']}: {'; '.join(errors)[:160]}", False
    a, b = work / "a.h5", work / "b.h5"
    first = call(kjoint, "run", deck, "--mechanism", "--legacy", "-q", "--reproducible", "-o", a)
    second = call(kjoint, "run", mech, "--legacy", "-q", "--reproducible", "-o", b)
    if first.returncode or second.returncode:
        return line + f"run rc {first.returncode} {second.returncode}: {(first.stderr + second.stderr)[:300]}", False
    bits = same_bits(a, b)
    line += "bits equal " if bits else "BITS DIFFER "
    if (folder / f"{name}T01").exists():
        verdict = call(kjoint, "diff", folder / f"{name}T01", a, "--profile", "parity", "--json")
        line += f"T01 {json.loads(verdict.stdout)['summary'][:100]}"
        right = right and verdict.returncode == 0
    return line, right and bits


def main(kjoint, folder, *names):
    kjoint, folder = pathlib.Path(kjoint).resolve(), pathlib.Path(folder)
    names = names or sorted(p.parent.name for p in folder.glob("*/*_0000.rad"))
    wrong = 0
    with tempfile.TemporaryDirectory() as work:
        for name in names:
            line, right = run_case(kjoint, folder / name, pathlib.Path(work))
            print("ok    " if right else "FAIL  ", line, flush=True)
            wrong += not right
    return wrong > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]) if len(sys.argv) > 2 else __doc__)
