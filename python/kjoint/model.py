"""A deck and its run."""
import ctypes as ct
import os

import numpy as np

from ._library import INT, LIB, TICK, Body, Handle, Result, Status
from ._library import options as list_options


def _vector(values, n=3):
    array = np.ascontiguousarray(values, dtype=float)
    if array.shape != (n,):
        raise ValueError(f"expected {n} numbers")
    return array


class Model(Handle):
    """A Radioss deck. Options: those of kjoint.options(), as the command line has them, such as
    until=0.1, formulation="legacy", islands=True; None leaves one out.

    run() keeps samples; model["joint/force"] is a channel over time, model.channels lists them.
    Or start(), then advance(t) or step(), body(id), joint(id), set_..., sample().
    """

    kind = "model"

    def __init__(self, deck, engine=None, **options):
        super().__init__()
        known = list_options()
        for name in options:
            if name not in known:
                raise TypeError(f"there is no option {name}")
        text = " ".join(f"{name}={int(value) if known[name].kind == 'flag' else value}"
                        for name, value in options.items() if value is not None)
        self._new(LIB.kj_model_load, os.fsencode(deck), engine and os.fsencode(engine),
                  text.encode())

    @property
    def options(self):
        """The options that are not left to the deck, with what the formulation decides, as texts."""
        return dict(word.split("=") for word in self._message("options").split())

    @property
    def title(self):
        return self._message("title")

    @property
    def warnings(self):
        """Warnings about the deck."""
        return self._message("warnings").splitlines()

    def run(self, watch=None):
        """Run from the start to the end. watch(status) may return True to stop."""
        tick = TICK(lambda status, user: bool(watch(status.contents))) if watch else None
        self._call("run", tick and ct.cast(tick, ct.c_void_p), None)
        return self

    def start(self):
        """State at t = 0, to be stepped."""
        self._call("start")
        return self

    def advance(self, until):
        """March to a time."""
        self._call("advance", until)

    def step(self):
        """March one step."""
        self._call("step")

    def sample(self):
        """Keep a sample of the present."""
        self._call("sample")

    @property
    def status(self):
        status = Status()
        self._call("status", ct.byref(status))
        return status

    @property
    def channels(self):
        """Names of all channels."""
        return self._message("channels").splitlines()

    def __getitem__(self, channel):
        """Samples of a channel: time, or time x joint (body, node), or with x component."""
        name = channel.encode()
        shape = [INT(), INT(), INT()]
        self._call("shape", name, *map(ct.byref, shape))
        row, entity, comp = (n.value for n in shape)
        values = np.empty((row, entity, comp))
        self._call("series", name, values.size, values)
        if comp == 1:
            values = values[:, :, 0]
        return values[:, 0] if "/" not in channel else values

    def unit(self, channel):
        buffer = ct.create_string_buffer(100)
        self._call("unit", channel.encode(), buffer, 100)
        return buffer.value.decode()

    def plot(self, *channels, path=None):
        """Channels over time with matplotlib; path: a picture instead of a window."""
        import matplotlib.pyplot as plt
        figure, axes = plt.subplots(len(channels), 1, sharex=True, squeeze=False,
                                    figsize=(8, 2.5*len(channels)), layout="constrained")
        for channel, ax in zip(channels, axes[:, 0]):
            values = self[channel]
            ax.plot(self["time"], values.reshape(len(values), -1))
            ax.set_ylabel(f"{channel} [{self.unit(channel)}]")
        axes[-1, 0].set_xlabel(f"time [{self.unit('time')}]")
        if path:
            figure.savefig(path)
        else:
            plt.show()
        plt.close(figure)

    def write_history(self, path):
        """The samples as a history file (HDF5)."""
        self._call("write_history", os.fsencode(path))

    def _ids(self, what):
        count = self._number(f"{what}_count")
        ids = (INT * max(1, count))()
        self._call(f"{what}_ids", count, ct.byref(ids))
        return list(ids[:count])

    @property
    def bodies(self):
        """Ids of all rigid bodies."""
        return self._ids("body")

    @property
    def joints(self):
        """Ids of all joints."""
        return self._ids("joint")

    def body(self, id):
        """A body now: mass, position, attitude, velocity, omega, force, moment."""
        body = Body()
        self._call("body", id, ct.byref(body))
        return body

    def joint(self, id):
        """A joint now: force, displacement, frame, energy, dissipated, orthogonality."""
        result = Result()
        self._call("joint", id, ct.byref(result))
        return result

    def node(self, id):
        """Place of a node now."""
        x = np.empty(3)
        self._call("node", id, x)
        return x

    def set_body_load(self, id, force=(0, 0, 0), moment=(0, 0, 0)):
        """Force and moment on a body until set anew."""
        self._call("set_body_load", id, _vector(force), _vector(moment))

    def set_load_factor(self, id, factor):
        """Factor on the concentrated load /CLOAD/id."""
        self._call("set_load_factor", id, factor)

    def set_body_velocity(self, id, velocity, omega=(0, 0, 0)):
        self._call("set_body_velocity", id, _vector(velocity), _vector(omega))

    def set_body_pose(self, id, position, attitude=(1, 0, 0, 0)):
        """Put a body elsewhere; attitude: turn since the start. Consistent only."""
        self._call("set_body_pose", id, _vector(position), _vector(attitude, 4))

    def lock_joint(self, id, locked=True):
        """Lock or free a /PROP/KJOINT2 joint."""
        self._call("lock_joint", id, int(locked))
