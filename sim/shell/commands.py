"""The tree of commands and verbs, and their parsers."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from sim.shell.parser import HelpAsked, LineParser, UsageError
from sim.shell.verbs.action import ACTION
from sim.shell.verbs.interface import INTERFACE
from sim.shell.verbs.launch import LAUNCH
from sim.shell.verbs.lifecycle import LIFECYCLE
from sim.shell.verbs.node import NODE
from sim.shell.verbs.param import PARAM
from sim.shell.verbs.pkg import PKG
from sim.shell.verbs.run import RUN
from sim.shell.verbs.service import SERVICE
from sim.shell.verbs.topic import TOPIC
from sim.shell.verbs.verb import ShellCommand, Verb, no_arguments

COMMANDS = (ACTION, INTERFACE, LAUNCH, LIFECYCLE, NODE, PARAM, PKG, RUN, SERVICE, TOPIC)


def parse(words: list[str]) -> Namespace:
    """Parse a line's words; return its ``verb``, and the values of that verb's arguments.

    Raises:
        HelpAsked: the line asks for help.
        UsageError: the words are not a valid line.
    """
    found = verb_parser(words)
    if found is not None:
        parser, used = found
        try:
            return parser.parse_args(words[used:])
        except (HelpAsked, UsageError):
            pass  # the parser of all lines, which is slow to create, has ros2's wording
    return _line_parser().parse_args(words)


def _line_parser() -> LineParser:
    description = "ros2 is an extensible command-line tool for ROS 2."
    parser = LineParser(prog="ros2", description=description)
    commands = _subparsers(parser, "ros2 <command>")
    for command in COMMANDS:
        own = commands.add_parser(command.name, help=command.help, description=command.help)
        if command.itself is not None:
            _make(own, command.itself)
            continue
        verbs = _subparsers(own, f"ros2 {command.name} <verb>")
        for verb in command.verbs:
            _make(verbs.add_parser(verb.name, help=verb.help, description=verb.help), verb)
    return parser


def verb_parser(words: list[str]) -> tuple[LineParser, int] | None:
    """Return the parser of the verb that the words begin with, and the number of words that name it."""
    command = next((each for each in COMMANDS if words[:1] == [each.name]), None)
    if command is None:
        return None
    if command.itself is not None:
        return _made(command.itself, f"ros2 {command.name}"), 1
    verb = next((each for each in command.verbs if words[1:2] == [each.name]), None)
    return None if verb is None else (_made(verb, f"ros2 {command.name} {verb.name}"), 2)


def next_names(words: list[str]) -> list[str]:
    """Return the commands, or the verbs of the command, that can follow."""
    if not words:
        return [each.name for each in COMMANDS]
    command: ShellCommand | None = next((each for each in COMMANDS if each.name == words[0]), None)
    return [each.name for each in command.verbs] if command is not None and len(words) == 1 else []


def _subparsers(parser: LineParser, form: str) -> Any:
    hint = f"Call `{form} -h` for more detailed usage."
    parser.set_defaults(verb=Verb("", "", no_arguments, lambda *_: parser.print_help()))
    return parser.add_subparsers(title="Commands", metavar=hint, parser_class=LineParser)


def _made(verb: Verb, prog: str) -> LineParser:
    parser = LineParser(prog=prog)
    _make(parser, verb)
    return parser


def _make(parser: LineParser, verb: Verb) -> None:
    verb.add_arguments(parser)
    parser.set_defaults(verb=verb)
