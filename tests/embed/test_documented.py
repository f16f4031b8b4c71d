#!/usr/bin/env python3
"""Each public object of the Python package says what it is with an example that runs, and mypy --strict
passes on the package.

usage: test_documented.py examples|types      exit code 77: mypy is not installed
"""
import doctest
import importlib
import importlib.util
import inspect
import os
import pathlib
import pkgutil
import subprocess
import sys
import tempfile

import kjoint


def public():
    """(name, object) of what kjoint offers, and of the results that it gives."""
    seen, queue = set(), [(name, getattr(kjoint, name)) for name in kjoint.__all__]
    samples = importlib.import_module("kjoint.samples")
    model = importlib.import_module("kjoint.model")
    queue += [("Channel", samples.Channel), ("Curve", samples.Curve), ("BodyState", model.BodyState),
              ("JointState", model.JointState), ("RunStatus", model.RunStatus)]
    for name, thing in queue:
        yield name, thing
        if inspect.isclass(thing):
            for kind in thing.__mro__:
                if not kind.__module__.startswith("kjoint"):
                    continue
                for part, value in vars(kind).items():
                    found = value.fget if isinstance(value, property) else getattr(value, "__func__", value)
                    if part.startswith("_") or not inspect.isfunction(found) or (name, part) in seen:
                        continue
                    seen.add((name, part))
                    yield f"{name}.{part}", found


def examples():
    problems = [f"{name}: no example" for name, thing in public() if ">>>" not in (inspect.getdoc(thing) or "")]
    n = 0
    os.chdir(tempfile.mkdtemp())
    for module in pkgutil.iter_modules(kjoint.__path__, "kjoint."):
        result = doctest.testmod(importlib.import_module(module.name), optionflags=doctest.NORMALIZE_WHITESPACE)
        n += result.attempted
        problems += [f"{module.name}: {result.failed} examples fail"]*bool(result.failed)
    result = doctest.testmod(kjoint)
    problems += ["kjoint: its example fails"]*bool(result.failed)
    print("\n".join(problems) or f"{n} lines of examples are well")
    return 1 if problems else 0


def types():
    if not importlib.util.find_spec("mypy"):
        print("mypy is not installed")
        return 77
    folder = pathlib.Path(kjoint.__file__).parent
    return subprocess.run([sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", folder,
                           "--cache-dir", tempfile.mkdtemp()], check=False).returncode


if __name__ == "__main__":
    sys.exit({"examples": examples, "types": types}[sys.argv[1]]())
