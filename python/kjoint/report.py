"""`kjoint report`: one page for a browser, without a network: summary, findings, the mechanism with a
time slider, joints with peaks and curves, energies, a comparison, provenance.

usage: python3 -m kjoint.report --output RUN.html RUN.h5 [REF.h5]
"""
from __future__ import annotations

import base64
import gzip
import html
import json
import pathlib
import string
import tempfile
from typing import Any

from ._error import Parser
from ._scene import Scene
from ._show import Units, call, command, fail, need

MOST_SAMPLES = 2000                              # of curves; more are thinned evenly
MOST_FRAMES = 200                                # of the moving picture
PANELS = (("force", "force", "xyz"), ("moment", "moment", "xyz"),
          ("displacement", "displacement", "xyz"), ("rotation", "rotation", "xyz"))
ENERGIES = ("kinetic_energy_trans", "kinetic_energy_rot", "internal_energy", "external_work",
            "potential_energy")


class Numbers:
    """All series as 16-bit steps between their least and largest value, in one block."""

    def __init__(self, np: Any) -> None:
        self.np, self.n = np, 0
        self.blocks: list[Any] = []

    def add(self, values: Any) -> Any:
        np = self.np
        values = np.asarray(values, float).ravel()
        good = np.isfinite(values)
        low, high = (values[good].min(), values[good].max()) if good.any() else (0.0, 0.0)
        steps = np.zeros(len(values)) if high == low else (values - low) / (high - low) * 65534
        block = np.where(good, np.nan_to_num(np.rint(steps)), 65535).astype("<u2")
        self.blocks.append(block)
        at, self.n = self.n, self.n + len(block)
        return {"at": at, "n": len(block), "min": float(low), "max": float(high)}

    def packed(self) -> Any:
        return packed(self.np.concatenate(self.blocks).tobytes())


def packed(data: Any) -> Any:
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()


