"""Joints as elements of a host."""
import ctypes as ct

import numpy as np

from ._library import INT, LIB, REAL, Handle, Result, Spec, encoded


def _joint_types():
    """Numbers of the joint types by name, and their free directions by number."""
    name, free, numbers, free_dofs = ct.create_string_buffer(40), (INT * 6)(), {}, {}
    while LIB.kj_joint_type(len(numbers) + 1, name, len(name), free) == 0:
        numbers[name.value.decode()] = number = len(numbers) + 1
        free_dofs[number] = tuple(free)
    return numbers, free_dofs


TYPES, FREE = _joint_types()


def type_number(kind):
    """Number of a joint type from its number or name."""
    return TYPES[kind] if isinstance(kind, str) else int(kind)


def _table(array, n, width, name):
    """Numbers as C wants them: n x width, contiguous."""
    if array is None:
        return None
    array = np.ascontiguousarray(array, dtype=float)
    wanted = (n, width) if width > 1 else (n,)
    if array.shape != wanted:
        raise ValueError(f"{name} has the shape {array.shape}, not {wanted}")
    return array


class Joints(Handle):
    """Joints between the nodes of a host; see include/kjoint.h for every argument.

    formulation: "consistent" (frames follow the attitudes of the carriers) or "legacy" (they follow
    nodes and angular velocities, as in Radioss). n: nodes of the host.
    """

    kind = "joints"

    def __init__(self, n, formulation="consistent"):
        super().__init__()
        self.n = n
        self._new(LIB.kj_joints_new, encoded(formulation), n)

    def curve(self, x, y):
        """A function for the laws of joints that follow; gives its number."""
        x, y = (np.ascontiguousarray(a, dtype=float) for a in (x, y))
        if x.shape != y.shape:
            raise ValueError("x and y have different shapes")
        number = INT()
        self._call("curve", x.size, x, y, ct.byref(number))
        return number.value

    def add(self, kind, node, *, carrier=(None, None), axes=None, axis_node=(None, None), kn=0.0,
            cr=0.0, k=(0,) * 6, c=(0,) * 6, k_curve=None, c_curve=None, first_frame=False, id=0):
        """Add a joint: type, nodes of both ends, laws of its free directions."""
        spec = Spec()
        LIB.kj_joint_spec_init(ct.byref(spec))
        spec.id, spec.type, spec.kn, spec.cr = id, type_number(kind), kn, cr
        spec.first_frame = int(first_frame)
        for end in range(2):
            spec.node[end] = node[end]
            if carrier[end] is not None:
                spec.carrier[end] = carrier[end]
            if axis_node[end] is not None:
                spec.axis_node[3*end:3*end + 3] = list(axis_node[end])
        if axes is not None:
            spec.axes[:] = list(np.asarray(axes, dtype=float).ravel())
        for dof in range(6):
            spec.k[dof], spec.c[dof] = k[dof], c[dof]
        for dof, number in (k_curve or {}).items():
            spec.k_curve[dof] = number
        for dof, number in (c_curve or {}).items():
            spec.c_curve[dof] = number
        self._call("add", ct.byref(spec))

    def start(self, x, mass, inertia, attitude=None):
        """Fix the joints in the present places. mass 0: the host moves that node."""
        n = self.n
        self._call("start", n, _table(x, n, 3, "x"), _table(mass, n, 1, "mass"),
                   _table(inertia, n, 3, "inertia"), _table(attitude, n, 4, "attitude"))

    def take(self, model, node_id, attitude=None):
        """The joints of a deck instead; node_id: id in the deck of each host node."""
        ids = np.ascontiguousarray(node_id, dtype=np.intc)
        with model._alone():
            self._call("take", model._handle, ids.size, ids,
                       _table(attitude, self.n, 4, "attitude"))

    def forces(self, time, h, x, v, omega, f, m, attitude=None):
        """ADD forces and moments at t to f and m: arrays n x 3 of float64, contiguous."""
        for name, array in (("f", f), ("m", m)):
            if not (isinstance(array, np.ndarray) and array.dtype == float
                    and array.flags.c_contiguous and array.shape == (self.n, 3)):
                raise ValueError(f"{name} must be a contiguous float64 array {self.n} x 3")
        n = self.n
        self._call("forces", time, h, n, _table(x, n, 3, "x"), _table(v, n, 3, "v"),
                   _table(omega, n, 3, "omega"), _table(attitude, n, 4, "attitude"), f, m)

    def stiffness(self):
        """Stiffness of the joints at each node, for the nodal time step: kn, kr."""
        kn, kr = np.zeros(self.n), np.zeros(self.n)
        self._call("stiffness", self.n, kn, kr)
        return kn, kr

    @property
    def critical_step(self):
        """Largest stable step of the joints alone, in the present pose."""
        return self._number("critical_step", REAL)

    def __len__(self):
        return self._number("count")

    def result(self, joint):
        """What a joint does: force, displacement, frame, energy, dissipated, orthogonality."""
        result = Result()
        self._call("result", joint, ct.byref(result))
        return result

    @property
    def energy(self):
        """Work done on all joints, and the part that dampers took."""
        work, dissipated = REAL(), REAL()
        self._call("energy", ct.byref(work), ct.byref(dissipated))
        return work.value, dissipated.value

    def warnings(self, limit=0.01):
        """Joints whose loss of orthogonality newly passes a limit [rad], as texts."""
        count = INT()
        with self._alone():
            self._call("warnings", limit, ct.byref(count))
            return self._message().splitlines() if count.value else []

    @property
    def state(self):
        """State as an array; assign it back to go on from there."""
        state = np.empty(self._number("state_size"))
        self._call("save", state.size, state)
        return state

    @state.setter
    def state(self, state):
        state = np.ascontiguousarray(state, dtype=float)
        self._call("restore", state.size, state)
