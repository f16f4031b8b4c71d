"""The values of parameters of a deck that meet targets.

    kjoint fit DECK_0000.rad --vary stiff=1e4:1e6 --measure 'joint/rotation[hinge].x:max' --target 0.3

Least squares within bounds (scipy.optimize.least_squares) over runs of the deck. A target is a value
of a measure, or a history whose curve is to be followed; each counts as its relative deviation.
"""
from __future__ import annotations

import concurrent.futures
import dataclasses
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ._error import Error, Parser
from .model import Model
from .samples import Path
from .variants import Array, Measure, default_workers, in_words, parse_varied, read_reference, run_options, settings

LARGE = 1e3                                       # deviation of a run that fails
NEAR = 1e-3                                       # a bound, over the range
STEP = 1e-4                                       # of a parameter over its range, for slopes


class Target:
    """A value that a measure is to have, or a curve that a channel is to follow."""

    def __init__(self, measure: str, target: str | float) -> None:
        self.text, self.target = measure, target
        self.measure: Measure | None = None
        try:
            self.value = float(target)
        except ValueError:                        # a history
            self.at, self.wanted = read_reference(str(target), measure)
            self.size = float(np.sqrt(np.mean(self.wanted**2))) or 1.0
        else:
            self.measure = Measure(measure)

    def deviations(self, model: Model) -> list[float]:
        """Relative deviations of a run: one, or one a sample, whose squares sum up to rmse^2 over mean square."""
        if self.measure:
            return [(self.found(model) - self.value)/(abs(self.value) or 1.0)]
        return list((self.curve(model) - self.wanted)/(self.size*np.sqrt(len(self.wanted))))

    def curve(self, model: Model) -> Array:
        return np.interp(self.at, model["time"], model.curve(self.text))

    def found(self, model: Model) -> float:
        """The measure, or the rms of what lies between the curves."""
        if self.measure:
            return self.measure.of(model["time"], model.curve(self.measure.channel))
        return float(np.sqrt(np.mean((self.curve(model) - self.wanted)**2)))


@dataclasses.dataclass
class Fit:
    """What was found: values and standard deviations by name, targets as (text, wanted, found)."""

    values: dict[str, float]
    deviations: dict[str, float]
    at_bound: list[str]
    targets: list[tuple[str, str | float, float]]
    misfit: float
    runs: int
    message: str

    def report(self) -> str:
        """The result as lines to read."""
        lines = [f"{'parameter':20}  {'value':>15}  {'+-':>10}"]
        lines += [f"{name:20}  {value:15.9g}  {self.deviations[name]:10.2g}{'  at its bound' * (name in self.at_bound)}"
                  for name, value in self.values.items()]
        lines += ["", f"{'target':40}  {'wanted':>14}  {'found':>14}"]
        lines += [f"{text:40}  {wanted!s:>14}  {found:14.8g}" for text, wanted, found in self.targets]
        lines += ["", f"misfit {self.misfit:.3g} (root of the sum of squared relative deviations), {self.runs} runs: {self.message}"]
        return "\n".join(lines)


