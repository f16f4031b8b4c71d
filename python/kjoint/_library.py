"""The C library, its structures and calls."""
from __future__ import annotations

import contextlib
import ctypes as ct
import ctypes.util
import os
import pathlib
import threading
from typing import Any, Iterator, NamedTuple

import numpy as np
import numpy.typing as npt

from ._error import Error

INT, REAL, TEXT = ct.c_int, ct.c_double, ct.c_char_p
SIZE = 100_000                                    # room for messages and lists


class Spec(ct.Structure):
    _fields_ = [("id", INT), ("type", INT), ("node", INT * 2), ("carrier", INT * 2),
                ("first_frame", INT), ("axis_node", INT * 6), ("axes", REAL * 9), ("kn", REAL),
                ("cr", REAL), ("k", REAL * 6), ("c", REAL * 6), ("k_curve", INT * 6),
                ("c_curve", INT * 6)]


class Result(ct.Structure):
    _fields_ = [("id", INT), ("type", INT), ("force", REAL * 6), ("displacement", REAL * 6),
                ("frame", REAL * 3 * 3), ("energy", REAL), ("dissipated", REAL),
                ("orthogonality", REAL)]


class Status(ct.Structure):
    _fields_ = [("cycle", ct.c_longlong), ("time", REAL), ("time_end", REAL), ("time_step", REAL),
                ("kinetic", REAL), ("internal", REAL), ("work", REAL), ("energy_error", REAL),
                ("n_joint", INT), ("n_body", INT), ("n_node", INT), ("n_sample", INT)]


class Body(ct.Structure):
    _fields_ = [("id", INT), ("mass", REAL), ("position", REAL * 3), ("attitude", REAL * 4),
                ("velocity", REAL * 3), ("omega", REAL * 3), ("force", REAL * 3),
                ("moment", REAL * 3)]


FILES = threading.Lock()                          # HDF5 is called by one thread at a time

TICK = ct.CFUNCTYPE(INT, ct.POINTER(Status), ct.c_void_p)


def values_of(structure: ct.Structure) -> dict[str, Any]:
    """Its numbers by name, arrays as views of it."""
    found = {name: getattr(structure, name) for name, *_ in structure._fields_}
    for name, value in found.items():
        if isinstance(value, ct.Array):
            buffer: Any = value
            found[name] = np.frombuffer(buffer, float).reshape(len(value), -1).squeeze()
    return found


# threads of a run that wait sleep, instead of keeping the processor from others
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")


def _find() -> ct.CDLL:
    folder = pathlib.Path(__file__).resolve().parent
    names = [os.environ.get("KJOINT_LIBRARY")]
    names += [str(folder/"lib"/"libkjoint_c.so")]              # of the wheel
    names += [str(parent / "libkjoint_c.so") for parent in list(folder.parents)[2:4]]
    names += [ctypes.util.find_library("kjoint_c"), "libkjoint_c.so"]
    for name in [n for n in names if n]:
        try:
            return ct.CDLL(name)
        except OSError:
            continue
    raise ImportError("libkjoint_c is not found: set KJOINT_LIBRARY to its path")


class _Numbers:
    """Argument that takes numbers of a numpy array as double*, or None."""

    @classmethod
    def from_param(cls, array: Any) -> Any:
        return None if array is None else array.ctypes.data_as(ct.c_void_p)


def _declare(library: ct.CDLL) -> ct.CDLL:
    p, numbers = ct.c_void_p, _Numbers
    text: list[Any] = [TEXT, ct.c_size_t]
    calls: dict[str, list[Any]] = {
        "kj_version": text, "kj_joint_type": [INT] + text + [p], "kj_joint_spec_init": [p],
        "kj_options_list": text,
        "kj_joints_new": [TEXT, INT, p] + text, "kj_joints_message": [p] + text,
        "kj_joints_curve": [p, INT, numbers, numbers, p], "kj_joints_add": [p, p],
        "kj_joints_start": [p, INT] + [numbers] * 4,
        "kj_joints_take": [p, p, INT, numbers, numbers],
        "kj_joints_forces": [p, REAL, REAL, INT] + [numbers] * 6,
        "kj_joints_stiffness": [p, INT, numbers, numbers], "kj_joints_critical_step": [p, p],
        "kj_joints_count": [p, p], "kj_joints_result": [p, INT, p],
        "kj_joints_energy": [p, p, p], "kj_joints_warnings": [p, REAL, p],
        "kj_joints_state_size": [p, p], "kj_joints_save": [p, INT, numbers],
        "kj_joints_restore": [p, INT, numbers],
        "kj_model_load": [TEXT, TEXT, TEXT, p] + text, "kj_model_message": [p] + text,
        "kj_model_options": [p] + text,
        "kj_model_title": [p] + text, "kj_model_warnings": [p] + text,
        "kj_model_run": [p, p, p], "kj_models_run": [INT, p, p, p, p], "kj_model_start": [p], "kj_model_advance": [p, REAL],
        "kj_model_steps": [p, INT], "kj_model_save": [p, ct.c_size_t, p, p],
        "kj_model_restore": [p, ct.c_size_t, p], "kj_model_sample": [p], "kj_model_status": [p, p],
        "kj_model_channels": [p] + text, "kj_model_shape": [p, TEXT, p, p, p],
        "kj_model_series": [p, TEXT, INT, numbers], "kj_model_unit": [p, TEXT] + text,
        "kj_model_about": [p, TEXT] + text, "kj_model_curve": [p, TEXT, INT, numbers],
        "kj_rate_iso18571": [INT, numbers, numbers, p],
        "kj_model_write_history": [p, TEXT], "kj_model_body_count": [p, p],
        "kj_model_joint_count": [p, p], "kj_model_body_ids": [p, INT, p],
        "kj_model_joint_ids": [p, INT, p], "kj_model_body": [p, INT, p],
        "kj_model_joint": [p, INT, p], "kj_model_node": [p, INT, numbers],
        "kj_model_set_body_load": [p, INT, numbers, numbers],
        "kj_model_set_load_factor": [p, INT, REAL],
        "kj_model_set_body_velocity": [p, INT, numbers, numbers],
        "kj_model_set_body_pose": [p, INT, numbers, numbers],
        "kj_model_lock_joint": [p, INT, INT]}
    for name, arguments in calls.items():
        call = getattr(library, name)
        call.argtypes, call.restype = arguments, INT
    for name in ("kj_joints_free", "kj_model_free"):
        getattr(library, name).argtypes, getattr(library, name).restype = [p], None
    return library


