"""The mechanism of a history as points, lines and numbers at any sample."""
from __future__ import annotations

import pathlib
import tempfile
from typing import Any

from ._show import Units, call, fail, need


class Scene:
    """Joints and bodies of a history; arrays are (sample, ...), in the units of the history.

    joints    (sample, joint, 3) where joints act
    points    (sample, point, 3) what bodies carry, segments join them
    loads     {"force": (sample, joint), "moment", "gap"}: norms
    """

    def __init__(self, path: Any, what: Any) -> None:
        self.np, self.h5py = need(what, "numpy", "h5py")
        np = self.np
        try:
            run = self.h5py.File(path, "r")
        except OSError:
            run = self.converted(path)
        with run:
            if "joint/position" not in run and "point" not in run:
                fail(f"{path} does not say where joints and bodies are: it is a T01, or was written "
                     "by a kjoint that did not keep that")
            self.title = run.attrs.get("title", "")
            symbols = [run.attrs[f"unit_{name}"] for name in ("mass", "length", "time")]
            units = Units(None, {"unit_si": list(run.attrs["unit_si"]), "unit_symbol": symbols})
            self.units = {"length": symbols[1], "time": symbols[2], "gap": symbols[1]}
            for name, power in (("force", [1, 1, -2]), ("moment", [1, 2, -2])):
                self.units[name] = units.of({"dimension": power, "angle": False, "class": name})[1]
            self.time = run["time"][()]
            n = len(self.time)
            joint = run.get("joint", {})
            self.joint_ids = joint["joint"][()] if joint else np.zeros(0, int)
            self.names = [f"{label} ({i})" if label else str(i) for label, i in
                          zip(joint["label"].asstr()[()] if joint else [], self.joint_ids)]
            self.kinds = list(joint["kind"].asstr()[()]) if joint else []
            self.joints = joint["position"][()] if joint else np.zeros((n, 0, 3))
            self.loads = {}
            for name, key in (("force", "force"), ("moment", "moment")):
                if joint:
                    self.loads[name] = np.linalg.norm(joint[key][()], axis=2)
            if joint:
                self.loads["gap"] = joint["violation_trans"][()]
            self.points, self.segments = self.bodies(run, n)

    def converted(self, path: Any) -> Any:
        """A T01 as a history."""
        self.folder = tempfile.TemporaryDirectory()
        target = pathlib.Path(self.folder.name) / "converted.h5"
        call("convert", path, "-o", target)
        return self.h5py.File(target, "r")

    def bodies(self, run: Any, n: Any) -> Any:
        np = self.np
        if "point" not in run or "segment" not in run:
            return np.zeros((n, 0, 3)), np.zeros((0, 2), int)
        ids = list(run["rigid_body/body"][()])
        owner = np.array([ids.index(body) for body in run["point/body"][()]])
        segments = np.stack([run["segment/point1"][()], run["segment/point2"][()]], axis=1)
        used, segments = np.unique(segments, return_inverse=True)
        p, owner = run["point/position"][()][used], owner[used]
        q = run["rigid_body/orientation"][()][:, owner]
        u = q[..., 1:]
        p = np.broadcast_to(p, u.shape)
        turned = p + 2.0 * np.cross(u, np.cross(u, p) + q[..., :1] * p)
        self.point_body = owner
        return run["rigid_body/position"][()][:, owner] + turned, segments.reshape(-1, 2)

    def box(self) -> Any:
        """Middle and half the longest side of what the mechanism reaches."""
        np = self.np
        everything = np.concatenate([self.joints.reshape(-1, 3), self.points.reshape(-1, 3)])
        if not len(everything):
            fail("the history holds neither joints nor bodies")
        low, high = np.nanmin(everything, axis=0), np.nanmax(everything, axis=0)
        return 0.5 * (low + high), max(0.5 * (high - low).max(), 1e-12)

    def flat_direction(self) -> Any:
        """The axis across which the mechanism reaches least: a plane mechanism is seen along it."""
        np = self.np
        everything = np.concatenate([self.joints.reshape(-1, 3), self.points.reshape(-1, 3)])
        reach = everything.max(axis=0) - everything.min(axis=0)
        return int(reach.argmin()) if reach.min() < 0.02 * reach.max() else None
