"""The keys that a run's screen offers, by the state of its parts and the focus; and why others do nothing."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from textual.widget import Widget

from cbtui.keys.action import Scope
from cbtui.looks.theme import Charset
from cbtui.runs.live.live_run import LiveRun, ShownRun
from cbtui.runs.live.replay import RecordedRun
from cbtui.screens.layout import Layout
from cbtui.screens.parts.part import RunHost, ScreenHost, ScreenPart, ScreenParts
from cbtui.screens.parts.runs import RunController
from cbtui.screens.sized import SizedScreen
from cbtui.terminal.textual_internals import take_back
from cbtui.widgets.checks import ChecksView
from cbtui.widgets.choice import ChoiceOptions
from cbtui.widgets.code import CodeView
from cbtui.widgets.key_bar import KeyBar, hint
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogFilter, LogLines
from cbtui.widgets.shell import ProgramKeyboard, Prompt, ShellOutput
from lessons.lesson import Lesson

_ON_LANES = ("zoom", "pan", "select", "code", "lane", "bar", "leave", "copy")
"""Labels of the actions that the lanes' frame shows."""

_FIRST_ON: Mapping[type[Widget], Sequence[str]] = {ShellOutput: ("ros2", "type"), LogLines: ("filter",)}
"""Labels that come first while a widget has the focus."""

_WITH_KEYS = (LogLines, CodeView, ChecksView, ChoiceOptions)
"""Panes with a ``check_action`` of their own."""

_TYPED_INTO = (Prompt, ProgramKeyboard, LogFilter)
_NOT_ON: Mapping[str, tuple[type[Widget], ...]] = {
    "pan_earlier": _TYPED_INTO,
    "pan_later": _TYPED_INTO,
    "select": (*_TYPED_INTO, ChoiceOptions),
    "next_pane": _TYPED_INTO,
    "jump": _TYPED_INTO,
    "copy_details": (*_TYPED_INTO, LogLines, CodeView),
    "open_source": (CodeView,),
}
"""Widgets that use an action's keys otherwise while they have the focus."""

_SCOPES: Mapping[type[Widget], Scope] = {
    Prompt: Scope.PROMPT,
    ProgramKeyboard: Scope.KEYBOARD,
    LogLines: Scope.LOG,
    LogFilter: Scope.FILTER,
    CodeView: Scope.CODE,
    ChecksView: Scope.CHECKS,
    ChoiceOptions: Scope.CHOICE,
}
"""The scope whose keys are shown while a widget has the focus."""


