"""The program kjoint out of the wheel, by the name of the command."""
import os
import pathlib
import sys


def main() -> None:
    """Become the program: its exit code, signals and streams are those of the command."""
    program = pathlib.Path(__file__).resolve().parent/"bin"/"kjoint"
    os.environ.setdefault("KJOINT_PYTHON", sys.executable)
    os.execv(program, [sys.argv[0], *sys.argv[1:]])
