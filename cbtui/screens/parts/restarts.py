"""Keys that restart a program, perhaps with changes."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import msgspec
from textual.screen import Screen

from cbtui.runs.compared_runs import ComparedSide, compared_side
from cbtui.runs.live.live_run import LiveRun, RunState, has_robot
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
from cbtui.screens.parts.part import RunHost, ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.screens.parts.selection import LaneSelection
from cbtui.screens.windows.setup import SetupScreen
from cbtui.screens.windows.setup_rows import GroupRow, SettingRow, ThreadsRow, ValueRow
from sim.engine.setup import Keyboard, RunSetup, TimedInput
from sim.trace.events import CommandKind

_AS_WRITTEN = "everything is back to what the program says"
_TOLD = 2
"""The most statements of equivalent code in the notification of a restart."""


@dataclass
class Restarts(ScreenPart):
    """Restarts the run with changes, and keeps the previous run.

    ``changes`` are those of the run on screen. ``began`` is called when the new run exists and is not started
    yet; ``speed`` returns its speed. ``at_any_time`` offers a restart before the run has ended.
    """

    host: RunHost
    runs: RunController[LiveRun]
    changes: Changes
    began: Callable[[], None]
    speed: Callable[[], float | None]
    at_any_time: bool = False
    before: ComparedSide | None = None
    """The previous run."""
    inputs: tuple[TimedInput, ...] = ()
    """The inputs of the run on screen."""
    _edit: str = ""
    """Which edit of a file came before the run on screen, such as ``line 3 changed``; "" for none."""

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer ``run_again`` at any time if the run has no robot to reset; ``start_over`` always works."""
        run = self.runs.run
        is_over = not run.alive or run.state is RunState.SILENT
        repeats = is_over or self.at_any_time or (bool(run.setup.programs) and not has_robot(run))
        return repeats or action != "run_again"

    def set_up(self, subject: ShownProgram, speed: float | None) -> RunSetup:
        """The set-up of the next run: the program's, with the changes, a live keyboard and the inputs."""
        setup = self.changes.applied(subject.set_up(self.changes.threads, speed))
        return msgspec.structs.replace(setup, keyboard=Keyboard.LIVE, inputs=self.inputs)

    async def again(self, changes: Changes, inputs: tuple[TimedInput, ...] = (), edit: str = "") -> None:
        """Run again with these changes, the inputs of an earlier run, and an ``edit`` of a file."""
        await self.start(changes, self.speed(), inputs, edit)

    async def start(
        self, changes: Changes, speed: float | None, inputs: tuple[TimedInput, ...] = (), edit: str = ""
    ) -> None:
        """Run again with these changes, at a speed; of several at once only the last one does."""
        before = self.runs.run
        if before.timeline.end > 0:
            self.before = compared_side(before, self.changes, edit and f"before {edit}").ended()
            self._edit = ""
        self._edit = edit or self._edit
        self.changes, self.inputs = changes, inputs
        self.runs.begin(speed)
        self.began()
        begun = self.runs.run
        self.host.tell(await asyncio.to_thread(before.stop))
        if begun is self.runs.run:
            begun.start()

    async def action_run_again(self) -> None:
        """Run again with the same set-up."""
        await self.again(self.changes)

    async def action_start_over(self) -> None:
        """Restart a run that has not ended."""
        await self.again(self.changes)

    @property
    def both(self) -> tuple[ComparedSide, ComparedSide] | None:
        """The previous run and this one; None if this is the first."""
        after = self._edit and f"after {self._edit}"
        return (
            None if self.before is None else (self.before, compared_side(self.runs.run, self.changes, after))
        )


@dataclass
class SetUpKeys(ScreenPart):
    """Changes a program's set-up, and restarts it."""

    host: ScreenHost
    runs: RunController[LiveRun]
    restarts: Restarts
    selection: LaneSelection
    subject: ShownProgram

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer changes of a run that starts its programs itself; others are only watched."""
        return bool(self.runs.run.setup.programs)

    def action_threads(self) -> None:
        """Ask for a number of threads."""
        self._ask(ThreadsRow(self._changeable))

    def action_group(self) -> None:
        """Ask for the group of the selected callback, or open the set-up window if none is selected."""
        callback = self._selected_callback
        if callback is None:
            heading = "Set-up: no callback is selected, choose one"
            self._open_set_up(lambda row: row.aspect == "group", heading)
        else:
            self._ask(GroupRow(callback))

    def action_set_up(self) -> None:
        """Open the set-up window at the selected timer's period."""
        callback = self._selected_callback
        name = callback.title if callback is not None and callback.period else None
        self._open_set_up(lambda row: isinstance(row, ValueRow) and row.what in {name, name or row.what})

    @property
    def _changeable(self) -> ChangeableSetup:
        run = self.runs.run
        return changeable(self.subject, run.setup, run.timeline)

    @property
    def _selected_callback(self) -> ChangeableCallback | None:
        """The selected callback, if it is one of the program's own."""
        selected, timeline = self.selection.callback, self.runs.timeline
        # A restarted run may not have created it yet.
        entity = None if selected is None else timeline.entities.get(selected)
        return None if entity is None else callbacks_of(timeline).get(place_of(entity, timeline))

    def _ask(self, row: SettingRow) -> None:
        """Ask for one setting, and restart with the answer."""

        async def take(answer: Any) -> None:
            if answer is not None:
                await self._run_with(row.take(self.restarts.changes, answer))

        question: Screen[Any] = row.ask(self.restarts.changes, self.host.charset)
        self.host.ask(question, take)

    def _open_set_up(self, first: Callable[[SettingRow], bool], heading: str = SetupScreen.heading) -> None:
        screen = SetupScreen(self._changeable, self.restarts.changes, first, self.host.charset)
        if not callbacks_of(self.runs.timeline):
            heading = f"{SetupScreen.heading}: there is no callback{' yet' if self.runs.run.alive else ''}"
        screen.heading = heading
        self.host.ask(screen, self._run_with)

    async def _run_with(self, changes: Changes | None) -> None:
        if changes is None:
            return
        code = code_of(changes.without(self.restarts.changes), self._changeable)
        given = self.runs.timeline.given
        await self.restarts.again(changes)
        words = changes.words
        told = "\n".join(code) if 0 < len(code) <= _TOLD else f"changed: {words}" if words else _AS_WRITTEN
        if any(each.kind is CommandKind.CALL for each in given) and not self.runs.run.setup.calls:
            told += f"\nThe calls of the run before are not repeated: {self.host.key('call_service')} calls."
        self.host.tell(told)
