"""The one registry of what a person can do: keys, footer, palette and help all read it.

A screen only implements ``action_<id>`` for the actions of its scope, and says in ``check_action`` which of
them have a meaning now.
"""

from collections.abc import Iterable
from enum import StrEnum
from itertools import groupby
from operator import attrgetter
from typing import NamedTuple

from textual.actions import parse
from textual.binding import Binding

from cbtui.theme import Charset


class Scope(StrEnum):
    """Where an action works."""

    EVERYWHERE = "Everywhere"
    MENU = "Menu"
    LESSON = "Lesson"
    PROMPT = "Prompt"
    THREADS = "Choice of threads"
    MOMENT = "Choice of a moment"
    HELP = "Help"


class Action(NamedTuple):
    """Something a person can do. ``key`` is Textual's name of a key, ``help`` one sentence.

    Neighbours with the same ``label`` share a place in the footer; those with the same ``series`` share a
    line of the help, which says that instead.
    """

    id: str
    key: str
    label: str
    help: str
    scope: Scope
    series: str = ""

    @property
    def line(self) -> str:
        """What the help says."""
        return self.series or self.help


_ALONE = (Scope.PROMPT, Scope.THREADS, Scope.MOMENT, Scope.HELP)

PANES = ("guide", "code", "robot", "log", "shell")
"""The panes of a lesson, in the order of their keys."""

ACTIONS = (
    Action("open", "enter", "open", "Open the highlighted lesson", Scope.MENU),
    *(
        Action(
            f"open_number({number})",
            str(number),
            "open",
            f"Open lesson {number}",
            Scope.MENU,
            "Open the lesson with this number",
        )
        for number in range(1, 10)
    ),
    Action("previous", "up", "choose", "Highlight the lesson above", Scope.MENU),
    Action("next", "down", "choose", "Highlight the lesson below", Scope.MENU),
    Action("call_service", "s", "service", "Call the lesson's SetBool service with true", Scope.LESSON),
    Action("call_service_off", "S", "false", "Call the lesson's SetBool service with false", Scope.LESSON),
    Action("pause", "space", "pause", "Stop time for every thread", Scope.LESSON),
    Action("resume", "space", "go on", "Let time go on", Scope.LESSON),
    Action(
        "step",
        "full_stop",
        "step",
        "Go on by one decision, in a pause; looking back, by one event",
        Scope.LESSON,
    ),
    Action(
        "threads", "t", "threads", "Choose how many threads the executor gets, and run again", Scope.LESSON
    ),
    Action("reset_world", "r", "reset", "Put the robot back to its start", Scope.LESSON),
    Action("run_again", "r", "run again", "Run again, when the run is over", Scope.LESSON),
    Action("next_lesson", "n", "next", "Open the next lesson", Scope.LESSON),
    Action("live", "0", "live", "Go back to the present", Scope.LESSON),
    *(
        Action(
            f"show_pane('{name}')",
            str(number),
            "pane",
            f"Go to the {name}",
            Scope.LESSON,
            f"Go to a pane: {', '.join(PANES)}",
        )
        for number, name in enumerate(PANES, start=1)
    ),
    Action("prompt", "colon", "ros2", "Type a ros2 line; tab completes, up brings lines back", Scope.LESSON),
    Action(
        "record", "R", "record", "Begin a recording of the run in the current folder, or end it", Scope.LESSON
    ),
    Action("go_to_time", "g", "go to", "Look back at a moment, or run on until it has come", Scope.LESSON),
    Action("step_back", "comma", "look back", "Look at the event before the moment on screen", Scope.LESSON),
    Action("earlier", "left", "look back", "Look at an earlier stretch of the run", Scope.LESSON),
    Action("later", "right", "look back", "Look at a later stretch of the run", Scope.LESSON),
    Action("slower", "minus", "speed", "Let time pass more slowly", Scope.LESSON),
    Action("faster", "plus", "speed", "Let time pass faster", Scope.LESSON),
    Action("zoom_out", "less_than_sign", "zoom", "Show a longer stretch of time", Scope.LESSON),
    Action("zoom_in", "greater_than_sign", "zoom", "Show a shorter stretch of time", Scope.LESSON),
    Action("next_pane", "tab", "next pane", "Go to the next pane", Scope.LESSON),
    Action("maximise", "z", "enlarge", "Let one pane fill the screen; press again to go back", Scope.LESSON),
    Action("leave", "q", "menu", "End the run and go back to the menu", Scope.LESSON),
    Action("leave", "q", "quit", "Leave the console", Scope.MENU),
    Action("submit", "enter", "run", "Carry out the line", Scope.PROMPT),
    Action("complete", "tab", "complete", "Complete the word at the cursor", Scope.PROMPT),
    Action("older", "up", "lines before", "Bring back the line before", Scope.PROMPT),
    Action("newer", "down", "lines before", "Go on to the line after", Scope.PROMPT),
    Action("interrupt", "ctrl+c", "interrupt", "End the line that goes on", Scope.PROMPT),
    Action("leave_prompt", "escape", "other keys", "Go back to the other keys", Scope.PROMPT),
    *(
        Action(f"choose({number})", str(number), "threads", f"Run with {number} threads", Scope.THREADS)
        for number in range(1, 9)
    ),
    Action("choose(0)", "o", "the program's own", "Run with the program's own number", Scope.THREADS),
    Action("close", "escape,q", "close", "Close the window, and leave everything as it is", Scope.THREADS),
    Action("go", "enter", "go", "Go to the moment", Scope.MOMENT),
    Action("close", "escape", "close", "Close the window, and stay where you are", Scope.MOMENT),
    Action("close", "escape,q,question_mark", "close", "Go back to where you were", Scope.HELP),
    Action("command_palette", "ctrl+p", "commands", "Find any command, and colour themes", Scope.EVERYWHERE),
    Action("help", "question_mark", "help", "Show every key and what it does", Scope.EVERYWHERE),
)


