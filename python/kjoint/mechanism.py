"""Mechanisms in a few lines: they become a Radioss deck, which kjoint reads."""
from __future__ import annotations

import itertools
import pathlib
from typing import TYPE_CHECKING, Any, Callable, Iterable, Mapping, Sequence, Union

import numpy as np
import numpy.typing as npt

from ._error import Error, unknown
from .joints import FREE, TYPES, type_number
from .model import DeckText, Model
from .samples import Array, Path

if TYPE_CHECKING:
    import xarray

DOFS = ("tx", "ty", "tz", "rx", "ry", "rz")
#: A constant, or points of a function: [(x, y), ...] with x ascending
Law = Union[float, Sequence[Sequence[float]]]
FREE_NODES, FREE_ELEMENTS = 5_000_000, 1_000_000  # first ids of nodes and elements beside joints


def _reals(*values: float) -> str:
    """Fields of 20 columns: a digit less where an exponent has three."""
    return "".join(next(text for digits in (13, 12, 11)
                        if len(text := f"{value:20.{digits}e}") <= 20) for value in values)


def _ints(*values: int) -> str:
    """Fields of 10 columns."""
    fields = [f"{value:10d}" for value in values]
    if any(len(field) > 10 for field in fields):
        raise Error(f"a number of more than 10 digits among {values}")
    return "".join(fields)


def _line(text: object) -> str:
    """A text that is one line of a deck, and no keyword or comment there."""
    text = str(text)
    if not text.isprintable() or text.lstrip()[:1] in ("/", "#", "$"):
        raise Error(f"{text!r} cannot be a line of a deck: control characters, or / # $ "
                    "at its beginning")
    return text


def _vector(values: npt.ArrayLike, what: str) -> Array:
    """Three finite numbers."""
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise Error(f"{what} {values!r} are no numbers") from error
    if array.shape != (3,) or not np.all(np.isfinite(array)):
        raise Error(f"{what} {values!r} are not three numbers")
    return array


def _unit(values: npt.ArrayLike, what: str) -> Array:
    """A direction as a unit vector."""
    array = _vector(values, what)
    length = float(np.linalg.norm(array))
    if length == 0.0:
        raise Error(f"{what} is zero")
    return np.asarray(array/length, dtype=float)


def _at_least(value: float, least: float, what: str) -> float:
    """A finite number that is not below another."""
    if not (np.isfinite(value) and value >= least):
        raise Error(f"{what} is {value:g}, it cannot be below {least:g}")
    return float(value)