LIB = _declare(_find())


def text_of(call: Any, *arguments: Any, size: int = SIZE) -> str:
    """What a call writes into its buffer; its status is left to who wants it."""
    buffer = ct.create_string_buffer(size)
    call(*arguments, buffer, size)
    return buffer.value.decode(errors="replace")


def encoded(text: str | os.PathLike[str]) -> bytes:
    """A text or path for C, which ends it at the first zero."""
    data = os.fsencode(text)
    if b"\0" in data:
        raise Error(f"a zero character in {text!r}")
    return data


def version() -> str:
    """Version of the library.

    >>> import kjoint
    >>> kjoint.version() == kjoint.__version__
    True
    """
    return text_of(LIB.kj_version)


class Option(NamedTuple):
    """One option of a run: its kind (word, real, integer, flag, text), the words that it may be,
    its default, its meaning.

    >>> import kjoint
    >>> kjoint.options()["until"].kind
    'real'
    """
    kind: str
    words: str
    default: str
    meaning: str


def options() -> dict[str, Option]:
    """The options of a run, by their name, as Model and Mechanism.run take them. Times are in the
    unit of the deck.

    >>> import kjoint
    >>> kjoint.options()["sample"].meaning
    'interval of the samples, time; 0: every cycle'
    """
    rows = (line.split("\t") for line in text_of(LIB.kj_options_list).splitlines())
    return {name: Option(*columns) for name, *columns in rows}


def iso18571(reference: npt.ArrayLike, curve: npt.ArrayLike) -> float:
    """Rating of a curve against another after ISO/TS 18571, 1 = equal; evenly spaced samples of both."""
    rating = REAL()
    both = [np.ascontiguousarray(y, dtype=float) for y in (reference, curve)]
    status = LIB.kj_rate_iso18571(len(both[0]), *both, ct.byref(rating))
    if status:
        raise Error("no rating", status)
    return rating.value


class Handle:
    """A handle of the C library, whose calls raise what goes wrong. It belongs to one thread at a
    time: the call of another meanwhile raises Error."""

    kind = ""

    def __init__(self) -> None:
        self._handle = ct.c_void_p()
        self._lock = threading.RLock()

    def _enter(self) -> None:
        if not self._lock.acquire(blocking=False):
            raise Error(f"another thread is in a call of this {type(self).__name__}: "
                        "one thread at a time", 2)

    @contextlib.contextmanager
    def _alone(self) -> Iterator[None]:
        self._enter()
        try:
            yield
        finally:
            self._lock.release()

    def _new(self, call: Any, *arguments: Any) -> None:
        message = ct.create_string_buffer(SIZE)
        status = call(*arguments, ct.byref(self._handle), message, SIZE)
        if status:
            raise Error(message.value.decode(errors="replace"), status)

    def _call(self, name: str, *arguments: Any) -> None:
        self._enter()                             # a step of a host should cost little more than in C
        try:
            status = getattr(LIB, f"kj_{self.kind}_{name}")(self._handle, *arguments)
            if status:
                raise Error(self._message(), status)
        finally:
            self._lock.release()

    def _message(self, what: str = "message", *arguments: Any, size: int = SIZE) -> str:
        with self._alone():
            return text_of(getattr(LIB, f"kj_{self.kind}_{what}"), self._handle, *arguments, size=size)

    def _number(self, name: str, kind: Any = INT) -> Any:
        value = kind()
        self._call(name, ct.byref(value))
        return value.value

    def __del__(self) -> None:
        if getattr(self, "_handle", None):
            getattr(LIB, f"kj_{self.kind}_free")(self._handle)
            self._handle = ct.c_void_p()