def actions_of(scope: Scope) -> tuple[Action, ...]:
    """Return the actions that work in a scope; outside of prompt and windows also those of everywhere."""
    scopes = (scope,) if scope in _ALONE else (scope, Scope.EVERYWHERE)
    return tuple(action for action in ACTIONS if action.scope in scopes)


def bindings_of(*scopes: Scope) -> list[Binding]:
    """Return the key bindings of the actions that belong to exactly these scopes."""
    return [_binding(action) for action in ACTIONS if action.scope in scopes]


_PLACES = {Scope.EVERYWHERE: "app", Scope.PROMPT: "focused"}
"""What implements the actions of a scope, where it is not the screen."""


def target_of(action: Action) -> str:
    """Return the action with the place that implements it, as a click or the palette has to name it."""
    return f"{_PLACES.get(action.scope, 'screen')}.{action.id}"


def _binding(action: Action) -> Binding:
    return Binding(
        action.key,
        action.id,
        action.label,
        tooltip=action.help,
        id=f"{action.scope.name.lower()}.{action.id}",
        priority=action.key in _KEYS_THAT_WIDGETS_WANT,
    )


_KEYS_THAT_WIDGETS_WANT = {"left", "right", "tab", "ctrl+c"}
"""Panes scroll with the arrows and pass the focus on with tab: the screen has to be asked first."""

_SIGNS = {
    "enter": "⏎",
    "space": "␣",
    "up": "↑",
    "down": "↓",
    "left": "←",
    "right": "→",
    "minus": "-",
    "plus": "+",
    "less_than_sign": "<",
    "greater_than_sign": ">",
    "question_mark": "?",
    "comma": ",",
    "full_stop": ".",
    "colon": ":",
    "ctrl+p": "^p",
    "ctrl+c": "^c",
    "escape": "esc",
}
_PLAIN_SIGNS = _SIGNS | {
    "enter": "enter",
    "space": "space",
    "up": "up",
    "down": "down",
    "left": "left",
    "right": "right",
}


def signs_of(actions: Iterable[Action], charset: Charset) -> str:
    """Return the keys of some actions as people write them."""
    signs = _PLAIN_SIGNS if charset is Charset.ASCII else _SIGNS
    keys = [action.key.partition(",")[0] for action in actions]
    digits = [key for key in keys if key.isdigit()]
    if len(digits) > 2:
        keys = [key for key in keys if key not in digits] + [f"{digits[0]}-{digits[-1]}"]
    return " ".join(signs.get(key, key) for key in keys)


def method_of(action: Action) -> tuple[str, tuple[object, ...]]:
    """Return the name and the arguments with which a screen is asked whether an action works now."""
    _, name, arguments = parse(action.id)
    return name, arguments


def together(actions: Iterable[Action], field: str) -> list[tuple[Action, ...]]:
    """Put neighbours together that agree in a field."""
    return [tuple(group) for _, group in groupby(actions, key=attrgetter(field))]