class Mechanism:
    """Rigid bodies, joints and springs between them, gravity, loads, driven bodies.

    units: those of mass, length and time; all else follows, angles are in radian. gravity
    [length/time^2]. What is wrong raises kjoint.Error at the call. Bodies go by the number that
    body() gave or by name.

    >>> import kjoint
    >>> m = kjoint.Mechanism("pendulum", gravity=(0, 0, -9.81))
    >>> bar = m.body(2.0, (0.02, 0.17, 0.17), at=(0.5, 0, 0), name="bar")      # kg, kg m2, m
    >>> hinge = m.joint("revolute", m.ground(), bar, at=(0, 0, 0), axis=(0, 1, 0), name="hinge")
    >>> run = m.run(until=1.0, sample=0.01)                                    # s
    >>> run["joint/force[hinge].norm"].shape                                   # N
    (101,)
    """

    def __init__(self, title: str = "mechanism", gravity: npt.ArrayLike = (0.0, 0.0, 0.0),
                 units: Sequence[str] = ("kg", "m", "s")) -> None:
        self.title, self.gravity, self.units = _line(title), _vector(gravity, "gravity"), tuple(units)
        self._bodies: list[dict[str, Any]] = []
        self._joints: list[dict[str, Any]] = []
        self._springs: list[list[str]] = []       # cards of property, part, element
        self._spring_names: list[str] = []
        self._actions: list[str] = []             # cards of loads and driven bodies, skews
        self._curves: list[Array] = []
        self._nodes: list[tuple[int, Array]] = []
        self._ids = itertools.count(1)            # of loads, driven bodies and their skews
        self._ground = 0

    # ---- what is built

    def body(self, mass: float, inertia: npt.ArrayLike, at: npt.ArrayLike, *,
             velocity: npt.ArrayLike = (0, 0, 0), omega: npt.ArrayLike = (0, 0, 0),
             name: str | None = None, held: bool = False) -> int:
        """A rigid body; gives its number.

        mass; inertia about its centre [mass length^2], xx yy zz, or with xy yz xz; at: its centre
        [length]; velocity of the centre [length/time] and omega [rad/time] at the start, global
        frame; held: it stays where it is.

        >>> import kjoint
        >>> m = kjoint.Mechanism()
        >>> m.body(1.5, (0.01, 0.1, 0.1), at=(0.5, 0, 0), omega=(0, 2, 0), name="crank")
        1
        >>> m.body(-1.0, (1, 1, 1), at=(0, 0, 0))
        Traceback (most recent call last):
        kjoint.Error: mass of body 2 is -1, it must be above 0
        """
        number = len(self._bodies) + 1
        called = _line(name or f"body {number}")
        if called in (body["name"] for body in self._bodies):
            raise Error(f"there is a body {called!r} already")
        given = np.ravel(np.asarray(inertia, dtype=float))
        if len(given) not in (3, 6):
            raise Error(f"inertia of {called} has {len(given)} numbers: xx yy zz, or with xy yz xz")
        j = np.r_[given, np.zeros(6)][:6]
        principal = np.linalg.eigvalsh([[j[0], j[3], j[5]], [j[3], j[1], j[4]], [j[5], j[4], j[2]]])
        for what, value in (("mass", mass), ("least inertia", principal[0])):
            if not (np.isfinite(value) and value > 0):
                raise Error(f"{what} of {called} is {value:g}, it must be above 0")
        if principal[2] > (1 + 1e-9)*(principal[0] + principal[1]):
            raise Error(f"inertia of {called}: no body has a principal moment, {principal[2]:g}, above "
                        f"the sum of the others, {principal[0]:g} + {principal[1]:g}")
        self._bodies.append(dict(mass=float(mass), inertia=j, at=_vector(at, f"the place of {called}"),
                                 velocity=_vector(velocity, "velocity"), omega=_vector(omega, "omega"),
                                 held=held, nodes=[], name=called))
        return number

    def ground(self, name: str = "ground") -> int:
        """The body that does not move.

        >>> import kjoint
        >>> m = kjoint.Mechanism()
        >>> m.ground() == m.ground()
        True
        """
        if not self._ground:
            self._ground = self.body(1.0, (1.0, 1.0, 1.0), (0, 0, 0), name=name, held=True)
        return self._ground

    def joint(self, kind: str | int, body_1: int | str, body_2: int | str, at: npt.ArrayLike,
              axis: npt.ArrayLike = (1, 0, 0), axis_2: npt.ArrayLike | None = None, *,
              kn: float = 1.0e7, cr: float = 0.05, k: Mapping[str, Law] | None = None,
              c: Mapping[str, Law] | None = None,
              stops: Mapping[str, Sequence[float]] | None = None,
              friction: Mapping[str, tuple[Law, float]] | None = None,
              locked: tuple[float, float] | None = None, name: str | None = None) -> int:
        """A joint at a place; gives its number. `kjoint list joints` shows the types.

        axis: x of its frame, about which a revolute turns and along which a translational slides;
        axis_2: y of its frame (universal: axis is that of body 1, axis_2 that of body 2). kn:
        stiffness of the blocked directions [force/length], 0: found by the program; cr: twice their
        damping ratio. By free direction, tx ty tz [length] rx ry rz [rad]: k, c: stiffness and
        damping, a number or points [(displacement or rate, force or moment), ...]; stops: (lower
        <= 0, upper >= 0), 0 is none, and perhaps their stiffness, else that of the blocked
        directions; friction: (limit or points of it over the displacement, stiffness); where a
        direction has both they share the stiffness. locked: (from, to) [time], the free directions
        are held.

        >>> import kjoint
        >>> m = kjoint.Mechanism()
        >>> door = m.body(20.0, (1.0, 1.0, 2.0), at=(0.4, 0, 0), name="door")
        >>> m.joint("revolute", m.ground(), door, at=(0, 0, 0), axis=(0, 0, 1),
        ...         c={"rx": 0.5}, stops={"rx": (-0.01, 1.57)}, friction={"rx": (2.0, 1e4)})
        1
        >>> m.joint("revolut", m.ground(), door, at=(0, 0, 0))
        Traceback (most recent call last):
        kjoint.Error: no joint type 'revolut', did you mean 'revolute'?
        """
        number = type_number(kind)
        called = _line(name or f"joint {len(self._joints) + 1}")
        if called in (joint["name"] for joint in self._joints):
            raise Error(f"there is a joint {called!r} already")
        ends = self._body(body_1), self._body(body_2)
        if ends[0] == ends[1]:
            raise Error(f"{called} joins {self._bodies[ends[0] - 1]['name']} to itself")
        first = _unit(axis, f"the axis of {called}")
        second = np.eye(3)[np.argmin(abs(first))] if axis_2 is None \
            else _unit(axis_2, f"axis_2 of {called}")
        across = second - first*(first @ second)
        if np.linalg.norm(across) < 1e-6:
            raise Error(f"axis and axis_2 of {called} are parallel")
        if number == TYPES["universal"] and axis_2 is not None:
            if abs(first @ second) > 1e-6:
                raise Error(f"axis and axis_2 of {called}, a universal joint, are not perpendicular")
        second = across/np.linalg.norm(across)
        laws: dict[str, Mapping[str, Any]] = dict(k=k or {}, c=c or {}, stops=stops or {},
                                                  friction=friction or {})
        for what, given in laws.items():
            for dof in given:
                if dof not in DOFS:
                    raise unknown("direction", dof, DOFS)
                if not FREE[number][DOFS.index(dof)]:
                    free = [d for d, yes in zip(DOFS, FREE[number]) if yes]
                    raise Error(f"{what} of {called}: {dof} is not free in a {self._type(number)} "
                                f"joint, free are: {' '.join(free) or 'none'}")
        for dof, stop in laws["stops"].items():
            if len(stop) not in (2, 3) or not stop[0] <= 0.0 <= stop[1]:
                raise Error(f"stops of {called}, {dof}: {stop} is no (lower <= 0, upper >= 0), or with "
                            "a stiffness behind")
            shared = laws["friction"].get(dof, (0.0, stop[-1]))[1]
            if len(stop) == 3 and _at_least(stop[2], 0.0, f"stiffness of the stop of {called}") != shared:
                raise Error(f"stop and friction of {called}, {dof}, share one stiffness, not "
                            f"{stop[2]:g} and {shared:g}")
        joint: dict[str, Any] = dict(
            type=number, bodies=ends, at=_vector(at, f"the place of {called}"), axes=(first, second),
            kn=_at_least(kn, 0.0, f"kn of {called}"), cr=_at_least(cr, 0.0, f"cr of {called}"),
            name=called, locked=locked, k={}, c={},
            stops={dof: stop[:2] for dof, stop in laws["stops"].items()},
            friction={dof: ((0.0, 0), stop[2]) for dof, stop in laws["stops"].items() if stop[2:]})
        for what in ("k", "c"):
            for dof, law in laws[what].items():
                joint[what][dof] = self._law(law, f"{what} of {called}, {dof}")
        for dof, (limit, stiffness) in laws["friction"].items():
            joint["friction"][dof] = (self._law(limit, f"friction of {called}, {dof}"),
                                      _at_least(stiffness, 0.0, f"friction stiffness of {called}"))
        self._joints.append(joint)
        return len(self._joints)

    def spring(self, body_1: int | str, body_2: int | str, at_1: npt.ArrayLike, at_2: npt.ArrayLike,
               *, k: Law = 0.0, c: float = 0.0, mass: float = 1e-9,
               name: str | None = None) -> int:
        """A spring along the line of two places, free of force at the start; gives its id.

        k: stiffness [force/length], or points [(elongation, force), ...]; c: damping [force
        time/length]; mass: of the spring, half on each body. For six directions take a joint "free".

        >>> import kjoint
        >>> m = kjoint.Mechanism()
        >>> mass = m.body(2.0, (1, 1, 1), at=(0, 0, -1.0))
        >>> strut = m.spring(m.ground(), mass, (0, 0, 0), (0, 0, -1.0), k=50.0, c=0.1, name="strut")
        """
        id = FREE_ELEMENTS + len(self._springs) + 1
        called = _line(name or f"spring {len(self._springs) + 1}")
        ends = self._body(body_1), self._body(body_2)
        places = _vector(at_1, f"the place of {called}"), _vector(at_2, f"the place of {called}")
        if np.array_equal(*places):
            raise Error(f"both ends of {called} are at one place: its line has no direction")
        value, curve = self._law(k, f"k of {called}")
        stiffness, scale = (0.0, value) if curve else (value, 0.0)
        nodes = [self._node(body, place) for body, place in zip(ends, places)]
        self._spring_names.append(called)
        self._springs.append([
            f"/PROP/TYPE4/{id}", called, _reals(_at_least(mass, 1e-30, f"mass of {called}")) + " "*30 + _ints(0, 0, 0),
            _reals(stiffness, _at_least(c, 0.0, f"c of {called}"), scale, 0.0, 0.0),
            _ints(curve, 0, 0, 0, 0) + " "*10 + _reals(0.0, 0.0), _reals(0.0, 0.0, 0.0, 0.0),
            f"/PART/{id}", called, _ints(id, 0, 0), f"/SPRING/{id}", _ints(id, *nodes)])
        return id

    # ---- what acts

    def load(self, body: int | str, force: npt.ArrayLike = (0, 0, 0),
             moment: npt.ArrayLike = (0, 0, 0), *, at: npt.ArrayLike | None = None,
             over: Law = 1.0, name: str | None = None) -> list[int]:
        """Force and moment on a body, global frame; gives the ids of its parts (Model.set_load_factor).

        force acts at the centre, or at a place of the body [length]; over: factor over the time,
        a number or points [(time, factor), ...].

        >>> import kjoint
        >>> m = kjoint.Mechanism()
        >>> mass = m.body(2.0, (1, 1, 1), at=(0, 0, 0))
        >>> push = m.load(mass, force=(3.0, 0, 0), over=[(0, 0), (0.1, 1), (1, 1)])   # N, s
        """
        number = self._body(body)
        factor, curve = self._law(over, "over")
        node = number if at is None else self._node(number, _vector(at, "at"))
        values = (*_vector(force, "force"), *_vector(moment, "moment"))
        ids = []
        for direction, value in zip(("X", "Y", "Z", "XX", "YY", "ZZ"), values):
            if value:
                id = next(self._ids)
                ids.append(id)
                self._actions += self._group(id, [node])
                self._actions += [f"/CLOAD/{id}", _line(name or "load"), _ints(curve or 1)
                                  + f"{direction:>10s}" + _ints(0, 0, FREE_NODES + id, 0)
                                  + _reals(1.0, value*factor)]
        if not ids:
            raise Error("a load without force and moment")
        return ids

    def drive(self, body: int | str, *, along: npt.ArrayLike | None = None,
              turn: npt.ArrayLike | None = None, velocity: Law | None = None,
              displacement: Law | None = None, start: float = 0.0, stop: float | None = None,
              name: str | None = None) -> int:
        """Impose the motion of a body along or about (turn) a global direction; gives its id.

        velocity [length/time, rad/time] or displacement [length, rad]: a number, or points [(time,
        value), ...]; from start to stop [time], None: to the end. A body that is driven about an
        axis keeps its other directions; a joint holds them.

        >>> import kjoint
        >>> m = kjoint.Mechanism()
        >>> crank = m.body(1.0, (0.01, 0.01, 0.01), at=(0, 0, 0))
        >>> hinge = m.joint("revolute", m.ground(), crank, at=(0, 0, 0), axis=(0, 1, 0))
        >>> motor = m.drive(crank, turn=(0, 1, 0), velocity=[(0, 0), (0.1, 6.28), (1, 6.28)])
        """
        number = self._body(body)
        called = self._bodies[number - 1]["name"]
        if self._bodies[number - 1]["held"]:
            raise Error(f"{called} is held, it cannot be driven")
        if (along is None) == (turn is None) or (velocity is None) == (displacement is None):
            raise Error("to drive a body takes either along or turn, and either velocity or displacement")
        direction = _unit(along if turn is None else turn, "the direction of the drive")  # type: ignore[arg-type]
        values = velocity if velocity is not None else displacement
        factor, curve = self._law(values, f"motion of {called}")  # type: ignore[arg-type]
        id, skew, axis = next(self._ids), 0, "XYZ"[int(np.argmax(abs(direction)))]
        if np.abs(direction).max() == 1.0:
            factor *= float(direction.sum())
        else:                                     # a skew whose x is the direction
            skew, axis = id, "X"
            y = np.cross(direction, np.eye(3)[np.argmin(abs(direction))])
            y /= np.linalg.norm(y)
            self._actions += [f"/SKEW/FIX/{id}", called, _reals(0, 0, 0), _reals(*y),
                              _reals(*np.cross(direction, y))]
        self._actions += self._group(id, [number])
        kind = "IMPVEL" if velocity is not None else "IMPDISP"
        self._actions += [f"/{kind}/{id}", _line(name or f"drive of {called}"), _ints(curve or 1)
                          + f"{axis*(1 if turn is None else 2):>10s}"
                          + _ints(skew, 0, FREE_NODES + id, 0, 0),
                          _reals(1.0, factor, _at_least(start, 0.0, "start"), stop or 0.0)]
        return id

    # ---- deck and runs

    def deck(self) -> str:
        """The starter deck as a text.

        >>> import kjoint
        >>> kjoint.example().deck().splitlines()[:2]
        ['#RADIOSS STARTER', '/BEGIN']
        """
        if not self._joints and not self._springs:
            raise Error("the mechanism has neither joints nor springs")
        nodes: list[tuple[int, Array]] = []
        parts: list[str] = []
        held: dict[int, list[int]] = {n: list(b["nodes"]) for n, b in enumerate(self._bodies, 1)}
        first = 1000 if len(self._bodies) < 1000 else 10_000_000
        for number, joint in enumerate(self._joints, 1):
            parts += self._joint_cards(number, first + 10*number, joint, nodes, held)
        for number, body in enumerate(self._bodies, 1):
            parts += self._body_cards(number, body, held[number])
            nodes.insert(number - 1, (number, body["at"]))
        lines = ["#RADIOSS STARTER", "/BEGIN", "mechanism", _ints(2023, 0)]
        lines += [("%20s"*3) % self.units]*2 + ["/TITLE", self.title, "/NODE"]
        lines += [f"{node:10d}{_reals(*x)}" for node, x in nodes + self._nodes] + parts
        lines += [card for spring in self._springs for card in spring] + self._actions
        for id, points in enumerate([np.array([[0.0, 1.0], [1.0, 1.0]]), *self._curves], 1):
            lines += [f"/FUNCT/{id}", "one" if id == 1 else f"function {id}"]
            lines += [_reals(*point) for point in points]
        moving = [n for n, b in enumerate(self._bodies, 1) if not b["held"]]
        lines += ["/GRNOD/NODE/9000001", "moving bodies"] + [_ints(n) for n in moving]
        for axis, value in zip("XYZ", self.gravity):
            if value:
                lines += [f"/GRAV/{ord(axis)}", f"gravity {axis}", _ints(1) + f"{axis:>10s}"
                          + _ints(0, 0, 9000001) + " "*10 + _reals(1.0, value)]
        lines += ["/TH/SPRING/1", "joints", "DEF"]
        lines += [f"{n:10d}{j['name']:>20.20s}" for n, j in enumerate(self._joints, 1)]
        lines += [f"{FREE_ELEMENTS + n:10d}{name:>20.20s}"
                  for n, name in enumerate(self._spring_names, 1)]
        lines += ["/TH/RBODY/2", "bodies", "DEF"]
        lines += [_ints(n) for n in range(1, len(self._bodies) + 1)] + ["/END", ""]
        return "\n".join(lines)

    def write(self, root: Path, until: float, sample: float | None = None) -> list[str]:
        """Write ROOT_0000.rad and ROOT_0001.rad for the command line; end, interval of samples [time],
        None: 500 samples.

        >>> import kjoint
        >>> kjoint.example().write("pendulum", until=1.0, sample=0.01)
        ['pendulum_0000.rad', 'pendulum_0001.rad']
        """
        name, sample = pathlib.Path(root).name, until/500 if sample is None else sample
        engine = "\n".join((f"/RUN/{name}/1", repr(float(until)), "/TFILE/1", repr(float(sample)),
                            "/VERS/2023", "/END", ""))
        files = [f"{root}_0000.rad", f"{root}_0001.rad"]
        for path, text in zip(files, (self.deck(), engine)):
            pathlib.Path(path).write_text(text, encoding="utf-8")
        return files

    def model(self, until: float, sample: float | None = None, **options: Any) -> Model:
        """The mechanism as a Model, ready to run or to step; end, interval of samples [time], None: 500
        samples.

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.01).joints
        [1]
        """
        sample = until/500 if sample is None else sample
        return Model(DeckText(self.deck()), until=until, sample=sample, **options)

    def run(self, until: float, sample: float | None = None, **options: Any) -> Model:
        """Run it; end, interval of samples [time], None: 500 samples; options as kjoint.options() has
        them.

        >>> import kjoint
        >>> run = kjoint.example().run(until=1.0, sample=0.01, integrator="compliant", error=1e-4)
        >>> run["rigid_body/position[bar].x"].shape     # m
        (101,)
        """
        return self.model(until, sample, **options).run()

    def grid(self, until: float, sample: float, measure: Mapping[str, Callable[[Model], float]],
             **settings: Iterable[Any]) -> xarray.Dataset:
        """Run it in all combinations of settings; gives the measures over them.

        measure: a function of the run by its name; settings: values of options.

        >>> import kjoint
        >>> peak = {"peak": lambda run: run["joint/force[hinge].norm"].max()}        # N
        >>> kjoint.example().grid(0.5, 0.01, peak, formulation=["consistent", "legacy"],
        ...                       kn_scale=[1.0, 0.1]).peak.dims
        ('formulation', 'kn_scale')
        """
        import xarray
        values = {name: list(given) for name, given in settings.items()}
        shape = [len(given) for given in values.values()]
        found = {name: np.full(shape, np.nan) for name in measure}
        for place in np.ndindex(*shape):
            chosen = {name: given[i] for (name, given), i in zip(values.items(), place)}
            run = self.run(until, sample, **chosen)
            for name, function in measure.items():
                found[name][place] = function(run)
        return xarray.Dataset({name: (list(values), array) for name, array in found.items()}, values,
                              {"title": self.title})

    # ---- cards

    def _body(self, body: int | str) -> int:
        """Number of a body."""
        names = [known["name"] for known in self._bodies]
        if isinstance(body, str):
            if body not in names:
                raise unknown("body", body, names)
            return names.index(body) + 1
        if not 1 <= body <= len(names):
            raise unknown("body", body, (f"{n} {name}" for n, name in enumerate(names, 1)))
        return int(body)

    @staticmethod
    def _type(number: int) -> str:
        return next(name for name, known in TYPES.items() if known == number)

    def _law(self, law: Law, what: str) -> tuple[float, int]:
        """A number and no function, or 1 and the id of a function."""
        points = np.asarray(law, dtype=float)
        if not np.all(np.isfinite(points)):
            raise Error(f"{what}: a number is not finite")
        if points.ndim == 0:
            return float(points), 0
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2:
            raise Error(f"{what}: a function has two points (x, y) at least")
        if not np.all(np.diff(points[:, 0]) > 0):
            raise Error(f"{what}: the abscissae of the points do not ascend")
        self._curves.append(points)
        return 1.0, len(self._curves) + 1

    def _node(self, body: int, place: Array) -> int:
        """A new node on a body."""
        id = FREE_NODES + len(self._nodes) + 1
        self._nodes.append((id, place))
        self._bodies[body - 1]["nodes"].append(id)
        return id

    @staticmethod
    def _group(id: int, nodes: Iterable[int]) -> list[str]:
        return [f"/GRNOD/NODE/{FREE_NODES + id}", "nodes", *(_ints(node) for node in nodes)]

    def _joint_cards(self, number: int, first: int, joint: dict[str, Any],
                     nodes: list[tuple[int, Array]], held: dict[int, list[int]]) -> list[str]:
        reach = (joint["at"], joint["at"], *(joint["at"] + axis for axis in joint["axes"]))
        nodes += [(first + i, x) for i, x in enumerate(reach)]
        one, two = joint["bodies"]
        held[one] += [first, first + 2, first + 3]
        held[two].append(first + 1)
        cards, sensor = [], 0
        if joint["locked"]:
            sensor = number
            cards = [f"/SENSOR/TIME/{number}", joint["name"], _reals(joint["locked"][0]),
                     _reals(joint["locked"][1])]
        cards += [f"/PROP/KJOINT2/{number}", joint["name"], _ints(joint["type"])
                  + _reals(joint["kn"], 0.0, joint["cr"]) + _ints(sensor, 0, 0)]
        for dof, free in zip(DOFS, FREE[joint["type"]]):
            if free:
                k, f_k = joint["k"].get(dof, (0.0, 0))
                c, f_c = joint["c"].get(dof, (0.0, 0))
                (limit, f_limit), stiffness = joint["friction"].get(dof, ((0.0, 0), 0.0))
                cards += [_reals(k) + _ints(f_k) + _reals(*joint["stops"].get(dof, (0.0, 0.0)))
                          + _ints(0), _reals(c) + _ints(f_c),
                          _reals(stiffness, limit) + _ints(f_limit)]
        return cards + [f"/PART/{number}", joint["name"], _ints(number, 0, 0),
                        f"/SPRING/{number}", _ints(number, *range(first, first + 4))]

    @staticmethod
    def _body_cards(number: int, body: dict[str, Any], nodes: list[int]) -> list[str]:
        group, main = 9100000 + number, 9200000 + number
        cards = [f"/GRNOD/NODE/{group}", body["name"], *(_ints(n) for n in nodes),
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


def example(**laws: Any) -> Mechanism:
    """A pendulum to try things on: a bar of 2 kg and 1 m on a hinge at the origin, let go from the
    horizontal; laws: those of Mechanism.joint for the hinge.

    >>> import kjoint
    >>> kjoint.example(c={"rx": 0.1}).run(until=0.1, sample=0.05)["time"]      # s
    array([0.  , 0.05, 0.1 ])
    """
    m = Mechanism("pendulum", gravity=(0, 0, -9.81))
    wall = m.ground("wall")
    bar = m.body(2.0, (0.01, 0.17, 0.17), at=(0.5, 0, 0), name="bar")
    m.joint("revolute", wall, bar, at=(0, 0, 0), axis=(0, 1, 0), name="hinge", **laws)
    return m


__all__ = ["Mechanism", "TYPES", "example"]
