"""A deck and its run."""
import ctypes as ct
import signal
import threading

import numpy as np

from ._library import FILES, INT, LIB, TICK, Body, Handle, Result, Status, encoded
from ._library import options as list_options


def _vector(values, n=3):
    array = np.ascontiguousarray(values, dtype=float)
    if array.shape != (n,):
        raise ValueError(f"expected {n} numbers")
    return array


class _Watcher:
    """Stands between a run and who watches it: what watch raises, and an interrupt (Ctrl-C) that
    comes while the run is in the library, stop the run and come out of it."""

    def __init__(self, watch):
        self.watch, self.raised, self.interrupt, self.watching = watch, None, None, False
        self.handler = None

    def tick(self, status, user):
        if self.watch and self.raised is None:
            try:
                self.watching = True
                # a copy: the library reuses its own
                if self.watch(Status.from_buffer_copy(status.contents)):
                    return 1
            except BaseException as raised:
                self.raised = raised
            finally:
                self.watching = False
        return int(self.raised is not None or self.interrupt is not None)

    def on_interrupt(self, number, frame):
        if self.watching:
            self.handler(number, frame)
        else:
            self.interrupt = number, frame

    def __enter__(self):
        if threading.current_thread() is threading.main_thread() \
                and callable(signal.getsignal(signal.SIGINT)):
            self.handler = signal.signal(signal.SIGINT, self.on_interrupt)
        return self

    def __exit__(self, kind, value, trace):
        if self.handler:
            signal.signal(signal.SIGINT, self.handler)
            if self.interrupt and self.raised is None:
                self.handler(*self.interrupt)
        if self.raised is not None:
            raise self.raised


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
        words = [f"{name}={int(value) if known[name].kind == 'flag' else value}"
                 for name, value in options.items() if value is not None]
        for word in words:
            if len(word.split()) != 1:
                raise ValueError(f"a blank in the option {word!r}")
        self._new(LIB.kj_model_load, encoded(deck), encoded(engine) if engine else None,
                  encoded(" ".join(words)))

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
        """Run from the start to the end. watch(status) may return True to stop; what it raises
        ends the run, too. Meanwhile the model can be read by nobody but its status by watch."""
        with self._alone(), _Watcher(watch) as watcher:
            tick = TICK(watcher.tick) if watch or watcher.handler else None
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

    def save(self):
        """State of a started model, as bytes."""
        size = ct.c_size_t()
        self._call("save", 0, None, ct.byref(size))
        state = ct.create_string_buffer(size.value)
        self._call("save", size, state, None)
        return state.raw

    def restore(self, state):
        """Go on from a saved state of the same deck: step(), advance() or run(). Same bits."""
        self._call("restore", len(state), state)
        return self

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
        name = encoded(channel)
        shape = [INT(), INT(), INT()]
        with self._alone():
            self._call("shape", name, *map(ct.byref, shape))
            row, entity, comp = (n.value for n in shape)
            values = np.empty((row, entity, comp))
            self._call("series", name, values.size, values)
        if comp == 1:
            values = values[:, :, 0]
        return values[:, 0] if "/" not in channel else values

    def curve(self, name):
        """One curve over the samples, as the command line names it: joint/force[pin C].norm."""
        values = np.empty(len(self["time"]))
        self._call("curve", encoded(name), len(values), values)
        return values

    def unit(self, channel):
        buffer = ct.create_string_buffer(100)
        self._call("unit", encoded(channel), buffer, 100)
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
        with FILES:
            self._call("write_history", encoded(path))

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
