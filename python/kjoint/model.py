"""A deck and its run."""
from __future__ import annotations

import contextlib
import ctypes as ct
import dataclasses
import pathlib
import signal
import tempfile
import threading
from types import FrameType, TracebackType
from typing import Any, Callable, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from ._error import Error, unknown
from ._library import FILES, INT, LIB, SIZE, TICK, Body, Handle, Result, Status, encoded, values_of
from ._library import options as list_options
from .joints import JointState
from .samples import Array, Channel, Path, Samples


@dataclasses.dataclass(frozen=True)
class RunStatus:
    """How far a run is: cycle, times, energies of the last sample, energy error (a fraction),
    numbers of joints, bodies, nodes and samples. Units of the deck.

    >>> import kjoint
    >>> kjoint.example().run(until=0.1, sample=0.05).status.time            # s
    0.1
    """
    cycle: int
    time: float
    time_end: float
    time_step: float
    kinetic: float
    internal: float
    work: float
    energy_error: float
    n_joint: int
    n_body: int
    n_node: int
    n_sample: int


@dataclasses.dataclass(frozen=True)
class BodyState:
    """A rigid body now: mass, place and velocity of its centre, attitude (turn since the start, w x
    y z), omega [rad/time], force and moment (about the centre) of joints and loads; global frame,
    units of the deck. Under legacy velocities are half a step older.

    >>> import kjoint
    >>> kjoint.example().model(until=1.0, sample=0.1).start().body("bar").position.round(6) + 0   # m
    array([0.5, 0. , 0. ])
    """
    id: int
    mass: float
    position: Array
    attitude: Array
    velocity: Array
    omega: Array
    force: Array
    moment: Array


class DeckText(str):
    """A starter deck as a text, in the place of its path."""


Watch = Callable[[RunStatus], Any]


def _vector(values: npt.ArrayLike, n: int = 3) -> Array:
    array = np.ascontiguousarray(values, dtype=float)
    if array.shape != (n,):
        raise Error(f"expected {n} numbers")
    return array


class _Watcher:
    """Stands between a run and who watches it: what watch raises, and an interrupt (Ctrl-C) that
    comes while the run is in the library, stop the run and come out of it."""

    def __init__(self, watch: Watch | None) -> None:
        self.watch, self.watching = watch, False
        self.raised: BaseException | None = None
        self.interrupt: tuple[int, FrameType | None] | None = None
        self.handler: Callable[[int, FrameType | None], Any] | None = None

    def tick(self, status: Any, user: Any) -> int:
        if self.watch and self.raised is None:
            try:
                self.watching = True
                if self.watch(RunStatus(**values_of(status.contents))):
                    return 1
            except BaseException as raised:
                self.raised = raised
            finally:
                self.watching = False
        return int(self.raised is not None or self.interrupt is not None)

    def on_interrupt(self, number: int, frame: FrameType | None) -> None:
        if self.watching and self.handler:
            self.handler(number, frame)
        else:
            self.interrupt = number, frame

    def __enter__(self) -> _Watcher:
        handler = signal.getsignal(signal.SIGINT)
        if threading.current_thread() is threading.main_thread() and callable(handler):
            signal.signal(signal.SIGINT, self.on_interrupt)
            self.handler = handler
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None,
                 trace: TracebackType | None) -> None:
        if self.handler:
            signal.signal(signal.SIGINT, self.handler)
            if self.interrupt and self.raised is None:
                self.handler(*self.interrupt)
        if self.raised is not None:
            raise self.raised


def run_beside(models: Sequence[Model], watch: Watch | None = None) -> list[Error | None]:
    """Run models side by side, each as run() does and with the same bits; gives what went wrong with
    each. Small scenes that differ in numbers alone take their steps together, which is faster. watch
    belongs to all of them.

    >>> import kjoint
    >>> models = [kjoint.example().model(until=1.0, sample=0.1) for _ in range(3)]
    >>> kjoint.run_beside(models)
    [None, None, None]
    """
    handles = (ct.c_void_p*len(models))(*(model._handle for model in models))
    outcome = (INT*len(models))()
    with contextlib.ExitStack() as stack:
        for model in models:
            stack.enter_context(model._alone())
        watcher = stack.enter_context(_Watcher(watch))
        tick = TICK(watcher.tick) if watch or watcher.handler else None
        if LIB.kj_models_run(len(models), handles, tick and ct.cast(tick, ct.c_void_p), None, outcome):
            raise Error("a model runs already, or is there twice")
        return [Error(model._message(), status) if status else None for model, status in zip(models, outcome)]


