"""The type of an action: something the user can do with a key on a screen or pane."""

import re
from collections.abc import Iterable
from enum import StrEnum
from itertools import groupby
from operator import attrgetter
from typing import NamedTuple

from textual.actions import parse

PANES = ("guide", "code", "factory", "robot", "log", "shell")
"""The panes of a lesson, in the order of their keys."""
CHECKS = "checks"
"""The pane that an exercise has beside them; its key comes after theirs."""
CHOICE = "choice"
"""The pane that a run has beside them whose threads the learner schedules; with the same key."""


class Scope(StrEnum):
    """Where an action works."""

    EVERYWHERE = "Everywhere"
    MENU = "Menu"
    SEARCH = "Search in the menu"
    OPENING = "Opening a file"
    LESSON = "Lesson"
    COMPARE = "Comparison"
    LOG = "Log"
    FILTER = "Filter of the log"
    CODE = "Code"
    CHECKS = "Checks of an exercise"
    CHOICE = "Choice of who goes on"
    PROMPT = "Prompt"
    KEYBOARD = "Keyboard of the program"
    THREADS = "Choice of threads"
    GROUP = "Choice of a group"
    EXPORT = "Choice of a format"
    SETUP = "Set-up"
    DIAGNOSES = "Diagnoses"
    PREDICTION = "Prediction"
    SOLUTION = "Solution"
    ASKING = "Question"
    VALUE = "Choice of a value"
    MOMENT = "Choice of a moment"
    CHAIN = "Choice of a chain"
    HELP = "Help"
    TOUR = "Tour"
    JUMP = "Jump"


class KeyAction(NamedTuple):
    """Something the user can do. ``key`` is Textual's name of a key, ``help`` one sentence.

    Neighbours with the same ``label`` share a place in the footer, which leaves out those without one. Those
    with the same ``series`` share a line of the help, which says that instead.
    """

    scope: Scope
    id: str
    key: str
    label: str
    help: str
    series: str = ""

    @property
    def name(self) -> str:
        """Its id without arguments, by which the screen's method is named."""
        return self.id.partition("(")[0]

    @property
    def refused(self) -> str:
        """The id of the action in whose place it says why that is not available; "" for most actions."""
        name, _, argument = self.id.partition("(")
        return (argument.strip("')") or name.removeprefix("no_")) if name.startswith("no_") else ""

    @property
    def line(self) -> str:
        """The text in the help."""
        return self.series or self.help


def key_id(action: KeyAction) -> str:
    """Return an action's name in the configuration: ``lesson.pause``, ``lesson.show_pane_guide``."""
    words = re.findall(r"\w+", action.id)
    return f"{action.scope.name.lower()}.{'_'.join(words)}"


def method_of(action: KeyAction) -> tuple[str, tuple[object, ...]]:
    """Return the name and arguments that ``check_action`` gets for an action."""
    _, name, arguments = parse(action.id)
    return name, arguments


def group_by(actions: Iterable[KeyAction], field: str) -> list[tuple[KeyAction, ...]]:
    """Group neighbouring actions by the value of a field."""
    return [tuple(group) for _, group in groupby(actions, key=attrgetter(field))]