def fit(deck: Path, vary: Mapping[str, Sequence[float]], targets: Sequence[tuple[str, str | float]], *,
        engine: Path | None = None, starts: int = 1, seed: int = 0, workers: int | None = None,
        told: Callable[[int, float], None] | None = None, **options: Any) -> Fit:
    """Find the parameters within bounds that meet targets best; gives a Fit.

    vary: {name: (low, high) or (low, high, start)}; targets: [(measure, value)] or [(channel,
    "REF.h5")], the curve being followed over the times of the reference. starts: places to begin
    from. told(runs, misfit): after each run. Options: those of Model, for each run.

    A run that fails counts as far away; raises Error when that at a start fails, and ValueError for
    bounds and targets that are none.
    """
    from scipy.optimize import least_squares
    names, bounds = list(vary), np.array([value[:2] for value in vary.values()], float)
    if not names or not (bounds[:, 0] < bounds[:, 1]).all() or not np.isfinite(bounds).all():
        raise ValueError("a parameter needs bounds, the first below the second")
    low, span = bounds[:, 0], bounds[:, 1] - bounds[:, 0]
    begin = np.array([((value[2] - value[0])/(value[1] - value[0]) if len(value) > 2 else 0.5) for value in vary.values()])
    if not ((begin >= 0) & (begin <= 1)).all():
        raise ValueError("a start lies outside of its bounds")
    goals = [Target(*target) for target in targets]
    if not goals:
        raise ValueError("there is no target")
    runs = 0

    def run(share: Array) -> Model:
        return Model(deck, engine, **{**options, "set": settings(names, low + span*share, options.get("set"))}).run()

    def deviations(share: Array, may_fail: bool = True) -> Array:
        nonlocal runs
        runs += 1
        try:
            model = run(share)
            found = np.array([d for goal in goals for d in goal.deviations(model)])
        except Error:
            if not may_fail:
                raise
            return np.full(size, LARGE)
        if told:
            told(runs, float(np.linalg.norm(found)))
        return np.where(np.isfinite(found), found, LARGE)

    def slopes(share: Array) -> Array:
        """Of the deviations, by differences into the bounds; runs side by side."""
        steps = np.where(share < 0.5, STEP, -STEP)
        base, *moved = pool.map(deviations, [share, *(share + np.diag(steps))])
        return np.column_stack([(there - base)/step for there, step in zip(moved, steps)])

    size = len(deviations(begin, may_fail=False))
    places = [begin, *np.random.default_rng(seed).random((starts - 1, len(names)))]
    best: Any = None
    with concurrent.futures.ThreadPoolExecutor(workers or default_workers()) as pool:
        for place in places:
            found = least_squares(deviations, np.clip(place, 1e-6, 1 - 1e-6), slopes, bounds=(0, 1),
                                  xtol=1e-10, ftol=1e-12, gtol=1e-12)
            if best is None or found.cost < best.cost:
                best = found
    model = run(best.x)
    # covariance of the residuals that are left, where there are more of them than parameters
    free = size - len(names)
    inverse = np.linalg.pinv(best.jac.T @ best.jac)
    spread = np.sqrt(np.diag(inverse)*2*best.cost/free)*span if free > 0 else np.full(len(names), np.nan)
    values = low + span*best.x
    return Fit(dict(zip(names, map(float, values))), dict(zip(names, map(float, spread))),
               [name for name, x in zip(names, best.x) if min(x, 1 - x) < NEAR],
               [(g.text, g.target, g.found(model)) for g in goals], float(np.sqrt(2*best.cost)), runs + 1, best.message)


def parse_bounds(spec: str) -> tuple[float, ...]:
    """a:b or a:b:start."""
    try:
        numbers: tuple[float, ...] = tuple(map(float, spec.split(":")))
    except ValueError:
        numbers = ()
    if len(numbers) not in (2, 3):
        raise ValueError(f"{spec!r}: bounds a:b, or a:b:start")
    return numbers


def main(words: Sequence[str] | None = None) -> int:
    """The command line, as `kjoint fit` hands it over."""
    parser = Parser(prog="kjoint fit", description="values of parameters that meet targets")
    parser.add_argument("deck")
    parser.add_argument("engine", nargs="?")
    for name in ("--vary", "--measure", "--target", "--run"):
        parser.add_argument(name, action="append", default=[])
    parser.add_argument("--starts", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--output")
    parser.add_argument("--quiet", action="store_true")
    args = parser.read(words)

    def told(runs: int, misfit: float) -> None:
        if not args.quiet and sys.stderr.isatty():
            print(f"\r{runs} runs, misfit {misfit:.3g}   ", end="", file=sys.stderr, flush=True)

    def work() -> int:
        if not args.measure or len(args.measure) != len(args.target):
            raise ValueError("each --measure has its --target")
        if args.starts < 1:
            raise ValueError("--starts is at least 1")
        options, workers = run_options(args.run)
        found = fit(args.deck, {name: parse_bounds(spec) for name, spec in parse_varied(args.vary).items()},
                    list(zip(args.measure, args.target)), engine=args.engine, starts=args.starts, seed=args.seed,
                    workers=workers, told=told, **options)
        if args.output:
            with open(args.output, "w", encoding="utf-8") as file:
                json.dump(dataclasses.asdict(found), file, indent=1)
        if not args.quiet:
            if sys.stderr.isatty():
                print(file=sys.stderr)
            print(found.report())
        return 0

    return in_words(work, "stopped")


if __name__ == "__main__":
    sys.exit(main())
