"""Joints as elements of a host."""
from __future__ import annotations

import ctypes as ct
import dataclasses
from typing import TYPE_CHECKING, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from ._error import Error, unknown
from ._library import INT, LIB, REAL, Handle, Result, Spec, encoded, values_of
from .samples import Array

if TYPE_CHECKING:
    from .model import Model


def _joint_types() -> tuple[dict[str, int], dict[int, tuple[int, ...]]]:
    """Numbers of the joint types by name, and their free directions by number."""
    name, free = ct.create_string_buffer(40), (INT * 6)()
    numbers: dict[str, int] = {}
    free_dofs: dict[int, tuple[int, ...]] = {}
    while LIB.kj_joint_type(len(numbers) + 1, name, len(name), free) == 0:
        numbers[name.value.decode()] = number = len(numbers) + 1
        free_dofs[number] = tuple(free)
    return numbers, free_dofs


TYPES, FREE = _joint_types()


def type_number(kind: str | int) -> int:
    """Number of a joint type from its number or name."""
    if isinstance(kind, str):
        if kind.lower() not in TYPES:
            raise unknown("joint type", kind, TYPES)
        return TYPES[kind.lower()]
    if kind not in FREE:
        raise unknown("joint type", kind, (f"{n} {name}" for name, n in TYPES.items()))
    return int(kind)


def _table(array: npt.ArrayLike | None, n: int, width: int, name: str) -> Array | None:
    """Numbers as C wants them: n x width, contiguous."""
    if array is None:
        return None
    array = np.ascontiguousarray(array, dtype=float)
    wanted = (n, width) if width > 1 else (n,)
    if array.shape != wanted:
        raise Error(f"{name} has the shape {array.shape}, not {wanted}")
    return array


@dataclasses.dataclass(frozen=True)
class JointState:
    """What a joint does now: force and moment on end 1 and displacement of end 2 from end 1 (tx ty
    tz rx ry rz, joint frame), frame (rows: its axes in W), energy: work done on it, dissipated:
    what dampers took of it, orthogonality: loss of right angles [rad]. Units of the deck or host.

    >>> import kjoint
    >>> kjoint.example().model(until=1.0, sample=0.1).start().joint("hinge").type   # revolute
    2
    """
    id: int
    type: int
    force: Array
    displacement: Array
    frame: Array
    energy: float
    dissipated: float
    orthogonality: float


