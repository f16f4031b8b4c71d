"""`kjoint plot`: channels over time, several runs over one another, their differences below.

usage: python3 -m kjoint.plot --output FILE [--units LIST] RUN.h5 [CHANNEL ...] [OTHER.h5 ...]
"""
from __future__ import annotations

import os
from typing import Any

from ._error import Parser
from ._show import COLOURS, Units, command, export, fail, need

STANDARD = ["kinetic_energy_* internal_energy external_work", "joint/force.norm", "joint/moment.norm"]
DASHES = ("-", "--", ":", "-.")


def panels(runs: Any, words: Any) -> Any:
    """For each word the series of each run: [(word, [{name: series} a run])]."""
    found: list[Any] = []
    for k, run in enumerate(runs):
        for i, word in enumerate(words):
            told = export(run, [word])
            if k == 0:
                found.append((word, []))
            found[i][1].append(told)
    return found


def draw(runs: Any, words: Any, units: Any, path: Any) -> None:
    np, plt = need("plot", "numpy", "matplotlib.pyplot")
    plt.switch_backend("Agg")
    plt.rcParams.update({"axes.prop_cycle": plt.cycler(color=COLOURS), "font.size": 9,
                         "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
                         "grid.color": "#e0e0e0", "axes.titlesize": 10, "lines.linewidth": 1.3})
    rows = panels(runs, words)
    with_difference = len(runs) > 1
    heights = [h for _ in rows for h in ((2.1, 0.9) if with_difference else (2.1,))]
    figure, axes = plt.subplots(len(heights), 1, sharex=True, squeeze=False, layout="constrained",
                                figsize=(8.5, 0.6 + sum(heights)),
                                gridspec_kw={"height_ratios": heights})
    axes = iter(axes[:, 0])
    for word, told in rows:
        draw_panel(np, next(axes), next(axes) if with_difference else None, word, told, runs, units)
    factor, unit = Units(units, rows[0][1][0]).of({"dimension": [0, 0, 1], "angle": False,
                                                   "class": "time"})
    figure.axes[-1].set_xlabel(f"time [{unit}]")
    figure.suptitle(rows[0][1][0]["title"], fontsize=11, x=0.02, ha="left", weight="bold")
    figure.savefig(path, dpi=110)


def draw_panel(np: Any, axis: Any, below: Any, word: Any, told: Any, runs: Any, units: Any) -> None:
    """One word: a colour a series, a dash a run; below, what the others have more than the first."""
    first = {}
    label_of = common(told[0]["series"])
    names = set()
    for k, run in enumerate(told):
        scale = Units(units, run)
        time = np.array(run["time"]["values"]) * scale.of(
            {"dimension": [0, 0, 1], "angle": False, "class": "time"})[0]
        for i, series in enumerate(run["series"]):
            factor, unit = scale.of(series)
            names.add(unit)
            values = np.array(series["values"]) * factor
            label = label_of(series) + (f", {runs[k]}" if len(runs) > 1 else "")
            axis.plot(time, values, DASHES[k % 4] if len(runs) > 1 else DASHES[i % 2],
                      color=COLOURS[i % len(COLOURS)], label=label)
            if k == 0:
                first[key(series)] = time, values
            elif key(series) in first:
                t0, y0 = first[key(series)]
                inside = (t0 >= time[0]) & (t0 <= time[-1])
                below.plot(t0[inside], np.interp(t0[inside], time, values) - y0[inside],
                           DASHES[k % 4], color=COLOURS[i % len(COLOURS)])
    meanings = {series["meaning"] for series in told[0]["series"]}
    axis.set_title(f"{word}: {meanings.pop()}" if len(meanings) == 1 else word, loc="left")
    axis.set_ylabel(" or ".join(sorted(names)))
    axis.margins(x=0.0)
    if below is not None:
        below.set_ylabel("difference")
        below.margins(x=0.0)
    axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)


def key(series: Any) -> Any:
    """The same thing in another run, whatever its label is there."""
    return series["channel"], series.get("entity"), series.get("component")


def common(series: Any) -> Any:
    """Labels without what all series of a panel share."""
    channels = {s["channel"] for s in series}
    entities = {s.get("entity") for s in series}

    def label(s: Any) -> Any:
        entity = s["name"].partition("[")[2].rpartition("]")[0]
        parts = [s["channel"]] if len(channels) > 1 else []
        if len(entities) > 1 or not (s.get("component") or parts):
            parts.append(entity or s["channel"])
        if s.get("component"):
            parts.append(s["component"])
        return " ".join(parts)
    return label


def is_history(word: str) -> bool:
    """A file of this name is there, or the name is one of a history; else it names channels."""
    return word.endswith(".h5") or os.path.exists(word)


def main() -> None:
    parser = Parser(prog="kjoint plot")
    parser.add_argument("words", nargs="+")
    parser.add_argument("--units")
    parser.add_argument("--output", required=True)
    options = parser.read()
    first, *others = options.words
    runs = [first] + [word for word in others if is_history(word)]
    names = [word for word in others if not is_history(word)]
    try:
        draw(runs, names or STANDARD, options.units, options.output)
    except (OSError, ValueError) as problem:
        fail(f"cannot write {options.output}: {problem}", 3)
    print(options.output)


if __name__ == "__main__":
    command(main)
