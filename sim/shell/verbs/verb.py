"""Verbs: the words after ``ros2 topic`` and the other commands."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from sim.shell.parser import LineParser
from sim.shell.session import ShellSession

VerbAction: TypeAlias = Callable[[ShellSession, Namespace], None]


@dataclass(frozen=True, slots=True)
class Verb:
    """A verb: its name, its arguments and its action.

    ``carry_out`` raises for every end but success: CommandFailed, LineExit, CommandInterrupted, or an error
    whose text is a sentence (NotImplementedError, PackageError, DefinitionError).
    """

    name: str
    help: str
    add_arguments: Callable[[LineParser], None]
    carry_out: VerbAction


@dataclass(frozen=True, slots=True)
class ShellCommand:
    """A command with verbs, or one that is itself a verb."""

    name: str
    help: str
    verbs: tuple[Verb, ...] = ()
    itself: Verb | None = None


def add_hidden_nodes_option(parser: LineParser) -> None:
    """Add ``--include-hidden-nodes``."""
    parser.flag("--include-hidden-nodes", help="Consider hidden nodes as well")


def no_arguments(parser: LineParser) -> None:
    """Add none."""


def add_graph_options(parser: LineParser) -> None:
    """Add the options of verbs that read the graph, which have no effect: it is known without a daemon."""
    parser.add_argument(
        "--spin-time",
        type=float,
        default=None,
        help="Spin time in seconds to wait for discovery (only applies when not using an already running "
        "daemon)",
    )
    parser.flag("--no-daemon", help="Do not spawn nor use an already running daemon")
