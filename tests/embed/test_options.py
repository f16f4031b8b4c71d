#!/usr/bin/env python3
"""Each option of the table reaches a run from C, Python and the command line (Fortran:
unit/test_run_option.pf). usage: test_options.py [KJOINT]"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import kjoint
from kjoint._library import LIB, Handle

PROGRAM = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else None
DECK, ENGINE = (pathlib.Path(__file__).with_name(f"options_000{i}.rad") for i in range(2))
BASE = dict(ignore_unsupported=1)
# another value of each option, which changes the bits of the samples, or ends with a status
OTHER = dict(formulation="legacy", integrator="liemid", dt_rule="nodal", dt_scale=0.3,
             dt_max_scale=0.01, until=0.01, sample=0.01, energy_limit=1e-12, kn_scale=0.5,
             kn="inf", error=1e-6, turn=0.001, fast=1, ignore_unsupported=0, ignore_random=1,
             mechanism=1, set="gone=1", joint="1.Cr=0.5", threads=2, least_share=1, islands=1,
             force=1)
# these go with the integrator compliant alone
BESIDE = dict.fromkeys(("kn", "error", "turn"), dict(integrator="compliant"))
# the deck is all mechanism: what is out of scope there is left out with it or without
MECHANISM = ("mechanism",)
STATUS = dict(energy_limit=1, ignore_unsupported=2, set=2)
# these two change the number of threads and no bit; what a scene of three bodies needs beside them
THREADS = dict(threads=dict(least_share=1), least_share=dict(threads=2))
# and these no run of this deck: cli/test_cli.py has what force is for, full/check_cards.py ignore_random
UNSEEN = {*THREADS, *MECHANISM, "force", "ignore_random"}


def text_of(options):
    return " ".join(f"{name}={value}" for name, value in options.items())


def over_python(**options):
    return kjoint.Model(DECK, ENGINE, **options).run()


def over_c(**options):
    model = kjoint.Model.__new__(kjoint.Model)
    Handle.__init__(model)
    model._new(LIB.kj_model_load, os.fsencode(DECK), os.fsencode(ENGINE),
               text_of(options).encode())
    return model.run()


def words_of(options):
    """As the command line has them."""
    words = []
    for name, value in options.items():
        flag = kjoint.options()[name].kind == "flag"
        words += ["--" + name.replace("_", "-")][:1 if value or not flag else 0]
        words += [] if flag else [str(value)]
    return words


def samples(model):
    return [model[channel] for channel in model.channels]


def same(a, b):
    return all(np.array_equal(x, y) for x, y in zip(samples(a), samples(b)))


class Options(unittest.TestCase):
    def test_each_option_is_tried(self):
        self.assertEqual(set(kjoint.options()), set(OTHER))

    def test_each_reaches_a_run_from_python_and_c(self):
        base = over_python(**BASE)
        for name, value in OTHER.items():
            for side in over_python, over_c:
                with self.subTest(name=name, side=side.__name__):
                    if name in STATUS:
                        with self.assertRaises(kjoint.Error) as raised:
                            side(**{**BASE, name: value})
                        self.assertEqual(raised.exception.status, STATUS[name])
                        continue
                    if name == "threads" and not openmp():
                        continue
                    beside = {**BASE, **BESIDE.get(name, {})}
                    run = side(**{**beside, name: value})
                    without = over_python(**beside) if name in BESIDE else base
                    self.assertEqual(same(run, without), name in UNSEEN)
                    arrived = run.options[name]
                    self.assertEqual(arrived if isinstance(value, str) else float(arrived), value)

    def test_each_reaches_a_run_from_the_command_line(self):
        """It writes the history of the same options over Python."""
        if not PROGRAM:
            self.skipTest("no program")
        with tempfile.TemporaryDirectory() as folder:
            path, other = os.path.join(folder, "x.h5"), os.path.join(folder, "y.h5")
            for name, value in OTHER.items():
                if name == "threads" and not openmp():
                    continue
                with self.subTest(name=name):
                    options = {**BASE, **BESIDE.get(name, {}), name: value}
                    run = subprocess.run([PROGRAM, "run", str(DECK), "-q", "-o", path,
                                          *words_of(options)], capture_output=True, check=False)
                    self.assertEqual(run.returncode, STATUS.get(name, 0), run.stderr)
                    if name not in STATUS:
                        over_python(**options).write_history(other)
                        diff = subprocess.run([PROGRAM, "diff", "--profile", "exact", other, path],
                                              capture_output=True, check=False)
                        self.assertEqual(diff.returncode, 0, diff.stdout)

    def test_threads(self):
        """Two threads with the option, one without, on each side."""
        if not openmp():
            self.skipTest("no OpenMP")
        for name, beside in THREADS.items():
            for side in ("over_python", "over_c", "program")[:3 if PROGRAM else 2]:
                with self.subTest(name=name, side=side):
                    options = {**BASE, **beside, "until": 1e-3}
                    self.assertEqual(threads_of(side, options), 0)
                    self.assertEqual(threads_of(side, {**options, name: OTHER[name]}), 2)


def openmp():
    with open("/proc/self/maps") as maps:
        return "libgomp" in maps.read()


def threads_of(side, options):
    """Threads that OpenMP tells of, in a process that runs the deck; one alone does not count."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OMP_DISPLAY_AFFINITY": "TRUE",
                   "OMP_AFFINITY_FORMAT": "thread %n of %N"}
    command = [sys.executable, os.path.abspath(__file__), "--run", side, text_of(options)]
    if side == "program":
        command = [PROGRAM, "run", str(DECK), "-q", "-o", "threads.h5", *words_of(options)]
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True,
                             check=True)
    return sum(line.startswith("thread ") for line in (run.stdout + run.stderr).splitlines())


if __name__ == "__main__":
    if sys.argv[1:2] == ["--run"]:
        globals()[sys.argv[2]](**dict(word.split("=") for word in sys.argv[3].split()))
    else:
        unittest.main(argv=sys.argv[:1])
