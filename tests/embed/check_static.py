#!/usr/bin/env python3
"""The library has no static memory that it writes: simulations run side by side in threads.

gfortran keeps the length of a deferred-length function result in static memory (slen): a function
must declare the length of its text, or be a subroutine. usage: check_static.py libkjoint.a
"""
import re
import shutil
import subprocess
import sys

CONSTANT = re.compile(r"__vtab_|__def_init_|jumptable|__hash_|^\.|^A\.\d|^\.?LC|__asan|__odr|__ubsan|ubsan_|\.at$|^kj_kernel$")

if not shutil.which("nm"):
    sys.exit(77)
found, member = [], ""
for line in subprocess.run(["nm", sys.argv[1]], capture_output=True, text=True).stdout.splitlines():
    if line.endswith(":"):
        member = line[:-1]
    words = line.split()
    if len(words) == 3 and words[1] in "bBdDcC" and not CONSTANT.search(words[2]):
        found.append(f"{member}: {words[2]}")
print("\n".join(found) if found else "no static memory that is written")
sys.exit(1 if found else 0)
