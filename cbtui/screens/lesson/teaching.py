"""What makes a run a lesson: it is predicted, watched and explained."""

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from typing import TYPE_CHECKING, cast

from textual import on
from textual.message import Message

from cbtui.keys.actions import Scope
from cbtui.keys.keymap import STANDARD, keymap_of
from cbtui.learning.lesson_page import Part, Signs, Standing, introduction, page_of, predicted
from cbtui.learning.outcome import Outcome, OutcomeRun
from cbtui.looks.theme import Charset
from cbtui.screens.lesson.changing import ChangingScreen
from cbtui.screens.prediction import PredictionScreen, Way
from cbtui.widgets.guide import Guide
from lessons.lesson import Lesson
from lessons.progress import Progress

if TYPE_CHECKING:
    from cbtui.app import CbtuiApp

_NAMED = ("predict", "explain", "hint", "solution", "exercise")
"""The actions whose keys the page names."""
_SECOND = 1_000_000_000
_PATIENCE = 1.0
"""Seconds that the console waits for an engine that is held against a prediction; it is killed before."""


class TeachingScreen(ChangingScreen):
    """Asks before the run, and unlocks the parts of the lesson's page.

    A screen on which nothing is taught (``lesson`` is None) is as it would be without this layer.
    """

    _standing: Standing | None = None
    _outcome_run: OutcomeRun | None = None
    _outcome_wanted = False

    class Held(Message):
        """The run that predictions are held against is over."""

        def __init__(self, outcome: Outcome) -> None:
            super().__init__()
            self.outcome = outcome

    async def on_unmount(self) -> None:
        """Leave no engine behind."""
        if self._outcome_run is not None:
            self._outcome_run.give_up()
            await asyncio.to_thread(self._outcome_run.wait, _PATIENCE)

    # the page

    @property
    def _page(self) -> Mapping[str, str]:
        lesson = self.lesson
        return super()._page if lesson is None else page_of(lesson, self._standing_in(lesson), self._signs)

    def _standing_in(self, lesson: Lesson) -> Standing:
        """How far the learner is, read when it is first asked for."""
        if self._standing is None:
            self._standing = Standing(self._progress.of(lesson.id))
        return self._standing

    @property
    def _at_exercise(self) -> bool:
        """Whether it is not the lesson's node that runs, but what the learner makes of it."""
        return self.lesson is not None and self._subject.node_path != self.lesson.node_path

    @property
    def _signs(self) -> Signs:
        """The registry's keys: the guide shows those in force, as for the lesson's own texts."""
        return Signs(*(STANDARD.sign(Scope.LESSON, action, Charset.ASCII) for action in _NAMED))

    @property
    def _progress(self) -> Progress:
        return cast("CbtuiApp", self.app).progress

    async def _learnt(self, outcome: Outcome | None = None) -> None:
        """Take in what was learnt, and show what can be read now."""
        if self.lesson is None:
            return
        self._take_stock(outcome)
        for sentence in self._progress.troubles():
            self.notify(sentence, severity="warning", markup=False)
        await self.query_one(Guide).show(self._page)

    def _take_stock(self, outcome: Outcome | None = None) -> None:
        """Note how far the learner is; what the run showed stays known until another one is held."""
        lesson = self.lesson
        assert lesson is not None, "only in a lesson something is learnt"
        held = self._outcome_run is not None
        known = None if self._standing is None or held else self._standing.outcome
        self._standing = Standing(self._progress.of(lesson.id), outcome or known, held)
        self._stale = True

    def _read(self, part: Part) -> None:
        """Show a part of the page."""
        self._show("guide")
        self.query_one(Guide).go_to(part)

    @property
    def _not_to_be_learnt(self) -> dict[str, bool]:
        """Which keys have no meaning as far as the learner has come."""
        lesson, standing = self.lesson, self._standing
        if lesson is None or standing is None:
            return {"predict": True, "explain": True}
        return {"predict": not self._can_predict, "explain": self._at_exercise}

    # predict

    @property
    def _can_predict(self) -> bool:
        """Whether there is a question left, and nothing was shown yet that answers it."""
        lesson = self.lesson
        if lesson is None or self._at_exercise:
            return False
        progress = self._progress.of(lesson.id)
        return not progress.seen and not predicted(lesson, progress)

    @property
    def _asks_first(self) -> bool:
        """Whether the run begins with questions: those are about the node as it is written."""
        return self._can_predict and not self._changes.words

    def _start(self) -> None:
        """Let time begin when the questions are done with."""
        if self._asks_first:
            self._ask_for_predictions(self._begin_after)
        else:
            super()._start()

    async def _begin_after(self, way: Way | None) -> None:
        if way is Way.ON:
            await self._learnt()
            self.query_one(Guide).go_to(Part.TASK)
            super()._start()
        else:
            self.action_leave()

    def _ask_for_predictions(self, go_on: Callable[[Way | None], Awaitable[None]]) -> None:
        lesson = self.lesson
        assert lesson is not None, "only a lesson has questions"
        answered = len(self._progress.of(lesson.id).answers)
        screen = PredictionScreen(
            introduction(lesson.guide), lesson.predictions, answered, self._lock, self._charset
        )
        self.app.push_screen(screen, go_on)

    def _lock(self, place: int, answer: int) -> None:
        lesson = self.lesson
        assert lesson is not None, "only a lesson has questions"
        self._progress.answer(lesson.id, place, answer)

    def action_predict(self) -> None:
        """Answer the questions that are left."""

        async def go_on(_: Way | None) -> None:
            await self._learnt()

        if self._can_predict:
            self._ask_for_predictions(go_on)

    # see and explain

    def _look_whether_watched(self) -> None:
        """Unlock what comes after the run when enough of it was seen."""
        lesson, standing = self.lesson, self._standing
        if lesson is None or standing is None or self._at_exercise or standing.progress.seen:
            return
        if not self._was_watched(lesson):
            return
        self._progress.see(lesson.id)
        self._hold()
        self._take_stock()
        self.run_worker(self._learnt(), group="page")
        key = keymap_of(self.app).sign(Scope.LESSON, "explain", self._charset)
        self._tell(f"The guide now tells what the run showed, and why: {key} goes there.")

    def _was_watched(self, lesson: Lesson) -> bool:
        """Whether the run has come to where its predictions can be told from."""
        timeline, terms = self._run.timeline, lesson.run
        if timeline.ended is not None:
            return not timeline.ended.failed
        if timeline.end < terms.seconds * _SECOND:
            return False
        return not terms.calls or any(call.service == lesson.service.name for call in timeline.calls)

    async def action_explain(self) -> None:
        """Tell what is true and why; who was not asked yet may say first what they expect."""
        if self._can_predict:
            self._ask_for_predictions(self._explain_after)
        else:
            await self._explain()

    async def _explain_after(self, way: Way | None) -> None:
        if way is Way.ON:
            await self._explain()
        else:
            await self._learnt()

    async def _explain(self) -> None:
        lesson, standing = self.lesson, self._standing
        if lesson is None or standing is None:
            return
        self._progress.see(lesson.id)
        self._outcome_wanted = True
        self._hold()
        await self._learnt()
        self._read(Part.SHOWN if lesson.predictions else Part.EXPLANATION)

    def _hold(self) -> None:
        """Run the lesson once more beside the run on screen, if it is not known yet what is true."""
        lesson, standing = self.lesson, self._standing
        if lesson is None or not lesson.predictions or self._outcome_run is not None:
            return
        if standing is not None and standing.outcome is not None and standing.outcome.trouble is None:
            return
        run = self._outcome_run = OutcomeRun(lesson, cast("CbtuiApp", self.app).observe)
        self.run_worker(lambda: self.post_message(self.Held(run.run())), thread=True, group="outcome")

    @on(Held)
    async def _take_outcome(self, message: Held) -> None:
        self._outcome_run = None
        await self._learnt(message.outcome)
        if self._outcome_wanted:
            self.query_one(Guide).go_to(Part.SHOWN)
