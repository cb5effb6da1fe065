"""The loop of the console for screen readers: it prints news, and carries out typed commands."""

import asyncio
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from inspect import iscoroutine
from queue import Empty, Queue, SimpleQueue
from time import monotonic
from typing import ClassVar, Generic, Protocol

from textual.message import Message

from cbtui.keys.action import KeyAction, Scope, method_of
from cbtui.keys.actions import actions_of
from cbtui.keys.keymap import Keymap, keys_of
from cbtui.keys.named_keys import with_keys_in_force
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.linear.asking import AskedExport, ChainPrompt
from cbtui.screens.linear.dialogue import Dialogue
from cbtui.screens.linear.plain import plain, plain_lines, spoken_key
from cbtui.screens.linear.telling import Telling
from cbtui.screens.parts.part import ScreenPart, ScreenParts
from cbtui.screens.parts.runs import MakeRun, RunController, RunT_co
from cbtui.screens.windows.moment import seconds_in
from lessons.lesson import Lesson
from lessons.progress import Progress
from sim.quantities.durations import timestamp
from sim.quantities.nanoseconds import nearest_ns
from sim.trace.events import AnyEvent

_TURN = 0.25
"""Seconds between two checks for news."""
_OWN_WORDS = {
    "select": "Say what runs and what waits at this moment",
    "narrate": "Say what the executor decided last, and why",
    "diagnoses": "Say what goes wrong, why, and what to do about it; a cure can be tried in a live run",
    "leave": "End the run and leave",
    "compare": "Say what differs from the run before",
    "zoom_in": "Report shorter calls and waits, too",
    "zoom_out": "Report only longer calls and waits",
    "earlier": "Go back a second, and describe that moment",
    "later": "Go on a second, and describe that moment",
    "show_pane('guide')": "Read the guide",
    "show_pane('code')": "Read the code of the program",
    "show_pane('log')": "Read out every line of the log, or each text only once",
    "prompt": "Type a ros2 line, or the label of a key",
    "exercise": "Read the exercise and make its file; once you have changed the file, check it",
    "chain": "Say how long messages took from one topic or service to another, and where",
    "export": "Write the run so far to a file: a picture, report, table or trace",
    "group": "Give a callback another group, and run again",
    "set_up": "Change a timer's period, a number, the sensors' rate or the release of rclpy, and run again",
    "solution": "Read the solution: how your file becomes it, or the choices of a puzzle",
    "help": "List the keys that do something now",
}
"""The help of actions that do something else here than on a screen."""
_DRAWN = ("pan_earlier", "pan_later")
"""Actions that change only what is drawn."""
_TYPED = {" ": "space", "": "enter", "\x1b": "escape"}


class Input(Protocol):
    """The source of keys and lines."""

    def take_lines(self, *, wanted: bool) -> None:
        """Switch between whole lines and single keys."""


@dataclass
class LineTerminal:
    """The user's terminal.

    ``say`` prints a line; ``typed`` are keys and lines that were not taken yet, None is their end.
    """

    keyboard: Input
    say: Callable[[str], None]
    keymap: Keymap
    typed: Queue[str | None] = field(default_factory=Queue)