class Joints(Handle):
    """Joints between the nodes of a host; see include/kjoint.h for every argument.

    n: nodes of the host. formulation: "consistent" (frames follow the attitudes of the carriers) or
    "legacy" (they follow nodes and angular velocities, as in Radioss). Units are those of the host,
    angles in radian; arrays are n x 3, quaternions w x y z.

    A mass of 2 kg on a spring of 50 N/m along x, stretched by 0.1 m:

    >>> import kjoint, numpy as np
    >>> joints = kjoint.Joints(2)
    >>> joints.add("free", (0, 1), k=(50.0, 0, 0, 0, 0, 0))
    >>> x, rest, attitude = np.zeros((2, 3)), np.zeros((2, 3)), np.tile([1.0, 0, 0, 0], (2, 1))
    >>> joints.start(x, [0.0, 2.0], np.ones((2, 3)), attitude)
    >>> x[1, 0] = 0.1
    >>> f, m = np.zeros((2, 3)), np.zeros((2, 3))
    >>> joints.forces(0.0, 0.0, x, rest, rest, f, m, attitude)
    >>> float(round(f[1, 0], 9)), len(joints)
    (-5.0, 1)
    """

    kind = "joints"

    def __init__(self, n: int, formulation: str = "consistent") -> None:
        super().__init__()
        self.n = n
        self._new(LIB.kj_joints_new, encoded(formulation), n)

    def curve(self, x: npt.ArrayLike, y: npt.ArrayLike) -> int:
        """A function for the laws of joints that follow, by points; gives its number.

        >>> import kjoint
        >>> kjoint.Joints(2).curve([0, 0.1], [0, 50.0])
        0
        """
        x, y = (np.ascontiguousarray(a, dtype=float) for a in (x, y))
        if x.shape != y.shape:
            raise Error("x and y have different shapes")
        number = INT()
        self._call("curve", x.size, x, y, ct.byref(number))
        return int(number.value)

    def add(self, kind: str | int, node: Sequence[int], *,
            carrier: Sequence[int | None] = (None, None), axes: npt.ArrayLike | None = None,
            axis_node: Sequence[Sequence[int] | None] = (None, None), kn: float = 0.0,
            cr: float = 0.0, k: Sequence[float] = (0,)*6, c: Sequence[float] = (0,)*6,
            k_curve: Mapping[int, int] | None = None, c_curve: Mapping[int, int] | None = None,
            first_frame: bool = False, id: int = 0) -> None:
        """Add a joint: type, nodes of both ends, laws of its free directions.

        kn: stiffness of the blocked directions [force/length]; cr: twice their damping ratio; k, c:
        stiffness and damping of the free directions, tx ty tz [force/length] rx ry rz
        [moment/rad]; k_curve, c_curve: numbers of curves by direction, 0 to 5.

        >>> import kjoint
        >>> joints = kjoint.Joints(2)
        >>> joints.add("revolute", (0, 1), kn=1e6, k=(0, 0, 0, 3.0, 0, 0))
        """
        spec = Spec()
        LIB.kj_joint_spec_init(ct.byref(spec))
        spec.id, spec.type, spec.kn, spec.cr = id, type_number(kind), kn, cr
        spec.first_frame = int(first_frame)
        for end in range(2):
            spec.node[end] = node[end]
            carried_by, nodes = carrier[end], axis_node[end]
            if carried_by is not None:
                spec.carrier[end] = carried_by
            if nodes is not None:
                spec.axis_node[3*end:3*end + 3] = list(nodes)
        if axes is not None:
            spec.axes[:] = list(np.asarray(axes, dtype=float).ravel())
        for dof in range(6):
            spec.k[dof], spec.c[dof] = k[dof], c[dof]
        for dof, number in (k_curve or {}).items():
            spec.k_curve[dof] = number
        for dof, number in (c_curve or {}).items():
            spec.c_curve[dof] = number
        self._call("add", ct.byref(spec))

    def start(self, x: npt.ArrayLike, mass: npt.ArrayLike, inertia: npt.ArrayLike,
              attitude: npt.ArrayLike | None = None) -> None:
        """Fix the joints in the present places x, free of force. mass 0: the host moves that node.

        >>> import kjoint, numpy as np
        >>> joints = kjoint.Joints(2, "legacy")
        >>> joints.add("spherical", (0, 1), kn=100.0)
        >>> joints.start(np.zeros((2, 3)), [0.0, 2.0], np.ones((2, 3)))
        """
        n = self.n
        self._call("start", n, _table(x, n, 3, "x"), _table(mass, n, 1, "mass"),
                   _table(inertia, n, 3, "inertia"), _table(attitude, n, 4, "attitude"))

    def take(self, model: Model, node_id: npt.ArrayLike,
             attitude: npt.ArrayLike | None = None) -> None:
        """The joints of a deck instead of add and start; node_id: id in the deck of each host node.

        >>> import kjoint
        >>> model = kjoint.example().model(until=1.0, sample=0.1)
        >>> joints = kjoint.Joints(2)
        >>> joints.take(model, [1, 2], [[1, 0, 0, 0]]*2)
        >>> len(joints)
        1
        """
        ids = np.ascontiguousarray(node_id, dtype=np.intc)
        with model._alone():
            self._call("take", model._handle, ids.size, ids,
                       _table(attitude, self.n, 4, "attitude"))

    def forces(self, time: float, h: float, x: npt.ArrayLike, v: npt.ArrayLike,
               omega: npt.ArrayLike, f: Array, m: Array,
               attitude: npt.ArrayLike | None = None) -> None:
        """ADD forces and moments at t to f and m: arrays n x 3 of float64, contiguous.

        h: step since the last call, 0 in the first; x at t, v and omega [rad/time] at t - h/2.

        >>> import kjoint, numpy as np
        >>> joints, zero = kjoint.Joints(2, "legacy"), np.zeros((2, 3))
        >>> joints.add("spherical", (0, 1), kn=100.0)
        >>> joints.start(zero, [0.0, 2.0], np.ones((2, 3)))
        >>> f, m = np.zeros((2, 3)), np.zeros((2, 3))
        >>> joints.forces(0.0, 0.0, zero, zero, zero, f, m)
        >>> bool(np.all(f == 0))
        True
        """
        for name, array in (("f", f), ("m", m)):
            if not (isinstance(array, np.ndarray) and array.dtype == float
                    and array.flags.c_contiguous and array.shape == (self.n, 3)):
                raise Error(f"{name} must be a contiguous float64 array {self.n} x 3")
        n = self.n
        self._call("forces", time, h, n, _table(x, n, 3, "x"), _table(v, n, 3, "v"),
                   _table(omega, n, 3, "omega"), _table(attitude, n, 4, "attitude"), f, m)

    def stiffness(self) -> tuple[Array, Array]:
        """Stiffness of the joints at each node, for the nodal time step h = sqrt(2 m/kn): kn
        [force/length], kr [moment/rad].

        >>> import kjoint, numpy as np
        >>> joints, zero = kjoint.Joints(2, "legacy"), np.zeros((2, 3))
        >>> joints.add("spherical", (0, 1), kn=100.0)
        >>> joints.start(zero, [0.0, 2.0], np.ones((2, 3)))
        >>> joints.forces(0.0, 0.0, zero, zero, zero, np.zeros((2, 3)), np.zeros((2, 3)))
        >>> joints.stiffness()[0].shape
        (2,)
        """
        kn, kr = np.zeros(self.n), np.zeros(self.n)
        self._call("stiffness", self.n, kn, kr)
        return kn, kr

    @property
    def critical_step(self) -> float:
        """Largest stable step of the joints alone, in the present pose [time]: 2/omega, here of a
        mass of 4 on a stiffness of 100, omega 5.

        >>> import kjoint, numpy as np
        >>> joints, zero = kjoint.Joints(2), np.zeros((2, 3))
        >>> joints.add("spherical", (0, 1), kn=100.0, cr=1e-9)
        >>> joints.start(zero, [0.0, 4.0], np.ones((2, 3)), [[1, 0, 0, 0]]*2)
        >>> round(joints.critical_step, 6)
        0.4
        """
        return float(self._number("critical_step", REAL))

    def __len__(self) -> int:
        """Number of joints.

        >>> import kjoint
        >>> len(kjoint.Joints(2))
        0
        """
        return int(self._number("count"))

    def result(self, joint: int) -> JointState:
        """What a joint does; they count from 0.

        >>> import kjoint, numpy as np
        >>> joints, zero = kjoint.Joints(2, "legacy"), np.zeros((2, 3))
        >>> joints.add("spherical", (0, 1), kn=100.0)
        >>> joints.start(zero, [0.0, 2.0], np.ones((2, 3)))
        >>> joints.result(0).type
        1
        """
        result = Result()
        self._call("result", joint, ct.byref(result))
        return JointState(**values_of(result))

    @property
    def energy(self) -> tuple[float, float]:
        """Work done on all joints, and the part that dampers took [force length].

        >>> import kjoint, numpy as np
        >>> joints, zero = kjoint.Joints(2, "legacy"), np.zeros((2, 3))
        >>> joints.add("spherical", (0, 1), kn=100.0)
        >>> joints.start(zero, [0.0, 2.0], np.ones((2, 3)))
        >>> joints.energy
        (0.0, 0.0)
        """
        work, dissipated = REAL(), REAL()
        self._call("energy", ct.byref(work), ct.byref(dissipated))
        return work.value, dissipated.value

    def warnings(self, limit: float = 0.01) -> list[str]:
        """Joints whose loss of orthogonality newly passes a limit [rad], as texts.

        >>> import kjoint, numpy as np
        >>> joints, zero = kjoint.Joints(2, "legacy"), np.zeros((2, 3))
        >>> joints.add("spherical", (0, 1), kn=100.0)
        >>> joints.start(zero, [0.0, 2.0], np.ones((2, 3)))
        >>> joints.warnings()
        []
        """
        count = INT()
        with self._alone():
            self._call("warnings", limit, ct.byref(count))
            return self._message().splitlines() if count.value else []

    @property
    def state(self) -> Array:
        """State as an array; assign it back to go on from there.

        >>> import kjoint, numpy as np
        >>> joints, zero = kjoint.Joints(2, "legacy"), np.zeros((2, 3))
        >>> joints.add("spherical", (0, 1), kn=100.0)
        >>> joints.start(zero, [0.0, 2.0], np.ones((2, 3)))
        >>> joints.state = joints.state
        """
        state = np.empty(self._number("state_size"))
        self._call("save", state.size, state)
        return state

    @state.setter
    def state(self, state: npt.ArrayLike) -> None:
        state = np.ascontiguousarray(state, dtype=float)
        self._call("restore", state.size, state)
