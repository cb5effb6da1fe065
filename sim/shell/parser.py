"""Options and arguments of the verbs: argparse with exceptions for help and errors."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, NoReturn, TypeAlias

from sim.packages import Packages
from sim.shell.ground import Ground

_WIDTH = 78
"""Columns of help and usage, as argparse has on a terminal of 80 columns."""


@dataclass(frozen=True, slots=True)
class Surroundings:
    """The sources of candidates; ``given`` are the arguments before the completed one."""

    ground: Ground
    packages: Packages
    given: tuple[str, ...]


Completer: TypeAlias = Callable[[Surroundings], Iterable[str]]
"""Returns candidates, quoted for a shell; raises CommandFailed or PackageError for unknown arguments."""


class HelpAsked(Exception):  # noqa: N818 -- not an error
    """A line asks for help, which is the text."""


class UsageError(Exception):
    """The words are not a valid line; the text is a sentence."""


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
        """Add an option or argument, with a completer for its value."""
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
        """Raise UsageError, without the usage, which would hide the reason in a small pane."""
        raise UsageError(f"{self.prog}: error: {message} (see {self.prog} -h)")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuse a word that is none of the choices, with the nearest of them."""
        if action.choices is None or value in action.choices:
            return
        choices = [str(each) for each in action.choices]
        near = get_close_matches(str(value), choices, 1)
        advice = f"; did you mean {near[0]}?" if near else f" (choose from {', '.join(choices)})"
        about = None if isinstance(action, argparse._SubParsersAction) else action
        raise argparse.ArgumentError(about, f"invalid choice: {value!r}{advice}")


class _Formatter(argparse.HelpFormatter):
    def __init__(self, prog: str, **options: Any) -> None:
        super().__init__(prog, **{**options, "width": _WIDTH})


def positive_float(text: str) -> float:
    """Read a number above zero; raise ArgumentTypeError for another, ValueError for other text."""
    value = float(text)
    if not value > 0.0:
        raise argparse.ArgumentTypeError("value must be positive")
    return value


def positive_int(text: str) -> int:
    """Read an integer above zero; raises as ``positive_float``."""
    value = int(text)
    if value <= 0:
        raise argparse.ArgumentTypeError("value must be a positive integer")
    return value


def nonnegative_int(text: str) -> int:
    """Read an integer of zero or more; raises as ``positive_float``."""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError("value must be positive or zero")
    return value


def unsigned_int(text: str) -> int:
    """Read a length; raises as ``positive_float``."""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError("value must be non-negative integer")
    return value
