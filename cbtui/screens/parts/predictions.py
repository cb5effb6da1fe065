"""The predictions of a lesson: asked before its run, held against a run beside it, and explained."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from textual.message import Message
from textual.screen import Screen

from cbtui.learning.lesson_page import PageSection, all_predicted, introduction
from cbtui.learning.outcome import OutcomeRun, PredictionOutcome
from cbtui.runs.live.live_run import LiveRun
from cbtui.screens.parts.learning import Learning
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.screens.prediction import PredictionExit, PredictionScreen

_SECOND = 1_000_000_000
_TIMEOUT = 1.0
"""Seconds that the console waits for an engine that is held against a prediction; it is killed before."""


@dataclass
class Predictions(ScreenPart):
    """Asks what the learner expects, and tells what is true when enough of the run was seen."""

    class Found(Message):
        """The run that predictions are held against is over."""

        def __init__(self, outcome: PredictionOutcome) -> None:
            super().__init__()
            self.outcome = outcome

    screen: Screen[None]
    host: ScreenHost
    runs: RunController[LiveRun]
    learning: Learning
    _run: OutcomeRun | None = None
    _wanted: bool = False

    async def leave(self) -> None:
        """Leave no engine behind."""
        if self._run is not None:
            self._run.give_up()
            await asyncio.to_thread(self._run.wait, _TIMEOUT)

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer what is left to predict; the explanation always, once there is a page for it."""
        return self.learning.standing is not None and (action == "explain" or self.can_predict)

    @property
    def can_predict(self) -> bool:
        """Whether there is a question left, and nothing was shown yet that answers it."""
        progress = self.learning.progress
        return not progress.seen and not all_predicted(self.learning.lesson, progress)

    def ask(self, go_on: Callable[[PredictionExit | None], Awaitable[None]]) -> None:
        """Ask the questions that are left."""
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
        """Answer the questions that are left."""

        async def go_on(_: PredictionExit | None) -> None:
            await self.learning.learnt()

        if self.can_predict:
            self.ask(go_on)

    def look_whether_watched(self) -> None:
        """Unlock what comes after the run when enough of it was seen."""
        learning = self.learning
        if learning.standing is None or learning.standing.progress.seen or not self._was_watched():
            return
        learning.store.see(self.learning.lesson.id)
        self._find_out()
        learning.take_stock()
        self.screen.run_worker(learning.learnt(), group="page")
        key = self.host.key("explain")
        self.host.tell(f"The guide now tells what the run showed, and why: {key} goes there.")

    def _was_watched(self) -> bool:
        """Whether the run has come to where its predictions can be told from."""
        timeline, terms = self.runs.timeline, self.learning.lesson.run
        if timeline.ended is not None:
            return not timeline.ended.failed
        if timeline.end < terms.seconds * _SECOND:
            return False
        return not terms.calls or any(
            call.service == self.learning.lesson.service.name for call in timeline.calls
        )

    async def action_explain(self) -> None:
        """Tell what is true and why; who was not asked yet may say first what they expect."""
        if self.can_predict:
            self.ask(self._explain_after)
        else:
            await self._explain()

    async def _explain_after(self, way: PredictionExit | None) -> None:
        if way is PredictionExit.ON:
            await self._explain()
        else:
            await self.learning.learnt()

    async def _explain(self) -> None:
        learning = self.learning
        if learning.standing is None:
            return
        learning.store.see(self.learning.lesson.id)
        self._wanted = True
        self._find_out()
        await learning.learnt()
        learning.read(PageSection.SHOWN if self.learning.lesson.predictions else PageSection.EXPLANATION)

    def _find_out(self) -> None:
        """Run the lesson once more beside the run on screen, if it is not known yet what is true."""
        standing = self.learning.standing
        if not self.learning.lesson.predictions or self._run is not None:
            return
        if standing is not None and standing.outcome is not None and standing.outcome.trouble is None:
            return
        run = self._run = OutcomeRun(self.learning.lesson, self.host.console.observe)
        self.learning.finds_out = True
        self.screen.run_worker(
            lambda: self.screen.post_message(self.Found(run.run())), thread=True, group="outcome"
        )

    async def take(self, message: Found) -> None:
        """Show what is true."""
        self._run = None
        self.learning.finds_out = False
        await self.learning.learnt(message.outcome)
        if self._wanted:
            self.learning.guide.go_to(PageSection.SHOWN)
