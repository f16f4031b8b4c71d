#!/usr/bin/env python3
"""How fast a large deck is read and checked, and with how much memory.

usage: bench_read.py KJOINT [NODES [JOINTS [FOLDER]]]      (1000000 nodes, 100000 joints)

Two decks are written: one of nodes alone, one where the joints, each with a property, part, two
skews and bodies of its own, stand among the nodes. `kjoint check -q` reads them; `wc -l` tells what
the files cost to touch.
"""
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

BEGIN = """/BEGIN
bench
      2026         0
                  kg                   m                   s
                  kg                   m                   s
"""
ENGINE = "/RUN/bench/1\n1.0\n/TFILE/1\n0.1\n"


def node(number, x, y, z):
    return f"{number:10d}{x:20.12g}{y:20.12g}{z:20.12g}\n"


def write_nodes(path, n):
    with open(path, "w") as out:
        out.write(BEGIN + "/NODE\n")
        for i in range(1, n + 1):
            out.write(node(i, i*1.000123, (i*7919) % 10007*0.37, -i/3.0))
        out.write("/END\n")


def write_joints(path, n_node, n_joint):
    """A chain: bodies 0 to n_joint with a main node, four nodes of their own each; joint j between
    bodies j - 1 and j."""
    with open(path, "w") as out:
        out.write(BEGIN + "/NODE\n")
        number = 0
        for b in range(n_joint + 1):
            x = 0.1*b
            for point in ((x, 0, 0), (x, 0, 0), (x + 0.1, 0, 0), (x, 0.1, 0), (x + 0.1, 0, 0)):
                number += 1
                out.write(node(number, *point))
        for i in range(number + 1, n_node + 1):
            out.write(node(i, i*1e-3, 5.0, i/3.0))
        for b in range(n_joint + 1):
            main = 5*b + 1
            out.write(f"/SKEW/MOV/{b + 1}\nskew\n{main + 1:10d}{main + 2:10d}{main + 3:10d}         X\n"
                      f"/GRNOD/NODE/{b + 1}\nnodes\n{main + 1:10d}{main + 2:10d}{main + 3:10d}{main + 4:10d}\n"
                      f"/RBODY/{b + 1}\nbody\n{main:10d}         0         0         0{1.0:20.6g}{b + 1:10d}"
                      f"         0         3         0\n{0.01:20.6g}{0.01:20.6g}{0.01:20.6g}\n")
        for j in range(1, n_joint + 1):
            out.write(f"/PROP/KJOINT/{j}\njoint\n         2         0\n{j:10d}{j + 1:10d}{0.0:20.6g}{0.05:20.6g}\n"
                      f"{1.0e6:20.6g}{0.0:20.6g}         0\n/PART/{j}\njoint {j}\n{j:10d}         0         0\n"
                      f"/SPRING/{j}\n{j:10d}{5*j:10d}{5*j + 2:10d}\n")
        out.write("/END\n")


def wall(words):
    """Best wall time of three runs [s], largest memory [bytes]"""
    best = 1e9
    for _ in range(3):
        start = time.perf_counter()
        subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
        best = min(best, time.perf_counter() - start)
    return best, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss*1024


def main():
    kjoint = str(pathlib.Path(sys.argv[1]).resolve())
    n_node = int(sys.argv[2]) if len(sys.argv) > 2 else 1000000
    n_joint = int(sys.argv[3]) if len(sys.argv) > 3 else 100000
    with tempfile.TemporaryDirectory(dir=sys.argv[4] if len(sys.argv) > 4 else None) as folder:
        decks = {"nodes": lambda path: write_nodes(path, n_node),
                 "joints": lambda path: write_joints(path, n_node, n_joint)}
        for name, write in decks.items():
            deck = pathlib.Path(folder) / f"{name}_0000.rad"
            write(deck)
            (pathlib.Path(folder) / f"{name}_0001.rad").write_text(ENGINE)
            size = deck.stat().st_size
            lines, _ = wall(["wc", "-l", deck])
            seconds, memory = wall([kjoint, "check", "-q", deck])
            print(f"{name:8s}{size/1e6:8.1f} MB  read and checked in {seconds:6.2f} s: "
                  f"{size/1e6/seconds:6.1f} MB/s, {seconds/lines:5.1f} times wc -l, "
                  f"{memory/1e6:7.1f} MB of memory ({memory/size:.1f} times the file)", flush=True)


if __name__ == "__main__":
    main()
