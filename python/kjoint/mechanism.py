"""Mechanisms in a few lines: they become a Radioss deck, which kjoint reads."""
import pathlib
import tempfile

import numpy as np

from .joints import FREE, TYPES, type_number
from .model import Model

DOFS = ("tx", "ty", "tz", "rx", "ry", "rz")


def _reals(*values):
    """Fields of 20 columns: a digit less where an exponent has three."""
    return "".join(next(text for digits in (13, 12, 11)
                        if len(text := f"{value:20.{digits}e}") <= 20) for value in values)


def _ints(*values):
    """Fields of 10 columns."""
    fields = [f"{value:10d}" for value in values]
    if any(len(field) > 10 for field in fields):
        raise ValueError(f"a number of more than 10 digits among {values}")
    return "".join(fields)


def _line(text):
    """A text that is one line of a deck, and no keyword or comment there."""
    text = str(text)
    if not text.isprintable() or text.lstrip()[:1] in ("/", "#", "$"):
        raise ValueError(f"{text!r} cannot be a line of a deck: control characters, or / # $ "
                         "at its beginning")
    return text


class Mechanism:
    """Rigid bodies, joints between them, gravity. Units: kg, m, s, rad."""

    def __init__(self, title="mechanism", gravity=(0.0, 0.0, 0.0)):
        self.title, self.gravity = _line(title), gravity
        self._bodies, self._joints = [], []
        self._ground = None

    def body(self, mass, inertia, at, *, velocity=(0, 0, 0), omega=(0, 0, 0), name=None,
             held=False):
        """A body: mass, inertia about its centre (xx yy zz, or with xy yz xz), centre; gives a
        handle for joint()."""
        inertia = np.r_[np.asarray(inertia, dtype=float), np.zeros(6)][:6]
        number = len(self._bodies) + 1
        self._bodies.append(dict(mass=mass, inertia=inertia, at=np.asarray(at, dtype=float),
                                 velocity=velocity, omega=omega, held=held, nodes=[],
                                 name=_line(name or f"body {number}")))
        return number

    def ground(self):
        """The body that does not move."""
        if self._ground is None:
            self._ground = self.body(1.0, (1.0, 1.0, 1.0), (0, 0, 0), name="ground", held=True)
        return self._ground

    def joint(self, kind, body_1, body_2, at, axis=(1, 0, 0), axis_2=None, *, kn=1.0e7, cr=0.05,
              k=None, c=None, stops=None, friction=None, name=None):
        """A joint at a place. axis: x of its frame (universal: axis of body 1, axis_2 that of body
        2; else axis_2 gives its y). k, c: stiffness and damping of free directions, such as
        {"rx": 5.0}; stops: {"rx": (-1, 1)}; friction: {"rx": (limit, stiffness)}."""
        number = type_number(kind)
        axis = np.asarray(axis, dtype=float)/np.linalg.norm(axis)
        if axis_2 is None:
            axis_2 = np.eye(3)[np.argmin(abs(axis))]
        axis_2 = np.asarray(axis_2, dtype=float)
        if number != TYPES["universal"]:
            axis_2 = axis_2 - axis*(axis @ axis_2)
        for laws in (k, c, stops, friction):
            for dof in laws or {}:
                if not FREE[number][DOFS.index(dof)]:
                    raise ValueError(f"{dof} is not free in joint type {number}")
        self._joints.append(dict(type=number, bodies=(body_1, body_2), at=np.asarray(at, float),
                                 axes=(axis, axis_2/np.linalg.norm(axis_2)), kn=kn, cr=cr,
                                 k=k or {}, c=c or {}, stops=stops or {}, friction=friction or {},
                                 name=_line(name or f"joint {len(self._joints) + 1}")))
        return len(self._joints)

    def deck(self):
        """The starter deck as a text."""
        nodes, parts = [], []
        for number, joint in enumerate(self._joints, 1):
            parts += self._joint_cards(number, joint, nodes)
        for number, body in enumerate(self._bodies, 1):
            parts += self._body_cards(number, body)
            nodes.insert(number - 1, (number, body["at"]))
        lines = ["#RADIOSS STARTER", "/BEGIN", "mechanism", _ints(2022, 0)]
        lines += [("%20s"*3) % ("kg", "m", "s")]*2 + ["/TITLE", _line(self.title), "/NODE"]
        lines += [f"{node:10d}{_reals(*x)}" for node, x in nodes] + parts
        lines += ["/FUNCT/1", "one", _reals(0, 1), _reals(1, 1)]
        moving = [n for n, b in enumerate(self._bodies, 1) if not b["held"]]
        lines += ["/GRNOD/NODE/9000001", "moving bodies"] + [_ints(n) for n in moving]
        for axis, value in zip("XYZ", self.gravity):
            if value:
                lines += [f"/GRAV/{ord(axis)}", f"gravity {axis}", _ints(1) + f"{axis:>10s}"
                          + _ints(0, 0, 9000001) + " "*10 + _reals(1.0, value)]
        lines += ["/TH/SPRING/1", "joints", "DEF"]
        lines += [f"{n:10d}{j['name']:>20.20s}" for n, j in enumerate(self._joints, 1)]
        lines += ["/TH/RBODY/2", "bodies", "DEF"]
        lines += [_ints(n) for n in range(1, len(self._bodies) + 1)] + ["/END", ""]
        return "\n".join(lines)

    def _joint_cards(self, number, joint, nodes):
        first = 1000 + 10*number
        reach = (joint["at"], joint["at"], *(joint["at"] + axis for axis in joint["axes"]))
        nodes += [(first + i, x) for i, x in enumerate(reach)]
        one, two = (self._bodies[body - 1] for body in joint["bodies"])
        one["nodes"] += [first, first + 2, first + 3]
        two["nodes"].append(first + 1)
        cards = [f"/PROP/KJOINT2/{number}", joint["name"], _ints(joint["type"])
                 + _reals(joint["kn"], 0.0, joint["cr"]) + _ints(0, 0, 0)]
        for dof, free in zip(DOFS, FREE[joint["type"]]):
            if free:
                low, high = joint["stops"].get(dof, (0.0, 0.0))
                limit, stiffness = joint["friction"].get(dof, (0.0, 0.0))
                cards += [_reals(joint["k"].get(dof, 0.0)) + _ints(0) + _reals(low, high)
                          + _ints(0), _reals(joint["c"].get(dof, 0.0)) + _ints(0),
                          _reals(stiffness, limit) + _ints(0)]
        return cards + [f"/PART/{number}", joint["name"], _ints(number, 0, 0),
                        f"/SPRING/{number}", _ints(number, *range(first, first + 4))]

    @staticmethod
    def _body_cards(number, body):
        group, main = 9100000 + number, 9200000 + number
        cards = [f"/GRNOD/NODE/{group}", body["name"], *(_ints(n) for n in body["nodes"]),
                 f"/GRNOD/NODE/{main}", body["name"], _ints(number), f"/RBODY/{number}",
                 body["name"], _ints(number, 0, 0, 3) + _reals(body["mass"])
                 + _ints(group, 0, 3, 0), _reals(*body["inertia"][:3]),
                 _reals(*body["inertia"][3:]), _ints(0, 0)]
        if body["held"]:
            cards += [f"/BCS/{number}", body["name"], "   111 111" + _ints(0, main)]
        for kind, values, shift in (("TRA", body["velocity"], 0), ("ROT", body["omega"], 1)):
            if np.any(values):
                cards += [f"/INIVEL/{kind}/{2*number + shift}", body["name"],
                          _reals(*values) + _ints(main, 0)]
        return cards

    def model(self, until, sample, **options):
        """The mechanism as a Model, ready to run or to step."""
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "mechanism_0000.rad")
            path.write_text(self.deck(), encoding="utf-8")
            return Model(path, until=until, sample=sample, **options)

    def run(self, until, sample, **options):
        """Run it; samples as model["joint/force"], model.plot("rigid_body/position")."""
        return self.model(until, sample, **options).run()


__all__ = ["Mechanism", "TYPES"]
