#!/usr/bin/env python3
"""Check what `kjoint diff` and `kjoint convert` give other programs: JSON, JUnit, HDF5, exit codes.

usage: check_reports.py KJOINT      (needs numpy and h5py; exit 1 and a line at the first failure)
"""
import gzip
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import h5py
import numpy as np

from t01_writer import GLOBALS, write_t01

N, CHANGED_ROW = 50, 20


class Failure(Exception):
    """A claim that does not hold."""


def claim(condition, text):
    if not condition:
        raise Failure(text)


def make_files(folder):
    """A history, the same with one number changed by 1e-5 of its peak, the same packed."""
    time = np.linspace(0, 1, N)
    columns = {code: (1 + code) * np.cos(time) for code in GLOBALS}
    write_t01(folder / "AT01", time, columns)
    columns[4] = columns[4].copy()
    columns[4][CHANGED_ROW] += 1e-5 * 5
    write_t01(folder / "BT01", time, columns)
    (folder / "AT01.gz").write_bytes(gzip.compress((folder / "AT01").read_bytes()))
    return time


def run(kjoint, folder, *words):
    done = subprocess.run([kjoint, *words], cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def check_verdicts(kjoint, folder):
    for run_file, code, begin in (("AT01", 0, "SAME: 10 channels"),
                                  ("AT01.gz", 0, "SAME: 10 channels"),
                                  ("BT01", 1, "DIFFERENT: 1 of 10 channels, worst momentum_y ")):
        status, out, _ = run(kjoint, folder, "diff", "AT01", run_file)
        last = out.rstrip("\n").split("\n")[-1]
        claim(status == code, f"diff AT01 {run_file}: exit {status}, not {code}")
        claim(last.startswith(begin), f"diff AT01 {run_file}: last line {last!r}")
    claim(run(kjoint, folder, "diff", "AT01", "missing")[0] == 3, "a missing file is exit 3")
    claim(run(kjoint, folder, "diff", "AT01", "AT01", "--profile", "no")[0] == 2,
          "a profile that does not exist is exit 2")
    (folder / "text").write_text("no time history\n", encoding="utf-8")
    claim(run(kjoint, folder, "diff", "AT01", "text")[0] == 3, "a text is exit 3")


def check_json(kjoint, folder, time):
    status, out, _ = run(kjoint, folder, "diff", "AT01", "BT01", "--json", "--metrics", "max,nrmse")
    result = json.loads(out)
    claim(status == 1 and result["verdict"] == "DIFFERENT", "json: verdict")
    claim(result["channels"] == 10 and result["different"] == 1, "json: counts")
    claim(result["samples_compared"] == N, "json: samples")
    channel = {c["name"]: c for c in result["channel"]}["momentum_y"]
    claim(channel["different"] and channel["beyond"] == 1, "json: the channel that differs")
    claim(abs(channel["difference"] - 5e-5) < 1e-15, "json: the difference")
    claim(channel["time"] == time[CHANGED_ROW], "json: its time")
    claim(abs(channel["metrics"]["max"][0] - 5e-5) < 1e-15, "json: max")
    expected = 5e-5 / np.sqrt(N) / (5 - 5 * np.cos(1))
    claim(abs(channel["metrics"]["nrmse"][0] / expected - 1) < 1e-9, "json: nrmse")


def check_junit(kjoint, folder):
    run(kjoint, folder, "diff", "AT01", "BT01", "--junit", "result.xml")
    suite = ElementTree.parse(folder / "result.xml").getroot()
    claim(suite.tag == "testsuite", "junit: the root")
    claim(suite.get("tests") == "10" and suite.get("failures") == "1", "junit: counts")
    failed = [case.get("name") for case in suite if case.find("failure") is not None]
    claim(failed == ["momentum_y"], f"junit: failed {failed}")


def check_convert(kjoint, folder, time):
    status, _, err = run(kjoint, folder, "convert", "AT01", "-o", "A.h5")
    claim(status == 0, f"convert: exit {status} {err}")
    with h5py.File(folder / "A.h5", "r") as file:
        claim(np.array_equal(file["time"][:], time), "convert: time")
        for code, name in GLOBALS.items():
            claim(np.array_equal(file[name][:], (1 + code) * np.cos(time)), f"convert: {name}")
    # the steps of this file are 8 cos t
    info = run(kjoint, folder, "info", "A.h5")[1]
    steps = re.search(r"steps +(\S+) to (\S+)", info)
    claim(steps and abs(float(steps[1]) - 8 * np.cos(1)) < 1e-4 and float(steps[2]) == 8, f"info: {info}")
    # from a machine of the other byte order
    columns = {code: (1 + code) * np.cos(time) for code in GLOBALS}
    write_t01(folder / "OT01", time, columns, ">")
    status, out, _ = run(kjoint, folder, "diff", "AT01", "OT01", "--profile", "exact")
    claim(status == 0, f"diff of two byte orders: {out}")
    status, out, _ = run(kjoint, folder, "diff", "AT01", "A.h5", "--profile", "exact")
    claim(status == 0, f"diff of a file with its conversion: {out}")


def check_what_is_compared(kjoint, folder, time):
    """SAME is not said of what was not compared without saying so, and not at all under --strict."""
    some = {2: np.cos(time), 6: np.full(N, 3.0)}
    with_hole = {2: np.where(np.arange(N) == 7, np.nan, some[2]), 6: some[6]}
    empty = {2: np.full(N, np.nan)}
    unknown = {**some, 13: np.sin(time)}                   # CE_ELAST: no channel of ours
    for name, columns in (("some", some), ("time", {}), ("hole", with_hole), ("empty", empty),
                          ("unknown", unknown)):
        write_t01(folder / f"{name}T01", time, columns)
    nothing, open_end = "NO NUMBER BUT THE TIME IS COMPARED", "not all of REF is compared"
    # reference, run, exit code, exit code under --strict, words, numbers beside the times
    for ref, tried, code, strict, words, numbers in (
            ("some", "some", 0, 0, "SAME: 3 channels", 2*N),
            ("time", "time", 0, 1, nothing, 0),
            ("time", "some", 0, 1, nothing, 0),
            ("some", "time", 1, 1, "missing in RUN", 0),
            ("empty", "empty", 0, 1, nothing, 0),
            ("hole", "hole", 0, 1, open_end, 2*N - 1),
            ("some", "hole", 1, 1, "not a number on one side", 2*N),
            ("hole", "some", 1, 1, "not a number on one side", 2*N),
            ("unknown", "unknown", 0, 1, open_end, 2*N),
            ("some", "unknown", 0, 1, "SAME: 3 channels", 2*N),
            ("empty", "some", 1, 1, "not a number on one side", N)):
        status, out, _ = run(kjoint, folder, "diff", f"{ref}T01", f"{tried}T01")
        claim(status == code and words in out, f"diff {ref} {tried}: exit {status}: {out}")
        status, out, _ = run(kjoint, folder, "diff", f"{ref}T01", f"{tried}T01", "--strict")
        claim(status == strict, f"diff {ref} {tried} --strict: exit {status}: {out}")
        claim(out.splitlines()[-1].startswith("DIFFERENT" if strict else "SAME"),
              f"diff {ref} {tried} --strict: {out}")
        result = json.loads(run(kjoint, folder, "diff", f"{ref}T01", f"{tried}T01", "--json")[1])
        claim(result["numbers"] == numbers, f"diff {ref} {tried}: {result['numbers']} numbers")
    out = run(kjoint, folder, "diff", "someT01", "unknownT01")[1]
    claim("in RUN alone: CE_ELAST" in out, f"what RUN alone has: {out}")
    out = run(kjoint, folder, "diff", "holeT01", "holeT01")[1]
    claim("both sides, at times or always: kinetic_energy_trans" in out, f"holes: {out}")


def check_text(kjoint, folder):
    """Text T01 (/TFILE type 3) of several versions, which say no units. plainT01 is made by hand: a
    first record of an integer in 5 columns and 72 characters, and its first line a second time."""
    first, *rest = (pathlib.Path(__file__).parent / "plainT01").read_text().splitlines(True)
    old, title = " 3040block", "block on a rope"
    claim(rest[1].startswith(old) and rest[2] == first, "text: the file is the one that is meant")
    wide = f"{3040:10d}{title:80}\n"
    forms = {"plain": rest,                                    # I5 and 72, the line twice
             "once": rest[:2] + rest[3:],                      # I5 and 72
             "wide": [rest[0], wide] + rest[2:],               # I10 and 80, announced as 72
             "old": [rest[0].replace("72", "80"), wide] + rest[3:],
             "stripped": [line.rstrip() + "\n" for line in rest]}
    for name, lines in forms.items():
        (folder / f"{name}T01").write_text("".join([first, *lines]))
        status, _, err = run(kjoint, folder, "convert", f"{name}T01", "-o", "text.h5")
        claim(status == 0, f"text {name}: exit {status} {err}")
        with h5py.File(folder / "text.h5", "r") as file:
            claim(file.attrs["title"] == title, f"text {name}: title")
            # as the file has it: at 0.1 the momentum is 3 and the mass 4, at 0.2 twice and 4
            claim(np.array_equal(file["time"][:], [0.0, 0.1, 0.2]), f"text {name}: time")
            claim(np.array_equal(file["momentum_z"][:], [0.0, 3.0, 6.0]), f"text {name}: momentum")
            claim(file["momentum_z"].attrs["units"] == "mass length time-1", f"text {name}: unit")
        claim("not known" in run(kjoint, folder, "info", "text.h5")[1], f"text {name}: units in info")
    (folder / "brokenT01").write_text("".join([first, *rest]).replace("ZZZZZEOR   12I", first, 1))
    claim(run(kjoint, folder, "convert", "brokenT01")[0] == 3, "text: a damaged file")


def main(kjoint):
    kjoint = pathlib.Path(kjoint).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        time = make_files(folder)
        try:
            check_verdicts(kjoint, folder)
            check_json(kjoint, folder, time)
            check_junit(kjoint, folder)
            check_convert(kjoint, folder, time)
            check_what_is_compared(kjoint, folder, time)
            check_text(kjoint, folder)
        except Failure as failure:
            print(f"{sys.argv[0]}: {failure}")
            return 1
    print("reports are as agreed")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]) if len(sys.argv) == 2 else __doc__)
