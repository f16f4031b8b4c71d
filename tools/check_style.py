#!/usr/bin/env python3
"""Check the rules of the style guide that a compiler does not check.

usage: check_style.py [ROOT]      (exit 1 and one line per finding)

Files: at most 600 lines, from 401 with `!> One file: <reason>` in the head; 100 columns (rows of
tables 132), no tab, no trailing blank, listed in a CMakeLists.txt. Modules: named as the file,
`implicit none`, `private`, no variables, `use` with `only`, of the own folder or one before it in
FOLDERS (of a formulation: api alone), in no circle; hdf5 in kj_h5* alone. Procedures: at most 80 lines. Public entities: a `!>`
above. Nothing but src/cli prints or stops. No goto, include, entry, common, forall, final, save.
"""
import pathlib
import re
import sys

# a folder uses itself and those before it
FOLDERS = ("base", "joint", "deck", "model", "full", "legacy", "consistent", "history", "files",
           "api", "capi", "cli")
WINGS = ("legacy", "consistent")                  # used by themselves and by api alone
MAX_FILE, MAX_LINE, MAX_TABLE_LINE, MAX_PROCEDURE = 600, 100, 132, 80
LONG_FILE = 400                                   # from there on the head says why
MAY_HOLD_VARIABLES = {"kj_signal"}                # the flag that a signal handler sets

I = re.IGNORECASE
TEXTS = re.compile(r"'(?:[^']|'')*'|\"(?:[^\"]|\"\")*\"")
USE = re.compile(r"^\s*use(?:\s+|\s*,\s*(?:non_)?intrinsic\s*::\s*|\s*::\s*)(\w+)\s*((?:[,!].*)?)$", I)
TALK = re.compile(r"^\s*(if\s*\(.*\)\s*)?(print\b(?!\s*[=%(])|write\s*\(\s*\*"
                  r"|write\s*\(\s*(output|error)_unit|(error\s+)?stop\b(?!\s*[=%(]))", I)
ASKS = re.compile(r"\bget_(environment_variable|command)\w*", I)
BANNED = re.compile(r"^\s*(if\s*\(.*\)\s*)?(goto\b|go\s+to\b|include\s*'|entry\s+\w|common\s*/"
                    r"|forall\b|final\s*::|save\b)", I)
SAVED = re.compile(r",\s*save\b", I)
DATA = re.compile(r"^\s*(integer|real|logical|character|complex|type\s*\(|class\s*\()", I)
PREFIX = r"(?:(?:pure|elemental|impure|recursive|module|integer|logical|real|character|type)\b" \
         r"(?:\s*\([^()]*(?:\([^()]*\)[^()]*)*\))?\s+)*"
PROCEDURE = re.compile(rf"^\s*{PREFIX}(function|subroutine)\s+(\w+)", I)
BODY = re.compile(r"^\s*module\s+procedure\s+(\w+)\s*$", I)
END_PROCEDURE = re.compile(r"^\s*end\s*(function|subroutine|procedure)\b", I)
TYPE = re.compile(r"^\s*type\s*((,[^:]*)?::)?\s*(\w+)\s*$", I)
INTERFACE = re.compile(r"^\s*(abstract\s+)?interface\b\s*(\w*)", I)
END_BLOCK = re.compile(r"^\s*end\s*(type|interface)\b", I)
REASON = re.compile(r"^!> One file: \w+", I)
PUBLIC = re.compile(r"^\s*public\s*(::)?\s*(.+)", I)


def code_of(line):
    """The line without its texts and comment."""
    return TEXTS.sub(lambda m: "'" + " " * (len(m.group()) - 2) + "'", line).split("!")[0]