class Model(Handle, Samples):
    """A Radioss deck and its run. Options: those of kjoint.options(), as the command line has them,
    such as until=0.1, formulation="legacy", islands=True; None leaves one out.

    run() keeps samples; model["joint/force"] is a channel over time, to_xarray(), to_pandas() and
    plot() have them with names and units. Or start(), then advance(t) or step(), body(id),
    joint(id), set_..., sample(). Bodies and joints go by id or label. Units of the deck.

    >>> import kjoint
    >>> kjoint.example().write("pendulum", until=0.5, sample=0.1)
    ['pendulum_0000.rad', 'pendulum_0001.rad']
    >>> model = kjoint.Model("pendulum_0000.rad").run()
    >>> model["joint/force"].shape                      # sample x joint x (x y z), N
    (6, 1, 3)
    """

    kind = "model"

    def __init__(self, deck: Path, engine: Path | None = None, **options: Any) -> None:
        super().__init__()
        known = list_options()
        for name in options:
            if name not in known:
                raise unknown("option", name, known)
        self._deck, self._engine = deck, encoded(engine) if engine else None
        self._words = {name: str(int(value) if known[name].kind == "flag" else value)
                       for name, value in options.items() if value is not None}
        for name, word in self._words.items():
            if len(word.split()) != 1:
                raise Error(f"a blank in the option {name}={word!r}")
        self._joint_laws: dict[str, float] = {}
        self._load()

    def _load(self) -> None:
        words = dict(self._words)
        if self._joint_laws:
            laws = ",".join(f"{name}={value!r}" for name, value in self._joint_laws.items())
            words["joint"] = ",".join(filter(None, (words.get("joint"), laws)))
        text = encoded(" ".join(f"{name}={word}" for name, word in words.items()))
        if isinstance(self._deck, DeckText):
            with tempfile.TemporaryDirectory() as folder:
                path = pathlib.Path(folder, "mechanism_0000.rad")
                path.write_text(self._deck, encoding="utf-8")
                self._new(LIB.kj_model_load, encoded(path), self._engine, text)
        else:
            self._new(LIB.kj_model_load, encoded(self._deck), self._engine, text)

    @property
    def options(self) -> dict[str, str]:
        """The options that are not left to the deck, with what the formulation decides, as texts.

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.1).options["integrator"]
        'split2'
        """
        return dict(word.split("=", 1) for word in self._message("options").split())

    @property
    def title(self) -> str:
        """Title of the deck.

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.1).title
        'pendulum'
        """
        return self._message("title")

    @property
    def warnings(self) -> list[str]:
        """Warnings about the deck.

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.1).warnings
        []
        """
        return self._message("warnings").splitlines()

    def run(self, watch: Watch | None = None) -> Model:
        """Run from the start to the end. watch(status) may return True to stop; what it raises
        ends the run, too. Meanwhile the model can be read by nobody but its status by watch.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1).run()
        >>> float(model["time"][-1])                    # s
        1.0
        """
        with self._alone(), _Watcher(watch) as watcher:
            tick = TICK(watcher.tick) if watch or watcher.handler else None
            self._call("run", tick and ct.cast(tick, ct.c_void_p), None)
        return self

    def start(self) -> Model:
        """State at t = 0, to be stepped.

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.1).start().status.time
        0.0
        """
        self._call("start")
        return self

    def advance(self, until: float) -> None:
        """March to a time [time]; legacy: to the first cycle at or beyond it.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1).start()
        >>> model.advance(0.25)
        >>> model.status.time
        0.25
        """
        self._call("advance", until)

    def step(self, n: int = 1) -> None:
        """March n steps.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1).start()
        >>> model.step(3)
        >>> model.status.cycle
        3
        """
        self._call("steps", n)

    def save(self) -> bytes:
        """State of a started model, as bytes.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1).start()
        >>> type(model.save())
        <class 'bytes'>
        """
        size = ct.c_size_t()
        self._call("save", 0, None, ct.byref(size))
        state = ct.create_string_buffer(size.value)
        self._call("save", size, state, None)
        return state.raw

    def restore(self, state: bytes) -> Model:
        """Go on from a saved state of the same deck: step(), advance() or run(). Same bits.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1).start()
        >>> model.advance(0.3)
        >>> other = kjoint.example().model(until=1.0, sample=0.1).restore(model.save())
        >>> other.status.time                           # s
        0.3
        """
        self._call("restore", len(state), state)
        return self

    def sample(self) -> None:
        """Keep a sample of the present.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1).start()
        >>> model.sample()
        >>> model["time"]
        array([0.])
        """
        self._call("sample")

    @property
    def status(self) -> RunStatus:
        """How far the run is.

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.1).run().status.n_sample
        11
        """
        status = Status()
        self._call("status", ct.byref(status))
        return RunStatus(**values_of(status))

    @property
    def channels(self) -> list[str]:
        """Names of all channels.

        >>> import kjoint
        >>> "joint/moment" in kjoint.example().model(until=1.0, sample=0.1).channels
        True
        """
        return self._message("channels").splitlines()

    def channel(self, name: str) -> Channel:
        """What a channel is: meaning, unit, ids and labels of its entities, components.

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.1).channel("joint/rotation").unit
        'rad'
        """
        _, n_entity, n_comp = self._shape(name)
        size = SIZE + 200*n_entity
        meaning, *lines = self._message("about", encoded(name), size=size).split("\n")
        ids, labels = zip(*(line.split(" ", 1) for line in lines)) if lines else (("0",), ("",))
        return Channel(meaning, self._message("unit", encoded(name)), tuple(map(int, ids)),
                       tuple(labels), n_comp)

    def _shape(self, name: str) -> tuple[int, int, int]:
        shape = [INT(), INT(), INT()]
        try:
            self._call("shape", encoded(name), *map(ct.byref, shape))
        except Error as error:
            if name in self.channels:
                raise
            raise unknown("channel", name, self.channels) from error
        row, entity, comp = (int(n.value) for n in shape)
        return row, entity, comp

    def _values(self, name: str) -> Array:
        with self._alone():
            values = np.empty(self._shape(name))
            self._call("series", encoded(name), values.size, values)
        return values

    def curve(self, name: str) -> Array:
        """One curve over the samples, as the command line names it.

        >>> import kjoint
        >>> kjoint.example().run(until=0.2, sample=0.1).curve("joint/force[hinge].norm").shape
        (3,)
        """
        values = np.empty(len(self["time"]))
        self._call("curve", encoded(name), len(values), values)
        return values

    def write_history(self, path: Path) -> None:
        """The samples as a history file (HDF5), for Run.open and the commands of kjoint.

        >>> import kjoint
        >>> kjoint.example().run(until=0.2, sample=0.1).write_history("pendulum.h5")
        """
        with FILES:
            self._call("write_history", encoded(path))

    def _ids(self, what: str) -> list[int]:
        count = self._number(f"{what}_count")
        ids = (INT*max(1, count))()
        self._call(f"{what}_ids", count, ct.byref(ids))
        return list(ids[:count])

    def _id(self, what: str, key: int | str) -> int:
        """Id of a body or joint from its id or label; labels are those of the history."""
        if not isinstance(key, str):
            return int(key)
        group = {"joint": "joint/force", "body": "rigid_body/position"}[what]
        about = self.channel(group) if group in self.channels else Channel("", "", (), (), 0)
        if key not in about.labels:
            raise unknown(what, key, about.labels)
        return about.ids[about.labels.index(key)]

    @property
    def bodies(self) -> list[int]:
        """Ids of all rigid bodies.

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.1).bodies
        [1, 2]
        """
        return self._ids("body")

    @property
    def joints(self) -> list[int]:
        """Ids of all joints.

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.1).joints
        [1]
        """
        return self._ids("joint")

    def body(self, body: int | str) -> BodyState:
        """A body now: mass, position, attitude, velocity, omega, force, moment.

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.1).start().body("bar").mass   # kg
        2.0
        """
        state = Body()
        self._call("body", self._id("body", body), ct.byref(state))
        return BodyState(**values_of(state))

    def joint(self, joint: int | str) -> JointState:
        """A joint now: force, displacement, frame, energy, dissipated, orthogonality.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1).start()
        >>> model.joint("hinge").displacement.shape     # tx ty tz [m] rx ry rz [rad]
        (6,)
        """
        result = Result()
        self._call("joint", self._id("joint", joint), ct.byref(result))
        return JointState(**values_of(result))

    def node(self, id: int) -> Array:
        """Place of a node now [length].

        >>> import kjoint
        >>> kjoint.example().model(until=1.0, sample=0.1).start().node(2).round(6) + 0
        array([0.5, 0. , 0. ])
        """
        x = np.empty(3)
        self._call("node", id, x)
        return x

    def set_joint(self, joint: int | str, *, kn: float | None = None, cr: float | None = None,
                  k: Mapping[str, float] | None = None, c: Mapping[str, float] | None = None,
                  stops: Mapping[str, Sequence[float]] | None = None,
                  friction: Mapping[str, tuple[float, float]] | None = None) -> Model:
        """Give a joint other laws than its deck does, as Mechanism.joint has them: kn
        [force/length], cr, and by free direction k, c, stops, friction (limit, stiffness); stops and
        friction are for /PROP/KJOINT2. What is left out stays. The model is loaded anew: start()
        or run() it afterwards.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1)
        >>> stopped = model.set_joint("hinge", stops={"rx": (-0.5, 0.5)}).run()
        >>> bool(abs(stopped["joint/rotation[hinge].x"]).max() < 0.52)          # rad
        True
        """
        number = self._id("joint", joint)
        laws: dict[str, float] = {}
        for name, value in (("Kn", kn), ("Cr", cr)):
            if value is not None:
                laws[f"{number}.{name}"] = float(value)
        for names, pairs in ((("K",), k), (("C",), c), (("SA-", "SA+", "Kfr"), stops),
                             (("FM", "Kfr"), friction)):
            for dof, given in (pairs or {}).items():
                for name, value in zip(names, np.atleast_1d(given)):
                    laws[f"{number}.{name}_{dof}"] = float(value)
        before, old = self._handle, dict(self._joint_laws)
        self._joint_laws.update(laws)
        with self._alone():
            try:
                self._handle = ct.c_void_p()
                self._load()
            except Error:
                self._handle, self._joint_laws = before, old
                raise
            LIB.kj_model_free(before)
        return self

    def set_body_load(self, body: int | str, force: npt.ArrayLike = (0, 0, 0),
                      moment: npt.ArrayLike = (0, 0, 0)) -> None:
        """Force and moment on a body until set anew, global frame.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1).start()
        >>> model.set_body_load("bar", force=(0, 0, 9.81*2.0))                  # N
        >>> model.advance(0.5)
        >>> bool(abs(model.body("bar").velocity).max() < 1e-9)
        True
        """
        self._call("set_body_load", self._id("body", body), _vector(force), _vector(moment))

    def set_load_factor(self, id: int, factor: float) -> None:
        """Factor on the concentrated load /CLOAD/id.

        >>> import kjoint
        >>> m = kjoint.example()
        >>> load = m.load("bar", force=(0, 0, 1.0))                             # N
        >>> m.model(until=1.0, sample=0.1).start().set_load_factor(load[0], 2.0)
        """
        self._call("set_load_factor", id, factor)

    def set_body_velocity(self, body: int | str, velocity: npt.ArrayLike,
                          omega: npt.ArrayLike = (0, 0, 0)) -> None:
        """Velocity of the centre and angular velocity [rad/time] of a body, global frame.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1).start()
        >>> model.set_body_velocity("bar", (0, 0, 0.5), omega=(0, -1, 0))
        >>> model.body("bar").omega.round(6) + 0
        array([ 0., -1.,  0.])
        """
        self._call("set_body_velocity", self._id("body", body), _vector(velocity), _vector(omega))

    def set_body_pose(self, body: int | str, position: npt.ArrayLike,
                      attitude: npt.ArrayLike = (1, 0, 0, 0)) -> None:
        """Put a body elsewhere; attitude: turn since the start, w x y z. Consistent only.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1).start()
        >>> model.set_body_pose("bar", (0.5, 0, 0.001))                         # m
        >>> model.body("bar").position
        array([0.5  , 0.   , 0.001])
        """
        self._call("set_body_pose", self._id("body", body), _vector(position), _vector(attitude, 4))

    def lock_joint(self, joint: int | str, locked: bool = True) -> None:
        """Lock or free a /PROP/KJOINT2 joint that has stops, friction or a sensor.

        >>> import kjoint
        >>> model = kjoint.example(stops={"rx": (-3.0, 3.0)}).model(until=1.0, sample=0.1).start()
        >>> model.lock_joint("hinge")
        """
        self._call("lock_joint", self._id("joint", joint), int(locked))
