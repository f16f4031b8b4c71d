"""kjoint in Python: joints between rigid bodies, without a compiler.

Mechanism  builds a mechanism in a few lines and runs it
Model      a Radioss deck: run it, or step, ask and change it
Joints     joints as elements of a host that owns nodes, masses and time

Arrays are numpy arrays of nodes x 3; quaternions are w x y z; angles in radian; vectors in the
global frame where nothing else is said; six-vectors are tx ty tz rx ry rz. What goes wrong raises
kjoint.Error. The library libkjoint_c is found beside this package, in the paths of the system, or
as the environment variable KJOINT_LIBRARY says. include/kjoint.h documents every call.
"""
from ._library import Error, options, version
from .joints import Joints
from .mechanism import Mechanism
from .model import Model

__version__ = version()

__all__ = ["Error", "Joints", "Mechanism", "Model", "options", "version"]