class File:
    """One source file and what was found in it."""

    def __init__(self, path, folder):
        self.path, self.folder = path, folder
        self.lines = path.read_text(encoding="utf-8").splitlines()
        self.code = [code_of(line) for line in self.lines]
        self.uses = {}                            # module: line of its first `use`
        self.found = []

    def say(self, number, message):
        self.found.append(f"{self.path}:{number}: {message}")

    def check(self, folder_of_module):
        self.check_whole()
        for number, (line, code) in enumerate(zip(self.lines, self.code), start=1):
            self.check_line(number, line, code)
            self.check_use(number, code, folder_of_module)
        self.check_structure()

    def check_whole(self):
        text = "\n".join(self.code)
        stem = self.path.stem
        if len(self.lines) > MAX_FILE:
            self.say(1, f"{len(self.lines)} lines, more than {MAX_FILE}")
        elif len(self.lines) > LONG_FILE and not self.has_reason():
            self.say(1, f"{len(self.lines)} lines, more than {LONG_FILE} without `!> One file: reason`")
        named = rf"^\s*(module\s+{stem}|submodule\s*\(\s*\w+(?:\s*:\s*\w+)?\s*\)\s*{stem}|program\s+{stem})\s*$"
        if not re.search(named, text, re.M | I):
            self.say(1, "module and file differ in name")
        if not re.search(r"^\s*implicit\s+none\b", text, re.M | I):
            self.say(1, "no `implicit none`")
        if re.search(r"^\s*module\s+\w+\s*$", text, re.M | I) \
                and not re.search(r"^\s*private\s*$", text, re.M | I):
            self.say(1, "no `private`")

    def has_reason(self):
        """The comment that the file begins with says why it is long."""
        for line in self.lines:
            if REASON.match(line):
                return True
            if not line.startswith("!"):
                return False
        return False

    def check_line(self, number, line, code):
        limit = MAX_TABLE_LINE if re.match(r"\s*\w+_t\(", line) else MAX_LINE
        if len(line) > limit:
            self.say(number, f"{len(line)} columns, more than {limit}")
        if line != line.rstrip():
            self.say(number, "trailing blank")
        if "\t" in line:
            self.say(number, "tab")
        if self.folder != "cli" and TALK.match(code):
            self.say(number, "the library does not print or stop")
        if self.folder != "cli" and ASKS.search(code):
            self.say(number, "the library does not read the environment or the command line")
        banned = BANNED.match(code)
        if banned:
            self.say(number, f"banned: {banned.group(2).strip()}")
        if SAVED.search(code) and self.path.stem not in MAY_HOLD_VARIABLES:
            self.say(number, "banned: save")

    def check_use(self, number, code, folder_of_module):
        use = USE.match(code)
        if not use:
            return
        name, rest = use.group(1).lower(), use.group(2).lower()
        if not re.search(r"\bonly\s*:", rest):
            self.say(number, f"use {name} without only")
        if name in ("hdf5", "h5ds", "h5lt") and not self.path.stem.startswith("kj_h5"):
            self.say(number, f"{name} outside kj_h5")
        self.uses.setdefault(name, number)
        other = folder_of_module.get(name, self.folder)
        if other in FOLDERS and FOLDERS.index(other) > FOLDERS.index(self.folder):
            self.say(number, f"{self.folder} uses {name} of the later folder {other}")
        elif other in WINGS and self.folder not in (other, "api"):
            self.say(number, f"{self.folder} uses {name} of the formulation {other}, as api may alone")

    def check_structure(self):
        """Module variables, length of procedures, documentation of public entities."""
        in_head, blocks, start, name = True, 0, 0, ""
        inner = 0
        documented = {}
        is_program = any(re.match(r"\s*program\s+\w+", code, I) for code in self.code)
        continued = False
        for number, code in enumerate(self.code, start=1):
            was_continued, continued = continued, code.rstrip().endswith("&")
            if was_continued:
                continue
            kind, interface = TYPE.match(code), INTERFACE.match(code)
            if (kind and not re.match(r"\s*type\s+is\b", code, I)) or interface:
                if blocks == 0:
                    documented[(kind.group(3) if kind else interface.group(2)).lower()] = number
                blocks += 1
            if END_BLOCK.match(code):
                blocks -= 1
                continue
            procedure = PROCEDURE.match(code) or (None if blocks else BODY.match(code))
            if procedure and not re.match(r"\s*end\b", code, I):
                documented.setdefault(procedure.group(procedure.lastindex).lower(), number)
                inner += 1
                if inner == 1:
                    start, name = number, procedure.group(procedure.lastindex)
                continue
            if END_PROCEDURE.match(code) and inner > 0:
                inner -= 1
                if inner == 0 and number - start + 1 > MAX_PROCEDURE:
                    long = f"{number - start + 1} lines, more than {MAX_PROCEDURE}"
                    self.say(start, f"{name}: {long}")
                continue
            if blocks or inner:
                continue
            if re.match(r"\s*contains\b", code, I):
                in_head = False
            if in_head and not is_program and DATA.match(code) \
                    and not re.search(r"\bparameter\b", code, I) \
                    and self.path.stem not in MAY_HOLD_VARIABLES:
                self.say(number, "module variable")
        self.check_documented(documented)

    def check_documented(self, documented):
        for name in self.public_names():
            number = documented.get(name)
            if number is None:
                continue                         # a constant, or re-exported from elsewhere
            above = number - 2                   # index of the line above
            while above >= 0 and self.lines[above].lstrip().startswith(("!$omp", "!$OMP")):
                above -= 1
            if above < 0 or not self.lines[above].lstrip().startswith("!>"):
                self.say(number, f"public {name} without `!>` above")

    def public_names(self):
        names, text = [], None
        for number, code in enumerate(self.code):
            if text is None:
                match = PUBLIC.match(code)
                if not match:
                    kind = re.match(r"^\s*type\s*,[^:]*\bpublic\b[^:]*::\s*(\w+)", code, I)
                    names += [kind.group(1).lower()] if kind else []
                    continue
                text = match.group(2)
            else:
                text += " " + code.strip()
            if text.rstrip().endswith("&"):
                text = text.rstrip()[:-1]
                continue
            names += [n.strip().lower() for n in text.split(",") if n.strip()]
            text = None
        return names


