"""Keys that change how a program is set up, run it again, and put both runs side by side."""

import asyncio
from collections.abc import Callable
from typing import Any

from cbtui.runs.compared_runs import side_of
from cbtui.runs.setup.changeable import Callback, Changeable, callbacks_of, changeable, place_of
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.equivalent_code import code_of
from cbtui.screens.lesson.taking import TakingScreen
from cbtui.screens.setup import SetupScreen
from cbtui.screens.setup_rows import GroupRow, NumberRow, Row, ThreadsRow
from cbtui.widgets.code import CodeView
from cbtui.widgets.lanes import Lanes

_TOLD = 2
"""Statements of code that are told of as a run begins again; more would cover what there is to see."""


class ChangingScreen(TakingScreen):
    """Runs again with changes, and keeps the run before."""

    async def _run_again(self, changes: Changes) -> None:
        await self._start_over(changes, self._run.speed)

    async def _start_over(self, changes: Changes, speed: float | None) -> None:
        before = self._run
        if before.timeline.end > 0:
            self._before = side_of(before, self._changes).at_rest()
        self._changes = changes
        self._begin(speed)
        self.query_one(Lanes).changes = changes.words
        self._entitle()
        self._select(None)
        self.query_one(CodeView).read_anew()
        self._tell(await asyncio.to_thread(before.stop))
        self._run.start()

    async def action_run_again(self) -> None:
        """Run again with the same set-up and speed."""
        await self._run_again(self._changes)

    async def action_start_over(self) -> None:
        """Run again although the run is not over: it may be one that cannot go on."""
        await self.action_run_again()

    async def action_watch(self) -> None:
        """Run again with the same set-up at the pace of real time."""
        await self._start_over(self._changes, speed=1.0)

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
    def _changeable(self) -> Changeable:
        return changeable(self._subject, self._run.setup, self._run.timeline)

    @property
    def _selected_callback(self) -> Callback | None:
        """The selected callback, if it is one of the program's own."""
        selection, timeline = self.query_one(Lanes).selection, self._run.timeline
        if selection is None or selection.entity is None:
            return None
        entity = timeline.entities.get(selection.entity)  # a run that begins anew has yet to make it
        return None if entity is None else callbacks_of(timeline).get(place_of(entity, timeline))

    def _ask(self, row: Row) -> None:
        """Ask for one thing, and run again with the answer at once."""

        async def take(answer: Any) -> None:
            if answer is not None:
                await self._run_with(row.take(self._changes, answer))

        self.app.push_screen(row.ask(self._changes, self._charset), take)

    def _open_set_up(self, first: Callable[[Row], bool]) -> None:
        screen = SetupScreen(self._changeable, self._changes, first, self._charset)
        self.app.push_screen(screen, self._run_with)

    async def _run_with(self, changes: Changes | None) -> None:
        if changes is not None:
            code = code_of(changes.beyond(self._changes), self._changeable)
            await self._run_again(changes)
            if 0 < len(code) <= _TOLD:
                self._tell("\n".join(code))
            else:
                self._tell(f"changed: {changes.words}" if changes.words else "everything as it is written")

    def action_compare(self) -> None:
        """Put this run and the one before above each other."""
        from cbtui.screens.compare import CompareScreen  # it draws at the pace of this one

        if self._before is not None:
            now = side_of(self._run, self._changes)
            self.app.push_screen(CompareScreen(self._before, now, self._charset))