class LinearConsole(Generic[RunT_co]):
    """Prints what happens in a run; everything but ``typed`` and ``post`` is used on one thread.

    ``live`` returns the run if it has an engine. A subclass adds its own parts with ``add_parts`` and begins
    the first run.
    """

    SCOPE: ClassVar[Scope] = Scope.LESSON

    def __init__(
        self,
        terminal: LineTerminal,
        subject: ShownProgram,
        make: MakeRun[RunT_co],
        live: Callable[[], LiveRun | None] = lambda: None,
    ) -> None:
        self.subject = subject
        self.progress = Progress()
        self.terminal = terminal
        self._inbox: SimpleQueue[Message | Callable[[], object]] = SimpleQueue()
        self._dialogue: Dialogue | None = None
        self._leaves = False
        self._next: Lesson | None = None
        self.runs = RunController(make, self._inbox.put)
        self.telling = Telling(self, subject, self.runs, live, terminal.keymap)
        self.navigation = self.telling.navigation

    def add_parts(self, *parts: ScreenPart, **more: Callable[[], object]) -> None:
        """Add a console's own parts, and actions by their ids, to the common ones."""
        chain = ChainPrompt(self, self.runs, self.navigation)
        every = (self.navigation, self.telling, chain, AskedExport(self, self.runs), *parts)
        self._parts = ScreenParts(
            self, self.SCOPE, *every, go_to_time=lambda: self.ask(self._go_to()), **more
        )
        self._actions = [
            each._replace(help=_OWN_WORDS.get(each.id, each.help))
            for each in self.terminal.keymap.of(actions_of(self.SCOPE))
            if (each.id in _OWN_WORDS or each.id == each.name or each.scope is Scope.CHOICE)
            and each.name not in _DRAWN
            and hasattr(self, f"action_{each.name}")
        ]
        self._leaving = [key for each in self._actions if each.name == "leave" for key in keys_of(each)]

    def typed(self, text: str | None) -> None:
        """Receive a key or a line, None at the end of input; may be called from any thread."""
        self.terminal.typed.put(text)
        self.post(lambda: None)

    def post(self, do: Callable[[], object]) -> None:
        """Call ``do`` on the console's thread; may be called from any thread."""
        self._inbox.put(do)

    def run(self) -> Lesson | None:
        """Run until the user leaves; returns the lesson to continue with, if one was asked for."""
        self.ask(self.greet())
        turn = monotonic() + _TURN
        try:
            while not self._leaves:
                self._take_next(turn - monotonic())
                while self._has_something_to_take:
                    self._take(self.terminal.typed.get())
                if monotonic() >= turn:
                    if self._dialogue is None:
                        self.turn()
                    turn = monotonic() + _TURN
        finally:
            self.tell(self.runs.run.stop())
        return self._next

    @property
    def _has_something_to_take(self) -> bool:
        typed = self.terminal.typed.queue
        return bool(typed) and not self._leaves and (self.is_ready or typed[0] in self._leaving)

    # what differs from console to console

    @property
    def is_ready(self) -> bool:
        """Whether typed text is taken now or kept for later."""
        return True

    def greet(self) -> Dialogue:
        """Print what is run, and start it."""
        raise NotImplementedError

    def turn(self) -> None:
        """Print the news."""
        if self.navigation.playhead.follows:
            self.telling.tell_news()

    def take_events(self, events: Iterable[AnyEvent]) -> None:
        """Note events of the run."""
        self.telling.take(events)

    # the interface for parts

    @property
    def console(self) -> "LinearConsole[RunT_co]":
        """What opens lessons."""
        return self

    def tell(self, sentence: str | None) -> None:
        """Print a line; nothing for None."""
        if sentence is not None:
            self.terminal.say(plain(sentence))

    def tell_page(self, markdown: str) -> None:
        """Print a Markdown text, each paragraph as one line."""
        for line in plain_lines(with_keys_in_force(markdown, self.terminal.keymap)):
            self.terminal.say(line)

    def key(self, action: str) -> str:
        """Return the key in force of one of the console's actions in words; "" if there is no such action."""
        return next((spoken_key(each) for each in self._actions if each.name == action), "")

    def open_lesson(self, lesson: Lesson, changes: Changes | None = None, *, tour: bool = False) -> None:
        """Leave, and continue with a lesson."""
        self._next, self._leaves = lesson, True

    def redraw(self) -> None:
        """Do nothing: news is printed when it is due."""

    def show_new_run(self) -> None:
        """Print the news of another run from its beginning; called before it is started."""
        self.navigation.playhead = self.navigation.playhead.live()
        self.telling.begin()
        self.tell("it runs again")

    def ask(self, dialogue: Dialogue) -> None:
        """Begin a dialogue."""
        self._dialogue = dialogue
        self.terminal.keyboard.take_lines(wanted=True)
        self._answer(None)

    # input

    def _take_next(self, timeout: float) -> None:
        try:
            message = self._inbox.get(timeout=max(0.0, timeout))
        except Empty:
            return
        match message:
            case RunController.Delivered():
                self.tell(self.runs.take(message))
                if message.run == self.runs.number:
                    self.take_events(message.events)
            case RunController.Over():
                finish = self.runs.run.over(message.trouble) if message.run == self.runs.number else None
                self.tell(None if finish is None else finish())
            case Message():
                pass
            case do:
                do()

    def _take(self, typed: str | None) -> None:
        """Take an answer, a key, the label of one, or a ros2 line."""
        if typed is None:
            self._leaves = True
            self.terminal.typed.put(None)  # the console below has to end, too
        elif self._dialogue is not None:
            self._answer(typed.strip())
        else:
            self.carry_out(typed)

    def carry_out(self, typed: str) -> None:
        """Carry out a key, the label of one, or a ros2 line."""
        key, words = _TYPED.get(typed, typed), typed.strip()
        called = [each for each in self._actions if words and words in (each.label, each.name)]
        found = [each for each in self._actions if key in keys_of(each)] or called
        chosen = next(filter(self._offers, found), None)
        live = self.navigation.run_that_goes_on
        if chosen is not None:
            done = getattr(self, f"action_{chosen.name}")(*method_of(chosen)[1])
            if iscoroutine(done):
                asyncio.run(done)
        elif found:
            self.tell(f"{found[0].label or words} is not possible now")
        elif words.startswith("ros2 ") and live is not None:
            live.give_line(words)
        elif len(typed) > 1:
            self.tell(f"there is no key or label {words}; ? lists them all")

    def _offers(self, action: KeyAction) -> bool:
        return self._parts.offer(*method_of(action))

    def _answer(self, line: str | None) -> None:
        assert self._dialogue is not None
        try:
            self.tell(next(self._dialogue) if line is None else self._dialogue.send(line))
        except StopIteration:
            self._dialogue = None
            self.terminal.keyboard.take_lines(wanted=False)

    def _go_to(self) -> Dialogue:
        end = timestamp(self.runs.timeline.end)
        goes_on = self.navigation.run_that_goes_on is not None
        later = " For a later one it runs on, and stops there." if goes_on else ""
        line = yield f"Which second of the run? It is at {end}.{later}"
        seconds = seconds_in(line)
        if seconds is not None:
            self.navigation.go_to(nearest_ns(seconds))
        elif line:
            self.tell("Give the seconds as a number, such as 12.5.")

    # actions that belong to no part

    def action_leave(self) -> None:
        """End the run."""
        self._leaves = True

    def action_help(self) -> None:
        """Print the keys that work now; of actions with the same key only the first one."""
        taken = set[str]()
        for each in filter(self._offers, self._actions):
            if each.label and taken.isdisjoint(keys_of(each)):
                self.tell(f"{spoken_key(each)}: {each.label}: {each.help}")
            taken.update(keys_of(each))