class Page:
    def __init__(self, path: Any, reference: Any) -> None:
        self.np, self.h5py, self.plotly = need("report", "numpy", "h5py", "plotly")
        self.path, self.reference = path, reference
        self.info = json.loads(call("info", path, "--json"))
        self.folder = tempfile.TemporaryDirectory()
        self.numbers = Numbers(self.np)
        with self.opened(path) as run:
            self.units = self.units_of(run)
            self.read(run)

    def opened(self, path: Any) -> Any:
        """A history; a T01 becomes one first."""
        if self.h5py.is_hdf5(path):
            return self.h5py.File(path, "r")
        target = pathlib.Path(self.folder.name) / "converted.h5"
        call("convert", path, "-o", target)
        return self.h5py.File(target, "r")

    def units_of(self, run: Any) -> Any:
        return Units(None, {"unit_si": list(run.attrs["unit_si"]), "unit_symbol":
                            [run.attrs[f"unit_{name}"] for name in ("mass", "length", "time")]})

    def unit(self, dimension: Any, kind: Any = "", angle: Any = False) -> Any:
        return self.units.of({"dimension": dimension, "angle": angle, "class": kind})[1]

    # ---- numbers

    def read(self, run: Any) -> None:
        np = self.np
        stride = max(1, -(-len(run["time"]) // MOST_SAMPLES))
        keep = np.arange(0, len(run["time"]), stride)
        if keep[-1] != len(run["time"]) - 1:
            keep = np.append(keep, len(run["time"]) - 1)
        self.time, self.keep = run["time"][()][keep], keep
        unit_t = self.unit([0, 0, 1])
        self.meta: dict[str, Any] = {"time": {**self.numbers.add(self.time), "label": f"time [{unit_t}]",
                              "unit": unit_t}}
        joint = run.get("joint")
        self.joints = self.table(run, joint) if joint is not None else []
        self.meta["joints"] = [{"id": int(j["id"]), "name": j["name"]} for j in self.joints]
        labels = {"force": self.unit([1, 1, -2], "force"), "moment": self.unit([1, 2, -2]),
                  "displacement": self.unit([0, 1, 0]), "rotation": "rad"}
        self.meta["panels"] = [{"key": key, "label": f"{key} [{labels[key]}]", "names":
                                [f"{key} {c}" for c in axes]} for key, _, axes in PANELS
                               if joint is not None and key in joint]
        self.meta["curves"] = self.curves(joint, keep, range(len(self.joints)))
        self.meta["load_labels"] = {"force": f"force [{labels['force']}]", "gap":
                                    f"gap [{labels['displacement']}]",
                                    "moment": f"moment [{labels['moment']}]"}
        self.meta["loads"] = {key: [self.numbers.add(values[keep]) for values in columns]
                              for key, columns in self.load_columns(joint).items()}
        self.meta["mechanism"] = self.mechanism(run, joint, keep)
        self.energies(run, keep)
        self.provenance = dict(run["run"].attrs) if "run" in run else {}
        self.inputs = {name: (text.asstr()[()], text.attrs["role"], text.attrs["sha256"])
                       for name, text in run.get("input", {}).items()}

    def load_columns(self, joint: Any) -> Any:
        if joint is None:
            return {}
        norm = self.np.linalg.norm
        columns = {key: norm(joint[key][()], axis=2).T for key in ("force", "moment") if key in joint}
        if "violation_trans" in joint:
            columns["gap"] = joint["violation_trans"][()].T
        return columns

    def curves(self, joint: Any, keep: Any, rows: Any) -> Any:
        found = []
        data = {key: joint[name][()][keep] for key, name, _ in PANELS
                if joint is not None and name in joint}
        for j in rows:
            found.append({key: [self.numbers.add(values[:, j, c]) for c in range(3)]
                          for key, values in data.items()} if j is not None else None)
        return found

    def mechanism(self, run: Any, joint: Any, keep: Any) -> Any:
        if joint is None or "position" not in joint:
            return None
        np = self.np
        scene = Scene(self.path, "report")
        frames = np.unique(np.linspace(0, len(keep) - 1, min(len(keep), MOST_FRAMES)).astype(int))
        middle, reach = scene.box()
        flat = scene.flat_direction()
        eye, up = {"x": 1.2, "y": -1.6, "z": 0.9}, {"x": 0, "y": 0, "z": 1}
        if flat is not None:                     # a plane mechanism is seen along its normal
            eye = {axis: (0.0, 2.0)[k == flat] * (-1 if flat == 1 else 1) for k, axis in
                   enumerate("xyz")}
            up = {"x": 0, "y": int(flat == 2), "z": int(flat != 2)}
        return {"frames": frames.tolist(), "segments": scene.segments.tolist(),
                "n_point": scene.points.shape[1], "middle": middle.tolist(), "reach": 1.15 * reach,
                "unit": self.unit([0, 1, 0]), "eye": eye, "up": up,
                "points": self.numbers.add(scene.points[keep][frames]),
                "places": self.numbers.add(scene.joints[keep][frames])}

    def energies(self, run: Any, keep: Any) -> None:
        unit = self.unit([1, 2, -2], "energy")
        self.meta["energy_label"] = f"energy [{unit}]"
        self.meta["energies"] = [
            {"name": run[name].attrs["long_name"], "error": False,
             "series": self.numbers.add(run[name][()][keep])} for name in ENERGIES if name in run]
        if "energy_error" in run:
            self.meta["energies"].append({"name": "energy error", "error": True, "series":
                                          self.numbers.add(100 * run["energy_error"][()][keep])})

    def table(self, run: Any, joint: Any) -> Any:
        """One row a joint: its peaks, and the gap over its longer arm."""
        np = self.np
        arms = {}
        if "point" in run:
            arms = {int(node): float(np.linalg.norm(p)) for node, p in
                    zip(run["point/node"][()], run["point/position"][()])}
        rows, time = [], run["time"][()]
        columns = self.load_columns(joint)
        labels = joint["label"].asstr()[()] if "label" in joint else [""] * len(joint["joint"])
        for j, i in enumerate(joint["joint"][()]):
            row = {"id": i, "name": f"{labels[j]} ({i})" if labels[j] else str(i),
                   "kind": joint["kind"].asstr()[j] if "kind" in joint else ""}
            for key, values in columns.items():
                k = int(np.nanargmax(values[j]))
                row[key] = float(values[j][k]), float(time[k])
            if "violation_rot" in joint:
                row["turn"] = float(np.nanmax(joint["violation_rot"][:, j]))
            if "blocking_trans" in joint:
                row["kn"] = float(joint["blocking_trans"][j])
            if "node1" in joint and "gap" in row:
                arm = max(arms.get(int(joint[f"node{e}"][j]), 0.0) for e in (1, 2))
                if arm > 0:
                    row["share"] = row["gap"][0] / arm
            rows.append(row)
        return rows

    # ---- words

    def summary(self) -> Any:
        info, worst = self.info, self.info["worst"]
        lines = [("status", self.provenance.get("status", "T01"))]
        if info["samples"]:
            lines.append(("samples", f"{info['samples']}, t = {info['first_time']:.6g} to "
                          f"{info['last_time']:.6g} {self.unit([0, 0, 1])}"))
        units = {"gap": self.unit([0, 1, 0]), "force": self.unit([1, 1, -2], "force"),
                 "moment": self.unit([1, 2, -2]), "angular_velocity": self.unit([0, 0, -1], "", True),
                 "stop_gap": self.unit([0, 1, 0]), "stop_gap_rotation": "rad"}
        names = {"gap": "largest gap", "force": "peak force", "moment": "peak moment",
                 "angular_velocity": "fastest turn", "stop_gap": "nearest stop",
                 "stop_gap_rotation": "nearest stop"}
        for key, name in names.items():
            if key in worst:
                w = worst[key]
                lines.append((name, f"{w['value']:.4g} {units[key]} of {w['name']} at t = "
                              f"{w['time']:.4g}" + (f", force {w['force']:.4g} {units['force']}"
                                                    if key == "gap" else "")))
        return rows(lines)

    def findings(self) -> Any:
        """What the joints did, and what `kjoint check` says of the decks in the history."""
        items = [f'<li class="bad">{html.escape(j["name"])} gave way by {100 * j["share"]:.2g} % of '
                 "its arm</li>" for j in self.joints if j.get("share", 0) > 0.01]
        starter = next((name for name, (_, role, _) in self.inputs.items() if role == "starter"), None)
        if starter:
            folder = pathlib.Path(self.folder.name)
            for name, (text, _, _) in self.inputs.items():
                (folder / pathlib.Path(name).name).write_text(text, encoding="utf-8")
            words = ["check", folder / pathlib.Path(starter).name, "--json"]
            words += ["--legacy"] if "--legacy" in self.provenance.get("command_line", "") else []
            told = json.loads(call(*words, codes=(0, 1, 2)))
            items += [f'<li>{f["severity"]} {f.get("id", "")}: {html.escape(f["message"])}</li>'
                      for f in told["findings"] if f["severity"] != "note"]
        return f"<ul>{''.join(items)}</ul>" if items else "<p>None.</p>"

    def joint_table(self) -> Any:
        if not self.joints:
            return "<p>The history holds no joints.</p>"
        f, m, x = (self.unit([1, 1, -2], "force"), self.unit([1, 2, -2]), self.unit([0, 1, 0]))
        head = (f"<tr><th>joint<th>type<th class=n>peak force [{f}]<th class=n>at t"
                f"<th class=n>peak moment [{m}]<th class=n>at t<th class=n>gap [{x}]<th class=n>at t"
                "<th class=n>% of arm<th class=n>blocked turn [rad]<th class=n>Kn</tr>")
        body = []
        for j in self.joints:
            cells = [f"<td>{html.escape(j['name'])}<td>{j['kind']}"]
            for key in ("force", "moment", "gap"):
                value, t = j.get(key, (None, None))
                cells.append(f"<td class=n>{number(value)}<td class=n>{number(t)}")
            share = j.get("share")
            bad = " bad" if share and share > 0.01 else ""
            cells.append(f'<td class="n{bad}">{number(100 * share if share is not None else None)}'
                         f"<td class=n>{number(j.get('turn'))}<td class=n>{number(j.get('kn'))}")
            body.append(f"<tr>{''.join(cells)}</tr>")
        return f'<table id="joints"><thead>{head}</thead><tbody>{"".join(body)}</tbody></table>'

    def comparison(self) -> Any:
        if not self.reference:
            return ""
        told = json.loads(call("diff", self.reference, self.path, "--json", codes=(0, 1)))
        with self.opened(self.reference) as run:
            if "joint" in run:
                ids = list(run["joint/joint"][()])
                rows_of = [ids.index(j["id"]) if j["id"] in ids else None for j in self.joints]
                keep = self.np.unique(self.np.linspace(0, len(run["time"]) - 1, min(
                    len(run["time"]), MOST_SAMPLES)).astype(int))
                self.meta["reference"] = {"time": self.numbers.add(run["time"][()][keep]),
                                          "curves": self.curves(run["joint"], keep, rows_of)}
        worst = "".join(f"<tr><td>{html.escape(c['title'])}<td class=n>{number(c.get('difference'))}"
                        f"<td class=n>{number(c.get('tolerance'))}<td class=n>{number(c.get('time'))}"
                        "</tr>" for c in told["channel"] if c["name"] in told["worst"][:10])
        return (f"<h2>Comparison with {html.escape(str(self.reference))}</h2>"
                f"<p>{html.escape(told['summary'])}</p>"
                "<table><tr><th>worst channels<th class=n>difference<th class=n>tolerance"
                f"<th class=n>at t</tr>{worst}</table>"
                '<p class="dim">The curves above show the reference dashed.</p>')

    def origin(self) -> Any:
        lines = [(name, str(value)) for name, value in self.provenance.items()]
        lines += [(f"{role} deck", f"{name}, SHA-256 {sha}") for name, (_, role, sha) in
                  self.inputs.items()]
        if len(self.keep) < self.info["samples"]:
            lines.append(("curves", f"{len(self.keep)} of {self.info['samples']} samples are drawn"))
        return rows(lines)

    def write(self, path: Any) -> None:
        template = pathlib.Path(__file__).with_name("report.html").read_text(encoding="utf-8")
        code = pathlib.Path(self.plotly.__file__).parent / "package_data" / "plotly.min.js"
        comparison = self.comparison()
        title = self.info["title"] or pathlib.Path(self.path).name
        text = string.Template(template.replace("${", "$${")).safe_substitute(
            title=html.escape(title), subtitle=html.escape(
                f"{self.path}, kjoint {self.provenance.get('version', '')}"),
            summary=self.summary(), findings=self.findings(), joints=self.joint_table(),
            comparison=comparison, provenance=self.origin(), plotly=packed(code.read_bytes()),
            numbers=self.numbers.packed(),
            meta=json.dumps(self.meta, separators=(",", ":")).replace("</", "<\\/"))
        pathlib.Path(path).write_text(text, encoding="utf-8", errors="replace")     # names may be no UTF-8


def rows(lines: Any) -> Any:
    return "<table>" + "".join(f"<tr><td class=dim>{html.escape(name)}<td>{html.escape(value)}</tr>"
                               for name, value in lines) + "</table>"


def number(value: Any) -> Any:
    return "" if value is None else f"{value:.4g}"


def main() -> None:
    parser = Parser(prog="kjoint report")
    parser.add_argument("run")
    parser.add_argument("reference", nargs="?")
    parser.add_argument("--output", required=True)
    options = parser.read()
    page = Page(options.run, options.reference)
    try:
        page.write(options.output)
    except OSError as problem:
        fail(f"cannot write {options.output}: {problem}", 3)
    print(options.output)


if __name__ == "__main__":
    command(main)
