"""What goes wrong, said in words."""
from __future__ import annotations

import argparse
import difflib
import sys
from collections.abc import Iterable, Sequence
from typing import NoReturn


class Error(RuntimeError):
    """What kjoint has to say. `status`, a number: 1 run, 2 input, 3 file, 4 internal.

    >>> import kjoint
    >>> try:
    ...     kjoint.Model("nowhere_0000.rad")
    ... except kjoint.Error as error:
    ...     print(error.status)
    3
    """

    __module__ = "kjoint"

    def __init__(self, message: str, status: int = 2) -> None:
        super().__init__(message)
        self.status = status


def unknown(what: str, name: object, known: Iterable[str]) -> Error:
    """The error about a name that there is not, with the one that was meant."""
    names = list(known)
    close = difflib.get_close_matches(str(name).lower(), [n.lower() for n in names], 1, 0.5)
    meant = next((n for n in names if close and n.lower() == close[0]), None)
    if meant:
        return Error(f"no {what} {name!r}, did you mean {meant!r}?")
    return Error(f"no {what} {name!r}: there are " + (", ".join(names[:20]) or "none"))


class Parser(argparse.ArgumentParser):
    """The words of a command; what is wrong with them is one line, rc 2."""

    def error(self, message: str) -> NoReturn:
        print(f"error: {message}", file=sys.stderr)
        sys.exit(2)

    def read(self, words: Sequence[str] | None = None) -> argparse.Namespace:
        """parse_args, which in older Pythons makes an empty list of the value in --NAME=--."""
        args = self.parse_args(words)
        for name, value in vars(args).items():
            if value == [] != self.get_default(name) or isinstance(value, list) and [] in value:
                self.error(f"argument --{name}: -- is no value")
        return args
