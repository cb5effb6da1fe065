"""The tree of commands and verbs, and the parsers made of it."""

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
    """What a line's words mean: its ``verb``, and the values of that verb's arguments.

    Raises:
        HelpAsked: nothing is to be done but to show that help.
        UsageError: the words are no such line.
    """
    found = verb_parser(words)
    if found is not None:
        parser, used = found
        try:
            return parser.parse_args(words[used:])
        except (HelpAsked, UsageError):
            pass  # the parser of all lines, which takes long to make, says it in ros2's words
    return _line_parser().parse_args(words)


def _line_parser() -> LineParser:
    description = "ros2 is an extensible command-line tool for ROS 2."
    parser = LineParser(prog="ros2", description=description)
    commands = _subparsers(parser, "Commands", "ros2 <command>")
    for command in COMMANDS:
        own = commands.add_parser(command.name, help=command.help, description=command.help)
        if command.itself is not None:
            _make(own, command.itself)
            continue
        verbs = _subparsers(own, "Commands", f"ros2 {command.name} <verb>")
        for verb in command.verbs:
            _make(verbs.add_parser(verb.name, help=verb.help, description=verb.help), verb)
    return parser


def verb_parser(words: list[str]) -> tuple[LineParser, int] | None:
    """The parser of the verb that the words begin with, and how many of them name it; None: no such verb."""
    command = next((each for each in COMMANDS if words[:1] == [each.name]), None)
    if command is None:
        return None
    if command.itself is not None:
        return _made(command.itself, f"ros2 {command.name}"), 1
    verb = next((each for each in command.verbs if words[1:2] == [each.name]), None)
    return None if verb is None else (_made(verb, f"ros2 {command.name} {verb.name}"), 2)


def next_names(words: list[str]) -> list[str]:
    """The commands, or the verbs of the command, that can follow."""
    if not words:
        return [each.name for each in COMMANDS]
    command: ShellCommand | None = next((each for each in COMMANDS if each.name == words[0]), None)
    return [each.name for each in command.verbs] if command is not None and len(words) == 1 else []


def _subparsers(parser: LineParser, title: str, form: str) -> Any:
    hint = f"Call `{form} -h` for more detailed usage."
    parser.set_defaults(verb=Verb("", "", no_arguments, lambda *_: parser.print_help()))
    return parser.add_subparsers(title=title, metavar=hint, parser_class=LineParser)


def _made(verb: Verb, prog: str) -> LineParser:
    parser = LineParser(prog=prog)
    _make(parser, verb)
    return parser


def _make(parser: LineParser, verb: Verb) -> None:
    verb.add_arguments(parser)
    parser.set_defaults(verb=verb)
