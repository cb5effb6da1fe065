"""The predictions of a lesson: asked before its run, then compared with a separate run and explained."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from textual.message import Message
from textual.screen import Screen

from cbtui.learning.lesson_page import PageSection, introduction
from cbtui.learning.outcome import OutcomeRun, PredictionOutcome
from cbtui.learning.stage import all_predicted
from cbtui.runs.live.live_run import LiveRun
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.screens.teaching.learning import Learning
from cbtui.screens.windows.prediction import PredictionExit, PredictionScreen

_SECOND = 1_000_000_000
_TIMEOUT = 1.0
"""Seconds to wait at exit for the separate run's engine, which is killed sooner."""


@dataclass
class Predictions(ScreenPart):
    """Asks for predictions, and unlocks the true answers once enough of the run was watched."""

    @dataclass
    class Found(Message):
        """The run that predictions are compared with has ended."""

        outcome: PredictionOutcome

    screen: Screen[None]
    host: ScreenHost
    runs: RunController[LiveRun]
    learning: Learning
    _run: OutcomeRun | None = None
    _wanted: bool = False

    async def leave(self) -> None:
        """Wait for the separate run's engine to end."""
        if self._run is not None:
            self._run.give_up()
            await asyncio.to_thread(self._run.wait, _TIMEOUT)

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer open predictions, and the explanation once the page is shown."""
        return self.learning.state is not None and (action == "explain" or self.can_predict)

    @property
    def can_predict(self) -> bool:
        """Whether a question is open and its answer still locked."""
        progress = self.learning.progress
        return not progress.seen and not all_predicted(self.learning.lesson, progress)

    def ask(self, go_on: Callable[[PredictionExit | None], Awaitable[None]]) -> None:
        """Ask the open questions."""
        lesson, learning = self.learning.lesson, self.learning
        screen = PredictionScreen(
            introduction(lesson.guide),
            lesson.predictions,
            len(learning.progress.answers),
            lambda place, answer: learning.store.answer(lesson.id, place, answer),
            self.host.charset,
        )
        self.host.ask(screen, go_on)

    def action_predict(self) -> None:
        """Ask the open questions."""

        async def go_on(_: PredictionExit | None) -> None:
            await self.learning.update_page()

        if self.can_predict:
            self.ask(go_on)

    def check_whether_watched(self) -> None:
        """Unlock the explanation once enough was watched, and no window is open that it would cover."""
        learning = self.learning
        if learning.state is None:
            return
        if learning.was_called != self._was_called():
            learning.was_called = not learning.was_called
            self.screen.run_worker(learning.update_page(), group="page")
        if learning.state.progress.seen or not self.screen.is_active or not self._was_watched():
            return
        learning.store.see(self.learning.lesson.id)
        self._find_out()
        learning.update_state()
        self.screen.run_worker(learning.update_page(), group="page")
        if not learning.progress.explained:
            key = self.host.key("explain")
            self.host.tell(f"You have seen enough: {key} explains what happened, and why.")

    def _was_watched(self) -> bool:
        """Whether enough of the run was watched to judge the predictions."""
        timeline, lesson = self.runs.timeline, self.learning.lesson
        if timeline.ended is not None:
            return not timeline.ended.failed or "program-raised" in lesson.diagnoses.node
        return timeline.end >= lesson.run.seconds * _SECOND and self._was_called()

    def _was_called(self) -> bool:
        """Whether the lesson's service was called, if its run is about that."""
        lesson, calls = self.learning.lesson, self.runs.timeline.calls
        return not lesson.run.calls or any(call.service == lesson.service.name for call in calls)

    async def action_explain(self) -> None:
        """Show the true answers and their reasons; open questions are asked first."""
        if self.can_predict:
            self.ask(self._explain_after)
        else:
            await self._explain()

    async def _explain_after(self, way: PredictionExit | None) -> None:
        if way is PredictionExit.ON:
            await self._explain()
        else:
            await self.learning.update_page()

    async def _explain(self) -> None:
        learning = self.learning
        if learning.state is None:
            return
        learning.store.explain(self.learning.lesson.id)
        self.screen.app.clear_notifications()  # one may still say that the key is to be pressed
        self._wanted = True
        self._find_out()
        await learning.update_page()
        learning.read(PageSection.SHOWN if self.learning.lesson.predictions else PageSection.EXPLANATION)

    def _find_out(self) -> None:
        """Start the separate run of the lesson, unless its outcome is known."""
        state = self.learning.state
        if not self.learning.lesson.predictions or self._run is not None:
            return
        if state is not None and state.outcome is not None and state.outcome.trouble is None:
            return
        real = self.runs.run.setup.real
        run = self._run = OutcomeRun(self.learning.lesson, self.host.console.observe, real)
        self.learning.outcome_pending = True
        self.screen.run_worker(
            lambda: self.screen.post_message(self.Found(run.run())), thread=True, group="outcome"
        )

    async def take(self, message: Found) -> None:
        """Show the outcome."""
        self._run = None
        self.learning.outcome_pending = False
        reads_on = self.learning.guide.is_past(PageSection.SHOWN)
        await self.learning.update_page(message.outcome)
        if self._wanted and not reads_on:
            self.learning.guide.go_to(PageSection.SHOWN)
