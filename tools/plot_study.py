#!/usr/bin/env python3
"""Draw the speed-accuracy trade of a deck from the table that `kjoint study` writes.

usage: plot_study.py STUDY.json [-o OUT.png]

Left: error against cost, the settings that nothing beats (no other is cheaper and more accurate)
joined by a line. Right: error against the time step, with lines of first and second order.
"""
import argparse
import json
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter

STYLES = {"split2": ("tab:blue", "o"), "liemid": ("tab:green", "s"), "rkmk4": ("tab:purple", "^"),
          "legacy": ("tab:red", "D"), "compliant": ("tab:orange", "v"), "other Kn": ("tab:cyan", "o")}
MEANING = {"split2": "consistent, split2", "liemid": "consistent, liemid", "rkmk4": "consistent, rkmk4",
           "legacy": "legacy", "compliant": "compliant, ideal joints", "other Kn": "other Kn"}


def families(settings):
    """Settings by integrator; those with scaled stiffness are a family of their own."""
    groups = {}
    for setting in settings:
        name = setting["integrator"] if setting["kn_scale"] == 1 else "other Kn"
        if setting["good"] and setting["error"] > 0:
            groups.setdefault(name, []).append(setting)
    return groups


def draw_trade(axes, study, groups):
    every = [s for group in groups.values() for s in group]
    front = sorted((s for s in every if s["unbeaten"]), key=lambda s: s["cpu_s"])
    axes.plot([s["cpu_s"] for s in front], [s["error"] for s in front], color="0.75", lw=6, zorder=0,
              solid_capstyle="round", label="nothing is cheaper and better")
    for name, group in groups.items():
        colour, mark = STYLES[name]
        hollow = {"mfc": "none"} if name == "other Kn" else {}
        axes.plot([s["cpu_s"] for s in group], [s["error"] for s in group], mark + "-", color=colour, lw=1,
                  label=MEANING[name], **hollow)
        for s in group:
            if name == "liemid" and s not in front:
                continue                       # it lies beside split2, label on label
            text = f"Kn x {s['kn_scale']:g}" if name == "other Kn" else f"{s['dt_scale']:g}"
            axes.annotate(text, (s["cpu_s"], s["error"]), textcoords="offset points", xytext=(6, 3), fontsize=7,
                          color=colour)
    if study["recommended"]:
        chosen = study["settings"][study["recommended"] - 1]
        axes.plot(chosen["cpu_s"], chosen["error"], "o", ms=16, mfc="none", mec="k", mew=1.2,
                  label=f"recommended for {study['wanted_error']:.0e}")
    axes.axhline(study["wanted_error"], color="k", lw=0.8, ls=":")
    axes.set(xscale="log", yscale="log", xlabel="time of a processor [s]",
             ylabel="error of positions and rotations, over their peak")
    axes.legend(fontsize=8, loc="best", framealpha=0.6)
    axes.set_title("what accuracy costs (labels: --dt-scale)", fontsize=10)


def draw_order(axes, study, groups):
    for name, group in groups.items():
        if name in ("other Kn", "compliant"):
            continue
        colour, mark = STYLES[name]
        order = study["orders"].get(name, 0)
        label = MEANING[name] + (f": order {order:.2f}" if order else "")
        axes.plot([s["step"] for s in group], [s["error_of_steps"] for s in group], mark + "-", color=colour, lw=1, label=label)
    steps = [s["step"] for name, group in groups.items()
             if name not in ("other Kn", "compliant") for s in group]
    errors = [s["error_of_steps"] for s in groups.get("split2", []) or next(iter(groups.values()))]
    ends = [min(steps), max(steps)]
    for order, dash in ((1, "--"), (2, "-.")):
        axes.plot(ends, [0.3 * max(errors) * (h / ends[1]) ** order for h in ends], "k" + dash, lw=0.7, alpha=0.5,
                  label=f"slope {order}")
    axes.set(xscale="log", yscale="log", xlabel="mean time step", ylabel="error of the steps alone")
    axes.legend(fontsize=8, loc="best")
    axes.set_title("how the error falls with the step", fontsize=10)


def count(n, noun):
    """1 joint, 2 joints; 1 rigid body, 2 rigid bodies"""
    if noun.endswith("bod"):
        return f"{n} {noun}{'y' if n == 1 else 'ies'}"
    return f"{n} {noun}{'' if n == 1 else 's'}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("study", help="STUDY.json of `kjoint study`")
    parser.add_argument("-o", "--output", help="picture to write; default: STUDY.png")
    arguments = parser.parse_args()
    study = json.loads(pathlib.Path(arguments.study).read_text(encoding="utf-8"))
    groups = families(study["settings"])
    if not groups:
        parser.error("no setting of this study ran to its end")
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), constrained_layout=True)
    draw_trade(left, study, groups)
    draw_order(right, study, groups)
    for axes in (left, right):
        axes.grid(True, which="major", lw=0.3)
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.xaxis.set_major_locator(LogLocator(numticks=8))
    figure.suptitle(f"{study['title']} ({count(study['joints'], 'joint')}, {count(study['bodies'], 'rigid bod')})",
                    fontsize=11)
    output = arguments.output or str(pathlib.Path(arguments.study).with_suffix(".png"))
    figure.savefig(output, dpi=110)
    print(output)


if __name__ == "__main__":
    main()
