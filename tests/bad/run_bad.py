#!/usr/bin/env python3
"""Bad decks, and odd ones that are right: every finding, with its id and place.

usage: run_bad.py KJOINT CASES.txt      (a file of cases; see README.md for the language)
       run_bad.py KJOINT keywords       (each keyword that is noted or not supported)

Each case changes the base deck. `kjoint check --json` must give exactly the errors and warnings
that the case expects, `kjoint run --json` the same; no file may be left behind.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
PLACE = re.compile(r"(.*?)(?:\+(-?\d+))?(?::(\d+)(?:-(\d+))?)?$")
RUNTIME = ("Fortran runtime error", "Backtrace for this error", "AddressSanitizer", "runtime error:",
           "Segmentation fault")


class Line:
    """A line that knows where it ends up."""

    def __init__(self, text):
        self.text = text


class Case:
    def __init__(self, name):
        self.name = name
        self.decks = {part: [Line(text) for text in
                             (HERE / f"base_{number}.rad").read_text().splitlines()]
                      for part, number in (("starter", "0000"), ("engine", "0001"))}
        self.files, self.args, self.expected = {}, [], []
        self.sets, self.added = [], []
        self.part, self.target, self.no_deck, self.end = "starter", None, set(), "\n"

    @property
    def lines(self):
        return self.decks[self.part]

    def find(self, anchor, more):
        at = [i for i, line in enumerate(self.lines) if line.text == anchor]
        if len(at) != 1:
            raise SystemExit(f"{self.name}: {len(at)} lines are {anchor!r}")
        return at[0] + int(more or 0)

    def set_field(self, rest):
        place, text = re.split(r" =\s?", rest, maxsplit=1)
        anchor, more, first, last = PLACE.match(place).groups()
        line = self.lines[self.find(anchor, more)]
        first, last = int(first), int(last or first)
        text = "" if text == "~" else unescape(text)
        line.text = (line.text.ljust(first - 1)[:first - 1] + text.rjust(last - first + 1)
                     + line.text[last:]).rstrip(" ")
        self.sets.append((self.part, line, last - len(text) + 1 if text else first, last))

    def do(self, word, rest):
        if word == "set":
            self.set_field(rest)
        elif word in ("after", "before"):
            anchor, more = PLACE.match(rest).groups()[:2]
            at = self.find(anchor, more) + (word == "after")
            self.target = (self.lines, at)
        elif word == "del":
            place, _, number = rest.partition(" x ")
            anchor, more = PLACE.match(place).groups()[:2]
            at = self.find(anchor, more)
            del self.lines[at:at + int(number or 1)]
        elif word == "line":
            place, text = rest.split(" = ", 1)
            anchor, more = PLACE.match(place).groups()[:2]
            line = self.lines[self.find(anchor, more)]
            line.text = unescape(text)
            self.sets.append((self.part, line, 1, len(text)))
        elif word in ("starter", "engine"):
            self.part = word
        elif word == "file":
            self.files[rest] = []
            self.target = (self.files[rest], 0)
        elif word == "args":
            self.args = rest.split()
        elif word == "no":
            self.no_deck.add(rest)
        elif word == "lines":
            self.decks[self.part] = []
            self.target = (self.lines, 0)
        elif word == "crlf":
            self.end = "\r\n"
        elif word == "!":
            severity, key, place = rest.split(" ", 2)
            self.expected.append((severity, "" if key == "-" else key, place))
        else:
            raise SystemExit(f"{self.name}: what is {word!r}?")

    def add(self, text):
        where, at = self.target
        line = Line(unescape(text))
        where.insert(at, line)
        self.target = (where, at + 1)
        self.added.append((self.part_of(where), line))

    def part_of(self, where):
        for part, lines in list(self.decks.items()) + list(self.files.items()):
            if lines is where:
                return part

    def place(self, text):
        """(file, line, first, last) of an expected place"""
        if text == "-":
            return None
        if text.startswith("file "):
            return text[5:]
        if text.startswith("$"):
            part, line, first, last = self.sets[int(text[1:]) - 1]
            return self.locate(part, line), first, last
        if text.startswith("+"):
            number, columns = text[1:].split(":")
            part, line = self.added[int(number) - 1]
            where = self.locate(part, line)
        else:
            part = "starter"
            if text.startswith("engine "):
                part, text = text.split(" ", 1)
            self.part = part
            anchor, more, first, last = PLACE.match(text).groups()
            columns = f"{first}-{last or first}"
            where = self.locate(part, self.lines[self.find(anchor, more)])
        first, _, last = columns.partition("-")
        return where, int(first), int(last or first)

    def locate(self, part, line):
        lines = self.decks.get(part, self.files.get(part))
        name = {"starter": "base_0000.rad", "engine": "base_0001.rad"}.get(part, part)
        return name, lines.index(line) + 1


def unescape(text):
    return text.replace("\\t", "\t").replace("\\r", "\r").replace("\\0", "\0")


def read_cases(path):
    cases = []
    for number, text in enumerate(path.read_text().splitlines(), start=1):
        if text.startswith("=== "):
            cases.append(Case(text[4:]))
        elif text.startswith("+"):
            cases[-1].add(text[1:])
        elif text and not text.startswith("#"):
            word, _, rest = text.partition(" ")
            cases[-1].do(word, rest)
    return cases


def run(kjoint, command, case, folder):
    words = [kjoint, command, "--json", "base_0000.rad", *case.args]
    env = {**os.environ, "UBSAN_OPTIONS": "print_stacktrace=1"}
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, errors="replace",
                          timeout=1200, env=env)


def seen(findings):
    result = []
    for f in findings:
        if f["severity"] == "note":
            continue
        place = None
        if "line" in f:
            place = (pathlib.Path(f["file"]).name, f["line"]), f.get("first"), f.get("last")
        elif "file" in f:
            place = pathlib.Path(f["file"]).name
        result.append((f["severity"], f["id"], place))
    return sorted(result, key=str)


def check(kjoint, case):
    wrong = []
    folder = pathlib.Path(tempfile.mkdtemp())
    try:
        for part, number in (("starter", "0000"), ("engine", "0001")):
            if part not in case.no_deck:
                text = case.end.join(line.text for line in case.decks[part]) + case.end
                (folder / f"base_{number}.rad").write_bytes(text.encode("latin-1"))
        for name, lines in case.files.items():
            (folder / name).write_bytes(
                (case.end.join(line.text for line in lines) + case.end).encode("latin-1"))
        expected = sorted(((s, k, case.place(p)) for s, k, p in case.expected), key=str)
        before = sorted(p.name for p in folder.iterdir())
        bad = any(s == "error" for s, _, _ in case.expected)
        for command in ("check", "run") if bad else ("check",):
            done = run(kjoint, command, case, folder)
            for text in RUNTIME:
                if text in done.stderr:
                    wrong.append(f"{command}: {text}: {done.stderr[:400]}")
            try:
                said = json.loads(done.stdout)
            except ValueError:
                wrong.append(f"{command}: no JSON, exit {done.returncode}: {done.stderr[:300]}")
                continue
            found = seen(said["findings"])
            for item in expected:
                if item not in found:
                    wrong.append(f"{command}: missing {item}")
            for item in found:
                if item not in expected:
                    wrong.append(f"{command}: unexpected {item}")
            file_error = any(k in ("KJ-9030", "KJ-9031") for s, k, _ in case.expected if s == "error")
            code = (3 if file_error else 2) if bad else 0
            if done.returncode != code:
                wrong.append(f"{command}: exit {done.returncode}, expected {code}")
        after = sorted(p.name for p in folder.iterdir())
        if after != before:
            wrong.append(f"files left behind: {sorted(set(after) - set(before))}")
    finally:
        shutil.rmtree(folder)
    return wrong


def keyword_cases(kjoint):
    """A case for each keyword of `kjoint list keywords`: those that are read stand in the base deck or the full one."""
    table = subprocess.run([kjoint, "list", "keywords"], capture_output=True, text=True, check=True)
    cases = []
    for row in table.stdout.splitlines()[1:]:
        name, status = row[:22].strip(), row[22:35].strip()
        case = Case(f"{name} is {status}")
        cases.append(case)
        if status in ("read", "aside"):
            continue
        case.do("before", "/END")
        case.add(name + "/77")
        case.add("a title")
        if status in ("unsupported", "full only"):
            case.expected.append(("error", "KJ-9022", f"+1:1-{len(name) + 3}"))
    read = {row.split()[0] for row in table.stdout.splitlines()[1:] if row.split()[1] == "read"}
    aliases = {"/PROP/SPRING", "/PROP/SPR_GENE", "/PROP/TYPE45", "/PROP/KJOINT", "/MAT/LAW0", "/RANDOM/GRNOD",
               "/PROP/TYPE4", "/PROP/TYPE8", "/PROP/TYPE13", "/TH/PART"}
    base = [line for name in ("base", "full")
            for line in (HERE / f"{name}_0000.rad").read_text().splitlines()]
    missing = [name for name in sorted(read - aliases)
               if not any(line == name or line.startswith(name + "/") for line in base)]
    if missing:
        raise SystemExit(f"not in the base deck: {missing}")
    return cases


def main():
    kjoint = str(pathlib.Path(sys.argv[1]).resolve())
    cases = []
    for name in sys.argv[2:]:
        cases += keyword_cases(kjoint) if name == "keywords" else read_cases(pathlib.Path(name))
    failed, ids = 0, set()
    for case in cases:
        ids |= {k for _, k, _ in case.expected}
        wrong = check(kjoint, case)
        failed += bool(wrong)
        print(("FAIL   " if wrong else "ok     ") + case.name)
        for line in wrong:
            print("          " + line)
    print(f"{len(cases)} cases, {len(ids)} ids, {failed} failed")
    sys.exit(failed > 0)


main()
