#!/usr/bin/env python3
"""Plot channels of a history over time, one panel a channel.

usage: plot_history.py RUN.h5 -o PLOT.png [CHANNEL ...]

A channel is named as in the file: energy_error, joint/force, rigid_body/velocity. More precisely:

    joint/force[crank pin]          one joint, body or node, by its label or its id
    rigid_body/position[piston].x   one component: x, y, z, or w, x, y, z of a quaternion
    joint/force.norm                length of the vector

Without a name in brackets all entities are drawn; without a component the length of the vector, or
its components when there is one entity. Without channels: the energies, and the norm of force and
moment of the joints.
"""
import argparse
import re
import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ENERGIES = ("kinetic_energy_trans", "kinetic_energy_rot", "internal_energy", "external_work")
ENTITY = {"joint": "joint", "rigid_body": "body", "node": "node"}
COMPONENTS = {3: "xyz", 4: "wxyz"}
NAME = re.compile(r"^(?P<path>[\w/]+)(\[(?P<entity>[^\]]+)\])?(\.(?P<component>\w+))?$")
# Tableau's colours for the colour blind
COLOURS = ("#006ba4", "#ff800e", "#595959", "#5f9ed1", "#c85200", "#898989", "#a2c8ec", "#ffbc79")

DASHES = ("-", "--", "-", "-.")                # so that curves on each other are both seen


def fail(message):
    sys.exit(f"plot_history.py: {message}")


def unit_of(data):
    """Unit of a channel for people: N, J, N m where it is one of them, else kg m² s⁻²."""
    unit, kind = data.attrs.get("units", ""), data.attrs.get("channel_class", "")
    known = {("kg m s-2", "force"): "N", ("kg m2 s-2", "energy"): "J",
             ("kg m2 s-2", "moment"): "N m"}
    small = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    power = re.sub(r"(?<=[a-z])-?\d+", lambda found: found[0].translate(small), unit)
    return known.get((unit, kind), "" if unit == "1" else power)


def entities(file, group, wanted):
    """Rows of the entities that are asked for, with their labels."""
    ids = file[f"{group}/{ENTITY[group]}"][()]
    labels = [text.decode() for text in file[f"{group}/label"][()]]
    rows = range(len(ids))
    if wanted is not None:
        rows = [i for i in rows if wanted in (labels[i], str(ids[i]))]
        if not rows:
            fail(f'{group} has no "{wanted}"; it has: {", ".join(labels)}')
    return [(i, labels[i] or f"{ENTITY[group]} {ids[i]}") for i in rows]


def lines(file, name):
    """Unit, meaning and curves (label, values) of a channel as the command line names it."""
    match = NAME.match(name)
    if not match or match["path"] not in file or not isinstance(file[match["path"]], h5py.Dataset):
        fail(f'there is no channel "{name}"; `kjoint info` lists them')
    data = file[match["path"]]
    unit, meaning = unit_of(data), data.attrs.get("long_name", "")
    group = match["path"].rpartition("/")[0]
    if group == "":
        return unit, meaning, [(name, data[()])]
    if data.shape[:1] != file["time"].shape:
        fail(f"{name} does not change with time")
    rows, component = entities(file, group, match["entity"]), match["component"]
    if len(rows) == 1:
        meaning = f"{meaning}, {rows[0][1]}"
    if data.ndim == 2:
        return unit, meaning, [(label, data[:, i]) for i, label in rows]
    axes = COMPONENTS[data.shape[2]]
    if component is None and len(rows) == 1:
        return unit, meaning, [(axis, data[:, rows[0][0], k]) for k, axis in enumerate(axes)]
    if component in (None, "norm"):
        curves = [(label, (data[:, i]**2).sum(axis=1)**0.5) for i, label in rows]
        return unit, f"{meaning}, norm", curves
    if component not in axes:
        fail(f"{name}: components are {', '.join(axes)}, norm")
    curves = [(label, data[:, i, axes.index(component)]) for i, label in rows]
    return unit, f"{meaning}, {component}", curves


def standard_panels(file):
    """The energies, and what the joints carry."""
    panels = [(unit_of(file[ENERGIES[0]]), "energies",
               [(file[name].attrs["long_name"], file[name][()]) for name in ENERGIES])]
    if "joint" in file:
        panels += [lines(file, "joint/force.norm"), lines(file, "joint/moment.norm")]
    return panels


def draw(file, panels, path):
    """One panel below the other, one time axis."""
    plt.rcParams.update({"axes.prop_cycle": plt.cycler(color=COLOURS), "font.size": 9,
                         "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
                         "grid.color": "#e0e0e0", "axes.titlesize": 10, "lines.linewidth": 1.3})
    figure, axes = plt.subplots(len(panels), 1, sharex=True, squeeze=False, layout="constrained",
                                figsize=(8.0, 0.6 + 2.1 * len(panels)))
    time = file["time"]
    for axis, (unit, meaning, curves) in zip(axes[:, 0], panels):
        for k, (label, values) in enumerate(curves):
            axis.plot(time[()], values, DASHES[k % len(DASHES)], label=label)
        axis.set_title(meaning, loc="left")
        axis.set_ylabel(unit)
        axis.margins(x=0.0)
        if len(curves) > 1:
            axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    axes[-1, 0].set_xlabel(f"time [{time.attrs['units']}]")
    figure.suptitle(file.attrs.get("title", ""), fontsize=11, x=0.02, ha="left", weight="bold")
    figure.savefig(path, dpi=100)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("history", metavar="RUN.h5")
    parser.add_argument("-o", "--output", metavar="PLOT.png", required=True)
    parser.add_argument("channel", nargs="*", metavar="CHANNEL")
    options = parser.parse_intermixed_args()
    try:
        file = h5py.File(options.history)
    except OSError as problem:
        fail(f"{options.history} cannot be read: {problem}")
    with file:
        panels = [lines(file, name) for name in options.channel] or standard_panels(file)
        draw(file, panels, options.output)


if __name__ == "__main__":
    main()