@dataclass
class OfferedKeys:
    """Tells which actions are available, and shows their keys.

    They stand in the registry's order, a pane's before the screen's, and the labels ``first`` before all.
    """

    screen: SizedScreen[Any]
    parts: ScreenParts
    charset: Charset
    first: Callable[[], Sequence[str]] = tuple
    reason: tuple[str, Callable[[], bool]] | None = None
    """The last sentence on why a key does nothing, and whether it is still so."""

    def offer(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Tell whether an action is available now."""
        focused = self.screen.focused
        if isinstance(focused, _WITH_KEYS) and not focused.check_action(action, parameters):
            return False
        if isinstance(focused, _NOT_ON.get(action, ())):
            return False
        if action in ("submit", "interrupt"):
            return not (isinstance(focused, ProgramKeyboard) and focused.reads.takes_keys)
        if action == "select" and self.parts.offer("prompt_here", ()):
            return False
        return self.parts.offer(action, parameters)

    def take_back_reason(self) -> None:
        """Show the last reason no longer."""
        if self.reason is not None:
            take_back(self.screen.app, self.reason[0])
            self.reason = None

    def show(self) -> None:
        """Update the key bar and the lanes' frame, and take back a reason that is none any more."""
        if self.reason is not None and not self.reason[1]():
            self.take_back_reason()
        lanes, bar = self.screen.query_one(Lanes), self.screen.query_one(KeyBar)
        # In the grid the lanes have a frame, which shows their keys.
        framed = self.screen.layout_now is Layout.GRID
        on_lanes = (*_ON_LANES, "enlarge") if lanes.has_focus and not framed else ()
        on_pane = (labels for kind, labels in _FIRST_ON.items() if isinstance(self.screen.focused, kind))
        bar.first = next(on_pane, on_lanes or self.first())
        options = self.screen.focused
        digits_choose = isinstance(options, ChoiceOptions) and not options.is_over
        hidden = {"show_pane"} if digits_choose else set()
        if isinstance(options, ChoiceOptions) and not options.option_count:
            hidden.add("choose")
        bar.offered = tuple(each for each in bar.working() if each.name not in hidden)
        of_screen = (action for action in bar.offered if action.scope is Scope.LESSON)
        lanes.hint = hint([action for action in of_screen if action.label in _ON_LANES], self.charset)

    def follow_focus(self) -> None:
        """Show the keys of the widget with the focus."""
        focused = self.screen.focused
        scopes = (scope for kind, scope in _SCOPES.items() if isinstance(focused, kind))
        self.screen.query_one(KeyBar).show(next(scopes, Scope.LESSON))


@dataclass
class Absences(ScreenPart):
    """Explains why an action makes no sense here; ``is_available`` tells whether it does something.

    ``kind`` returns what kind of run the screen shows, as a sentence on what that rules out, if there is one.
    """

    host: ScreenHost
    runs: RunController[ShownRun]
    lesson: Lesson | None
    is_available: Callable[[str], bool]
    kind: Callable[[], str] = lambda: ""

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the explanation where the action itself is not offered."""
        return not self.is_available(str(parameters[0]))

    def action_no_use(self, wanted: str) -> None:
        """Show the explanation."""
        self.host.tell(self._why(wanted), lambda: not self.is_available(wanted))

    def _why(self, wanted: str) -> str:
        run, key, kind = self.runs.run, self.host.key, self.kind()
        over = f"The run is over: {key('run_again')} runs it again."
        lessons = f"{key('leave')} leads to the menu with all of them."
        pauses = f"{key('pause')} pauses the run, then {key('step')} makes a step; "
        pauses = pauses if self.is_available("pause") else ""
        if isinstance(run, LiveRun) and run.alive and not run.virtual:
            pauses = "On the real clock nobody knows the next event: steps need virtual time; "
        sentences = {
            "step_back": "This is the beginning: no event is before it.",
            "earlier": "This is the beginning.",
            "later": "The end is on screen already.",
            "previous_event": "There is no earlier bar here.",
            "next_event": "There is no later bar here.",
            "zoom_out": "No longer stretch can be shown.",
            "zoom_in": "No shorter stretch can be shown.",
            "step": f"{pauses}{key('step_back')} looks back, event by event.",
            "cycle_camera": "There is no robot here whose map or camera could be shown.",
            "next_lesson": f"No lesson follows {'this one' if self.lesson else 'here'}: {lessons}",
            "live": f"The {'present' if run.alive else 'end'} is on screen already.",
            "undo": "Nothing was chosen that could be taken back.",
            "watch": "Only an exercise is watched again.",
            "chain": "No message has been sent so far.",
            "export": "Nothing has happened yet that could be exported.",
            "usual_sizes": "Lanes and panes have their usual sizes already.",
            "type": "No program reads from the keyboard now.",
            "compare": "There is only one run so far: nothing to compare it with.",
        }
        if self.lesson is not None and self.is_available("solution"):
            sentences["hint"] = f"No hint is left or needed; {key('solution')} shows the solution."
        if self.is_available("faster") or self.is_available("slower"):
            sentences |= {"slower": "It goes no slower.", "faster": "It goes no faster."}
        elif not run.alive:
            sentences |= dict.fromkeys(("pause", "slower", "faster", "record"), over)
        if not kind and self.lesson is not None:
            sentences["predict"] = f"There is nothing left to predict: {key('explain')} explains the run."
        elif not kind:
            explained = f"Only lessons are explained; {key('diagnoses')} lists what went wrong here."
            sentences |= dict.fromkeys(("predict", "explain"), explained)
        if isinstance(run, RecordedRun):
            kind = "This is a recording: nothing in it can be called, changed, recorded or run again."
        watched = "These processes are only watched: they can be neither changed nor run again from here."
        return sentences.get(wanted) or kind or (watched if run.alive else over)


@dataclass
class Refusals(ScreenPart):
    """Explains why an action does nothing; ``is_available`` tells whether it does something.

    ``lesson`` is None for a program that belongs to no lesson.
    """

    host: RunHost
    lesson: Lesson | None
    is_available: Callable[[str], bool]

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the refusal where the action itself is not offered."""
        return not self.is_available(action.removeprefix("no_"))

    def action_no_exercise(self) -> None:
        """Say that there is no exercise."""
        self._tell("")

    def action_no_hint(self) -> None:
        """Say when there are hints, or that all were taken."""
        self._tell(
            f"There are no more hints; {self.host.key('solution')} shows the solution."
            if self.is_available("solution")
            else "Hints come after the explanation: press {key}."
        )

    def action_no_solution(self) -> None:
        """Say when there is a solution."""
        self._tell("The solution comes after the explanation: press {key}.")

    def action_no_compare(self) -> None:
        """Say what makes a second run."""
        threads, group, set_up = map(self.host.key, ("threads", "group", "set_up"))
        self.host.tell(
            f"There is only one run so far: change something with {threads}, {group} or {set_up} first."
        )

    def _tell(self, with_exercise: str) -> None:
        """Say that there is no exercise, or the sentence about the existing one."""
        if self.lesson is None:
            self.host.tell("Your own program has no exercise; the lessons of the menu do.")
        elif self.lesson.exercise is None:
            self.host.tell(
                f"{self.lesson.title} has no exercise: it is done once it is predicted and explained."
            )
        else:
            self.host.tell(with_exercise.format(key=self.host.key("explain")))
