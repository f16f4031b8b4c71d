#!/usr/bin/env python3
"""Turn .pf tests into one Fortran program, for machines that have no pFUnit.

usage: pf2f90.py OUT_DIR FILE.pf ...

Accepts the subset of pFUnit that this project allows (tests/README.md): one module per file,
named as the file; `@test` alone on the line before an argument-less subroutine; `@assertEqual`,
`@assertTrue`, `@assertFalse`, `@assertLessThan`, `@assertGreaterThan` on one line each. Writes
OUT_DIR/<name>.f90 for each file and OUT_DIR/unit_tests.f90, the program that runs them all, or the
modules named as its arguments.
"""
import pathlib
import re
import sys

ALLOWED = {"assertequal", "asserttrue", "assertfalse", "assertlessthan", "assertgreaterthan"}
ASSERT = re.compile(r"^(\s*)@(assert\w+)\s*\((.*)\)\s*$", re.IGNORECASE)
TEST = re.compile(r"^\s*@test\s*$", re.IGNORECASE)
SUBROUTINE = re.compile(r"^\s*subroutine\s+(\w+)\s*(\(\s*\))?\s*(!.*)?$", re.IGNORECASE)
MODULE = re.compile(r"^\s*module\s+(\w+)\s*$", re.IGNORECASE)
LONGEST_NAME = 44          # of pFUnit
LONGEST_LINE = 132         # of Fortran


def stop(path, number, message):
    sys.exit(f"{path}:{number}: {message}")


def translate(path):
    """Return the Fortran lines of one .pf file and the names of its tests."""
    lines, tests, pending, module = [], [], False, None
    for number, line in enumerate(path.read_text().splitlines(), start=1):
        if TEST.match(line):
            pending = True
            lines.append("")                        # line numbers stay those of the .pf file
            continue
        if pending:
            match = SUBROUTINE.match(line)
            if not match:
                stop(path, number, "@test must stand alone before a subroutine without arguments")
            if len(match.group(1)) > LONGEST_NAME:
                stop(path, number, f"name of a test with more than {LONGEST_NAME} characters")
            tests.append(match.group(1))
            pending = False
        if MODULE.match(line) and module is None:
            module = MODULE.match(line).group(1).lower()
        match = ASSERT.match(line)
        if match and match.group(2).lower() in ALLOWED:
            indent, name, args = match.groups()
            call = f"{indent}call {name}({args})"
            if len(call) > LONGEST_LINE:
                stop(path, number, "assertion too long")
            lines += [f"{indent}call funit_here('{path.name}', {number})", call,
                      f"{indent}if (funit_failed()) return"]
        elif line.lstrip().startswith("@"):
            stop(path, number, f"not in the allowed subset: {line.strip()}")
        else:
            lines.append(line)
    if module != path.stem.lower():
        stop(path, 1, f"the module must have the name of the file, {path.stem}")
    if not tests:
        stop(path, 1, "no test in this file")
    return lines, tests


def write(path, lines):
    """Write a file that is not there or differs: what did not change is not compiled again."""
    text = "\n".join(lines) + "\n"
    if not path.is_file() or path.read_text() != text:
        path.write_text(text)


def main(out_dir, files):
    out = pathlib.Path(out_dir)
    uses, calls = [], []
    for name in files:
        path = pathlib.Path(name)
        lines, tests = translate(path)
        write(out / f"{path.stem}.f90", lines)
        for test in tests:
            alias = f"t{len(calls)}"
            uses.append(f"   use {path.stem}, only: {alias} => {test}")
            calls.append(f"   call funit_run('{path.stem}', '{test}', {alias})")
    program = ["program unit_tests", "   use funit, only: funit_run, funit_finish", *uses,
               "   implicit none", *calls, "   call funit_finish()",
               "end program unit_tests"]
    write(out / "unit_tests.f90", program)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
