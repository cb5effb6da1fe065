"""Options and arguments of the verbs: argparse, whose help and complaints come as exceptions."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, NoReturn, TypeAlias

from sim.packages import Packages
from sim.shell.ground import Ground

_WIDTH = 78
"""Columns of help and usage: what argparse makes of a terminal of 80."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What candidates are looked up in; ``given`` are the arguments before the one that is completed."""

    ground: Ground
    packages: Packages
    given: tuple[str, ...]


Completer: TypeAlias = Callable[[Surroundings], Iterable[str]]
"""Tells candidates, quoted for a shell; Failed or PackageError: what was given before is not known."""


class HelpAsked(Exception):  # noqa: N818 -- no error
    """``-h`` was among the words; the text is the help."""


class UsageError(Exception):
    """The words are no such line; the text is argparse's complaint."""


class LineParser(argparse.ArgumentParser):
    """An argument parser that prints nothing and ends no process.

    Raises:
        HelpAsked, UsageError: by ``parse_args``.
    """

    def __init__(self, **options: Any) -> None:
        options.setdefault("formatter_class", _Formatter)
        super().__init__(**options)
        self.completers: dict[argparse.Action, Completer] = {}

    def argument(self, *names: str, completer: Completer | None = None, **options: Any) -> None:
        """Add an option or argument, and who tells candidates for its value."""
        action = self.add_argument(*names, **options)
        if completer is not None:
            self.completers[action] = completer

    def flag(self, *names: str, **options: Any) -> None:
        """Add an option without a value."""
        self.add_argument(*names, action="store_true", **options)

    def print_help(self, file: object = None) -> NoReturn:
        """Raise HelpAsked."""
        raise HelpAsked(self.format_help())

    def error(self, message: str) -> NoReturn:
        """Raise UsageError."""
        raise UsageError(f"{self.format_usage()}{self.prog}: error: {message}")


class _Formatter(argparse.HelpFormatter):
    def __init__(self, prog: str, **options: Any) -> None:
        super().__init__(prog, **{**options, "width": _WIDTH})


def positive_float(text: str) -> float:
    """A number above zero; raises ArgumentTypeError for another, ValueError for no number."""
    value = float(text)
    if not value > 0.0:
        raise argparse.ArgumentTypeError("value must be positive")
    return value


def positive_int(text: str) -> int:
    """An integer above zero; raises as ``positive_float``."""
    value = int(text)
    if value <= 0:
        raise argparse.ArgumentTypeError("value must be a positive integer")
    return value


def nonnegative_int(text: str) -> int:
    """An integer of zero or more; raises as ``positive_float``."""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError("value must be positive or zero")
    return value


def unsigned_int(text: str) -> int:
    """A length; raises as ``positive_float``."""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError("value must be non-negative integer")
    return value
