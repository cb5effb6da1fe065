"""Keys that run a program again, as it was or changed, and put both runs side by side."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from textual.screen import Screen

from cbtui.runs.compared_runs import ComparedSide, compared_side
from cbtui.runs.live.live_run import LiveRun, RunState
from cbtui.runs.setup.changeable import (
    ChangeableCallback,
    ChangeableSetup,
    callbacks_of,
    changeable,
    place_of,
)
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.equivalent_code import code_of
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.compare import CompareScreen
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.screens.parts.selection import LaneSelection
from cbtui.screens.setup import SetupScreen
from cbtui.screens.setup_rows import GroupRow, NumberRow, SettingRow, ThreadsRow

_TOLD = 2
"""Statements of code that are told of as a run begins again; more would cover what there is to see."""


@dataclass
class Restarts(ScreenPart):
    """Runs again with changes, and keeps the run before.

    ``changes`` is what the run on screen has other than its program says. ``began`` is called when another
    run is there and not started yet, ``speed`` tells how fast it is to go. ``at_any_time`` lets the run be
    run again before it is over.
    """

    host: ScreenHost
    runs: RunController[LiveRun]
    changes: Changes
    began: Callable[[], None]
    speed: Callable[[], float | None]
    at_any_time: bool = False
    before: ComparedSide | None = None
    """The run before the one on screen."""

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer to run again what is over or does not answer; ``start_over`` is there for all else."""
        run = self.runs.run
        match action:
            case "run_again":
                return self.at_any_time or not run.alive or run.state is RunState.SILENT
            case "compare":
                return self.before is not None
        return True

    async def again(self, changes: Changes) -> None:
        """Run again with these changes."""
        await self.start(changes, self.speed())

    async def start(self, changes: Changes, speed: float | None) -> None:
        """Run again with these changes, at a speed."""
        before = self.runs.run
        if before.timeline.end > 0:
            self.before = compared_side(before, self.changes).ended()
        self.changes = changes
        self.runs.begin(speed)
        self.began()
        self.host.tell(await asyncio.to_thread(before.stop))
        self.runs.run.start()

    async def action_run_again(self) -> None:
        """Run again with the same set-up."""
        await self.again(self.changes)

    async def action_start_over(self) -> None:
        """Run again although the run is not over: it may be one that cannot go on."""
        await self.again(self.changes)

    def action_compare(self) -> None:
        """Put this run and the one before above each other."""
        if self.before is not None:
            now = compared_side(self.runs.run, self.changes)
            self.host.ask(CompareScreen(self.before, now, self.host.charset), None)


@dataclass
class SetUpKeys(ScreenPart):
    """Changes how a program is set up, and runs it again so."""

    host: ScreenHost
    runs: RunController[LiveRun]
    restarts: Restarts
    selection: LaneSelection
    subject: ShownProgram

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer to change what the run starts itself, and does not only watch."""
        return bool(self.runs.run.setup.programs)

    def action_threads(self) -> None:
        """Ask for a number of threads."""
        self._ask(ThreadsRow(self._changeable))

    def action_group(self) -> None:
        """Ask for the group of the selected callback; for the callback too where none is selected."""
        callback = self._selected_callback
        if callback is None:
            self._open_set_up(lambda row: row.aspect == "group")
        else:
            self._ask(GroupRow(callback))

    def action_set_up(self) -> None:
        """Show all that can be changed, the selected timer's period first."""
        callback = self._selected_callback
        name = callback.name if callback is not None and callback.period else None
        self._open_set_up(lambda row: isinstance(row, NumberRow) and row.what in {name, name or row.what})

    @property
    def _changeable(self) -> ChangeableSetup:
        run = self.runs.run
        return changeable(self.subject, run.setup, run.timeline)

    @property
    def _selected_callback(self) -> ChangeableCallback | None:
        """The selected callback, if it is one of the program's own."""
        selected, timeline = self.selection.callback, self.runs.timeline
        # A run that begins anew has yet to make it.
        entity = None if selected is None else timeline.entities.get(selected)
        return None if entity is None else callbacks_of(timeline).get(place_of(entity, timeline))

    def _ask(self, row: SettingRow) -> None:
        """Ask for one thing, and run again with the answer at once."""

        async def take(answer: Any) -> None:
            if answer is not None:
                await self._run_with(row.take(self.restarts.changes, answer))

        question: Screen[Any] = row.ask(self.restarts.changes, self.host.charset)
        self.host.ask(question, take)

    def _open_set_up(self, first: Callable[[SettingRow], bool]) -> None:
        screen = SetupScreen(self._changeable, self.restarts.changes, first, self.host.charset)
        self.host.ask(screen, self._run_with)

    async def _run_with(self, changes: Changes | None) -> None:
        if changes is not None:
            code = code_of(changes.beyond(self.restarts.changes), self._changeable)
            await self.restarts.again(changes)
            if 0 < len(code) <= _TOLD:
                self.host.tell("\n".join(code))
            else:
                words = changes.words
                self.host.tell(f"changed: {words}" if words else "everything as it is written")
