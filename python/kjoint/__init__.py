"""kjoint in Python: joints between rigid bodies, without a compiler.

Mechanism  builds a mechanism in a few lines and runs it
Model      a Radioss deck: run it, or step, ask and change it
Run        a history file or a T01, with names, units and labels
Joints     joints as elements of a host that owns nodes, masses and time
sweep      many variants of a deck, by its /PARAMETER: an xarray.Dataset; run_beside: models side by side
kjoint.fit holds fit: values of /PARAMETER that meet targets
example    a pendulum to try things on; options(), version()

Arrays are numpy arrays of nodes x 3; quaternions are w x y z; angles in radian; vectors in the
global frame where nothing else is said; six-vectors are tx ty tz rx ry rz. What goes wrong raises
kjoint.Error. The library libkjoint_c is found beside this package, in the paths of the system, or
as the environment variable KJOINT_LIBRARY says. include/kjoint.h documents every call.

>>> import kjoint
>>> run = kjoint.example().run(until=1.0, sample=0.01)
>>> run["joint/force[hinge].norm"].shape                # N
(101,)
"""
from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:                                       # else loaded by the first use
    from ._error import Error
    from ._library import options, version
    from .joints import Joints
    from .mechanism import Mechanism, example
    from .model import Model, run_beside
    from .samples import Run
    from .variants import sweep

    __version__: str

_HOMES = {"Error": "_error", "options": "_library", "version": "_library", "Joints": "joints",
          "Mechanism": "mechanism", "Model": "model", "Run": "samples", "example": "mechanism",
          "run_beside": "model", "sweep": "variants"}
__all__ = ["Error", "Joints", "Mechanism", "Model", "Run", "example", "options", "run_beside", "sweep",
           "version"]


def __getattr__(name: str) -> Any:
    """The library is loaded with the first that needs it: what reads histories does without."""
    if name == "__version__":
        return importlib.import_module("._library", __name__).version()
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)
