"""What a console in lines asks for before it follows a chain, exports the run or changes a group."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from threading import Thread
from typing import Protocol

from cbtui.runs.live.live_export import LiveExport
from cbtui.runs.live.live_run import LiveRun, ShownRun
from cbtui.runs.setup.changeable import changeable
from cbtui.runs.setup.changes import GROUP_CHOICES
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.linear.dialogue import Dialogue, LineHost
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.part import ScreenPart
from cbtui.screens.parts.restarts import Restarts
from cbtui.screens.parts.runs import RunController
from cbtui.screens.windows.chain import names_in
from cbtui.screens.windows.export import CHOICES
from cbtui.screens.windows.setup_rows import GroupRow
from sim.durations import duration, timestamp
from sim.trace.figures.chains import ChainError, chain


class PostingHost(LineHost, Protocol):
    """What asks for lines, and is told by other threads."""

    def post(self, do: Callable[[], object]) -> None:
        """Have something done on the console's thread; from any thread."""


def numbered(names: list[str]) -> str:
    """Return names with numbers to choose them by: ``1: odom_callback, 2: scan_callback``."""
    return ", ".join(f"{number}: {name}" for number, name in enumerate(names, start=1))


@dataclass
class AskedChain(ScreenPart):
    """Tells how long messages took from one topic or service to another, and where."""

    host: LineHost
    runs: RunController[ShownRun]
    navigation: TimeNavigation

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer it once something was sent."""
        return bool(self.runs.timeline.names_sent)

    def action_chain(self) -> None:
        """Ask for the names."""
        self.host.ask(self._ask())

    def _ask(self) -> Dialogue:
        timeline = self.runs.timeline
        known = ", ".join(timeline.names_sent)
        names = names_in((yield f"From which to which, such as first:last? There is {known}."))
        if not names:
            return
        try:
            found = chain(timeline, names)
        except ChainError as error:
            self.host.tell(f"{error}")
            return
        done = [each for each in found.whole if each.input.at <= self.navigation.now]
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
        choices = [choice for choice in CHOICES.values() if not choice[0].on_screen]
        texts = [f"{title}, {meaning}" for _, title, meaning in choices]
        line = yield f"Export the run so far as what? {numbered(texts)}. Type its number, or nothing:"
        if not line:
            return
        if not (line.isdecimal() and 0 < int(line) <= len(choices)):
            self.host.tell(f"There is no format {line}.")
            return
        try:
            export = LiveExport(self.runs.run.material(), choices[int(line) - 1][0].form, None)
        except FileNotFoundError:
            self.host.tell("The current folder is gone; start the console in another one.")
            return

        def write() -> None:
            said = export.write()
            self.host.post(lambda: self.host.tell(said))

        Thread(target=write, name="export", daemon=True).start()


@dataclass
class AskedGroup(ScreenPart):
    """Gives a callback another group, and runs again."""

    host: LineHost
    runs: RunController[LiveRun]
    restarts: Restarts
    subject: ShownProgram

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer it for what the run starts itself, and does not only watch."""
        return bool(self.runs.run.setup.programs)

    def action_group(self) -> None:
        """Ask for the callback and its group."""
        self.host.ask(self._ask())

    def _ask(self) -> Dialogue:
        run = self.runs.run
        callbacks = changeable(self.subject, run.setup, run.timeline).callbacks
        names = [f"{each.name}, now in group {each.group}" for each in callbacks]
        line = yield f"Which callback? {numbered(names)}. Type its number, or nothing:"
        if not (line.isdecimal() and 0 < int(line) <= len(callbacks)):
            self.host.tell(f"There is no callback {line}." if line else None)
            return
        row = GroupRow(callbacks[int(line) - 1])
        group = yield f"Which group: {', '.join(GROUP_CHOICES)}? Nothing for the program's own:"
        if group and group not in GROUP_CHOICES:
            self.host.tell(f"There is no group {group}.")
            return
        asyncio.run(self.restarts.again(row.take(self.restarts.changes, group)))