def check_lists(root, files):
    """Every source and every unit test must be built: it stands in a CMakeLists.txt."""
    found = []
    sources = (root / "CMakeLists.txt").read_text()
    tests = (root / "tests" / "CMakeLists.txt").read_text()
    for path in files:
        name = path.relative_to(root).as_posix()
        if not re.search(rf"(?<![\w/]){re.escape(name)}(?!\w)", sources):
            found.append(f"{path}:1: not in CMakeLists.txt")
    for path in sorted((root / "tests" / "unit").glob("*.pf")):
        if not re.search(rf"(?<!\w){path.stem}(?!\w)", tests):
            found.append(f"{path}:1: not in tests/CMakeLists.txt")
        for number, line in enumerate(path.read_text().splitlines(), start=1):
            if len(line) > MAX_LINE:
                found.append(f"{path}:{number}: {len(line)} columns, more than {MAX_LINE}")
    return found


def check_circles(files):
    """Modules in a circle: what is left when those that use none of the rest, or that none of the
    rest uses, are gone."""
    left = {file.path.stem.lower(): file for file in files}
    gone = True
    while gone:
        used = {name for file in left.values() for name in file.uses}
        gone = [name for name, file in left.items()
                if name not in used or not file.uses.keys() & left.keys()]
        for name in gone:
            del left[name]
    for file in left.values():
        names = sorted(file.uses.keys() & left.keys())
        file.say(file.uses[names[0]], f"a circle by the use of {', '.join(names)}")


def main(root):
    src = root / "src"
    paths = sorted(src.rglob("*.f90"))
    folder_of = {path: path.relative_to(src).parts[0] for path in paths}
    folder_of_module = {path.stem.lower(): folder for path, folder in folder_of.items()}
    found = [f"{path}:1: in a folder without a place in the order" for path in paths
             if folder_of[path] not in FOLDERS]
    files = [File(path, folder_of[path]) for path in paths if folder_of[path] in FOLDERS]
    for file in files:
        file.check(folder_of_module)
    check_circles(files)
    found += [line for file in files for line in file.found]
    found += check_lists(root, paths)
    print("\n".join(found) if found else f"{len(paths)} files follow the guide")
    return 1 if found else 0


if __name__ == "__main__":
    if len(sys.argv) > 2:
        sys.exit(__doc__)
    ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) == 2 else ".")
    if not (ROOT / "tests" / "CMakeLists.txt").is_file():
        sys.exit(f"{ROOT} is not the root of the project: it has no tests/CMakeLists.txt")
    sys.exit(main(ROOT))
