"""What the programs that show histories share: kjoint itself, units, words for what is missing."""
from __future__ import annotations

import importlib
import json
import os
import shutil
import subprocess
import sys
from typing import Any

from ._error import Error

# Tableau's colours for the colour blind
COLOURS = ("#006ba4", "#ff800e", "#595959", "#5f9ed1", "#c85200", "#898989", "#a2c8ec", "#ffbc79")


def fail(message: Any, code: Any = 2) -> None:
    raise Error(message, code)


def command(main: Any) -> None:
    """A command: what goes wrong is said, and is its exit code."""
    try:
        main()
    except Error as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(error.status)


def need(what: Any, *names: Any) -> Any:
    """Modules that a command needs. Error: one is missing, with how to install it."""
    found = []
    for name in names:
        try:
            found.append(importlib.import_module(name))
        except ImportError:
            package = name.partition(".")[0].replace("imageio_ffmpeg", "imageio-ffmpeg")
            fail(f"kjoint {what} needs the Python package {package}\n"
                 f"    = install it: {sys.executable} -m pip install {package}")
    return found


def program() -> Any:
    """The program kjoint that called us, else the one in the path."""
    found = os.environ.get("KJOINT_PROGRAM") or shutil.which("kjoint")
    if not found:
        fail("the program kjoint is not in the path")
    return found


def call(*words: Any, codes: Any = (0,)) -> Any:
    """What the program prints. Error: what it has to say when its exit code is none of `codes`."""
    done = subprocess.run([program(), *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode not in codes:
        said = done.stderr.strip().removeprefix("error: ")
        if not said and done.stdout.startswith("{"):
            said = json.loads(done.stdout)["findings"][-1]["message"]
        fail(said, done.returncode)
    return done.stdout


def export(history: Any, names: Any) -> Any:
    """Series of a history of either kind, as `kjoint export --to json` tells them; NaN for null."""
    found = json.loads(call("export", history, *names, "--to", "json"))
    for series in found["series"]:
        series["values"] = [float("nan") if v is None else v for v in series["values"]]
    return found


# ---- units

BASE = {"kg": (0, 1.0), "g": (0, 1e-3), "mg": (0, 1e-6), "Mg": (0, 1e3), "t": (0, 1e3),
        "m": (1, 1.0), "mm": (1, 1e-3), "cm": (1, 1e-2), "um": (1, 1e-6), "km": (1, 1e3),
        "in": (1, 0.0254), "ft": (1, 0.3048),
        "s": (2, 1.0), "ms": (2, 1e-3), "us": (2, 1e-6)}
FORCES = {"N": 1.0, "kN": 1e3, "mN": 1e-3, "MN": 1e6, "lbf": 4.4482216152605}
ANGLES = {"rad": 1.0, "deg": 57.29577951308232}
SMALL = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


class Units:
    """Turns values of a history into the units that were asked for: `N,mm,s`, `kN,m`, `deg`."""

    def __init__(self, wanted: Any, history: Any) -> None:
        self.known = all(si > 0 for si in history["unit_si"])
        self.have = list(history["unit_si"]) if self.known else [1.0, 1.0, 1.0]
        self.symbol = list(history["unit_symbol"])
        self.want, self.angle = list(self.have), "rad"
        force = None
        for word in filter(None, (wanted or "").split(",")):
            if word in BASE:
                place, self.want[BASE[word][0]] = BASE[word][0], BASE[word][1]
                self.symbol[place] = word
            elif word in FORCES:
                force = word
            elif word in ANGLES:
                self.angle = word
            else:
                fail(f'"{word}" is no unit: {", ".join([*BASE, *FORCES, *ANGLES])}')
        if wanted and not self.known and set(wanted.split(",")) - set(ANGLES):
            fail("the history does not say its units, so they cannot be turned into others")
        if force:                               # the mass follows from force, length and time
            self.want[0] = FORCES[force] * self.want[2]**2 / self.want[1]
            self.symbol[0] = next((name for name, (place, si) in BASE.items() if place == 0
                                   and abs(si / self.want[0] - 1) < 1e-9), "")
        m, length, t = self.want
        self.force = force or next((name for name, si in FORCES.items() if self.known
                                    and abs(si / (m * length / t**2) - 1) < 1e-9), None)
        self.energy = next((name for name, si in (("J", 1.0), ("kJ", 1e3), ("mJ", 1e-3))
                            if self.known and abs(si / (m * length**2 / t**2) - 1) < 1e-9), None)

    def of(self, series: Any) -> Any:
        """Factor and name of the unit of a series."""
        power, angle = series["dimension"], series["angle"]
        factor = 1.0
        for have, want, n in zip(self.have, self.want, power):
            factor *= (have / want)**n
        if angle:
            factor *= ANGLES[self.angle]
        if series["class"] == "force" and power == [1, 1, -2] and self.force:
            return factor, self.force
        if power == [1, 2, -2] and series["class"] == "energy" and self.energy:
            return factor, self.energy
        if power == [1, 2, -2] and self.force:
            return factor, f"{self.force} {self.symbol[1]}"
        parts = [self.angle] if angle else []
        parts += [symbol + (str(n).translate(SMALL) if n != 1 else "")
                  for symbol, n in zip(self.symbol, power) if n]
        return factor, " ".join(parts)
