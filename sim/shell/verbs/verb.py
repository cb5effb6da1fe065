"""A verb: what stands after ``ros2 topic`` and the like."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from sim.shell.parser import LineParser
from sim.shell.session import ShellSession

Action: TypeAlias = Callable[[ShellSession, Namespace], None]


@dataclass(frozen=True, slots=True)
class Verb:
    """What it is called, which arguments it takes, and what it does.

    ``carry_out`` raises for any end but a good one: Failed, Ended, Interrupted, or an error that says
    what is wrong (NotImplementedError, PackageError, DefinitionError).
    """

    name: str
    help: str
    add_arguments: Callable[[LineParser], None]
    carry_out: Action


@dataclass(frozen=True, slots=True)
class ShellCommand:
    """A command with verbs, or one that is a verb itself."""

    name: str
    help: str
    verbs: tuple[Verb, ...] = ()
    itself: Verb | None = None


def no_arguments(parser: LineParser) -> None:
    """Add none."""


def add_graph_options(parser: LineParser) -> None:
    """The options of verbs that look at the graph, which is known here at once and without a daemon."""
    parser.add_argument(
        "--spin-time",
        type=float,
        default=None,
        help="Spin time in seconds to wait for discovery (only applies when not using an already running "
        "daemon)",
    )
    parser.flag("--no-daemon", help="Do not spawn nor use an already running daemon")
