"""Parts of the console in lines that ask before they act: chains, exports, and changes of the set-up."""

import asyncio
from collections.abc import Callable, Generator
from dataclasses import dataclass
from threading import Thread
from typing import Protocol

from cbtui.runs.live.live_export import LiveExport
from cbtui.runs.live.live_recording import FinishFile
from cbtui.runs.live.live_run import LiveRun, ShownRun
from cbtui.runs.setup.changeable import ChangeableSetup, changeable
from cbtui.runs.setup.changes import GROUP_CHOICES
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.linear.dialogue import Dialogue, LineHost
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.part import ScreenPart
from cbtui.screens.parts.restarts import Restarts
from cbtui.screens.parts.runs import RunController
from cbtui.screens.windows.chain import known_names, names_in
from cbtui.screens.windows.export import CHOICES
from cbtui.screens.windows.setup_rows import GroupRow, ValueRow, rows_of
from sim.quantities.durations import duration, timestamp
from sim.trace.figures.chains import ChainError, chain


class PostingHost(LineHost, Protocol):
    """A line host that other threads can post to."""

    def post(self, do: Callable[[], object]) -> None:
        """Call ``do`` on the console's thread; may be called from any thread."""


def choose(host: LineHost, what: str, question: str, names: list[str]) -> Generator[str, str, int | None]:
    """Ask for the number of one of some names; returns its index, None if no ``what`` has that number."""
    numbered = ", ".join(f"{number}: {name}" for number, name in enumerate(names, start=1))
    line = yield f"{question} {numbered}. Type its number, or nothing:"
    if line.isdecimal() and 0 < int(line) <= len(names):
        return int(line) - 1
    host.tell(f"There is no {what} {line}." if line else None)
    return None


@dataclass
class ChainPrompt(ScreenPart):
    """Prints how long messages took from one topic or service to another, and where."""

    host: LineHost
    runs: RunController[ShownRun]
    navigation: TimeNavigation

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer it once a message was sent."""
        return bool(self.runs.timeline.names_sent)

    def action_chain(self) -> None:
        """Ask for the names."""
        self.host.ask(self._ask())

    def _ask(self) -> Dialogue:
        timeline = self.runs.timeline
        known = known_names(timeline.names_sent)
        names = names_in((yield f"From which to which, such as first:last? {known}"))
        if not names:
            return
        try:
            found = chain(timeline, names)
        except ChainError as error:
            self.host.tell(f"{error}")
            return
        done = [each for each in found.whole_chain if each.input.at <= self.navigation.now]
        if not done:
            self.host.tell(f"Nothing has gone all the way from {names[0]} to {names[-1]} yet.")
            return
        for said, each in (("The last", done[-1]), ("The slowest", max(done, key=lambda run: run.latency))):
            took, began = duration(each.latency), timestamp(each.input.at)
            self.host.tell(f"{said} way from {names[0]} to {names[-1]} began at {began} and took {took}:")
            for step in each.steps:
                self.host.tell(f"{duration(step.length)}: {step.words}")


@dataclass
class AskedExport(ScreenPart):
    """Writes the run so far to a file in the current folder."""

    host: PostingHost
    runs: RunController[ShownRun]

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer an export once there are events."""
        return self.runs.timeline.end > 0

    def action_export(self) -> None:
        """Ask for the format, and export the run so far."""
        self.host.ask(self._ask())

    def _ask(self) -> Dialogue:
        choices = [choice for choice in CHOICES.values() if not choice.on_screen]
        texts = [f"{choice.title}, {choice.meaning}" for choice in choices]
        place = yield from choose(self.host, "format", "Export the run so far as what?", texts)
        if place is None:
            return
        try:
            export = LiveExport(self.runs.run.material(), choices[place].form, None)
        except FileNotFoundError:
            self.host.tell("The current folder is gone; start the console in another one.")
            return

        FinishInLines(self.host).finish(export.write)


@dataclass
class FinishInLines:
    """Finishes files in the background."""

    host: PostingHost

    def finish(self, finish: FinishFile | None) -> None:
        """Finish a file and print the result; does nothing for None."""

        def write(finish: FinishFile) -> None:
            said = finish()
            self.host.post(lambda: self.host.tell(said))

        if finish is not None:
            Thread(target=write, args=(finish,), name="file", daemon=True).start()


@dataclass
class AskedSetUp(ScreenPart):
    """Changes a callback's group or a value of the set-up, and restarts the run."""

    host: LineHost
    runs: RunController[LiveRun]
    restarts: Restarts
    subject: ShownProgram

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer it for a run that starts its programs itself; others are only watched."""
        return bool(self.runs.run.setup.programs)

    def action_group(self) -> None:
        """Ask for the callback and its group."""
        self.host.ask(self._ask_group())

    def action_set_up(self) -> None:
        """Ask for the setting and its value."""
        self.host.ask(self._ask_value())

    @property
    def _changeable(self) -> ChangeableSetup:
        run = self.runs.run
        return changeable(self.subject, run.setup, run.timeline)

    def _ask_value(self) -> Dialogue:
        rows = [row for row in rows_of(self._changeable) if isinstance(row, ValueRow) and not row.is_fixed]
        names = [f"{row.what} {row.aspect}, now {row.now}" for row in rows]
        place = yield from choose(self.host, "setting", "Which setting?", names)
        if place is None:
            return
        row = rows[place]
        line = yield f"Which {row.kind.name}? Give {row.kind.bounds}, or nothing for the program's own:"
        try:
            value = row.kind.read(line) if line else None
        except ValueError as error:
            self.host.tell(f"{error}.")
        else:
            asyncio.run(self.restarts.again(row.take(self.restarts.changes, (value,))))

    def _ask_group(self) -> Dialogue:
        callbacks = self._changeable.callbacks
        names = [f"{each.title}, now in group {each.group}" for each in callbacks]
        place = yield from choose(self.host, "callback", "Which callback?", names)
        if place is None:
            return
        row = GroupRow(callbacks[place])
        group = yield f"Which group: {', '.join(GROUP_CHOICES)}? Nothing for the program's own:"
        if group and group not in GROUP_CHOICES:
            self.host.tell(f"There is no group {group}.")
            return
        asyncio.run(self.restarts.again(row.take(self.restarts.changes, group)))
