"""An exercise on screen: the learner's file is run and judged by its checks, anew whenever it is saved."""

import asyncio
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

import msgspec
from textual import on
from textual.message import Message
from textual.widget import Widget

from cbtui.engines.session import Deliver, Ended
from cbtui.keys.actions import CHECKS, PANES, Scope
from cbtui.keys.keymap import STANDARD, Keymap, keymap_of
from cbtui.learning.lesson_page import page_of_exercise
from cbtui.looks.theme import Charset
from cbtui.runs.judged.checking import Checked, Observed, over
from cbtui.runs.judged.run_budget import Allowance
from cbtui.runs.live.file_watch import CANNOT_WATCH, content_of, contents
from cbtui.runs.live.live_run import LiveRun, OpenSession
from cbtui.runs.setup.subject import of_exercise
from cbtui.screens.lesson import LessonScreen
from cbtui.widgets.checks import ChecksView, Sheet, Standing
from cbtui.widgets.checks.exercise_sheet import ExerciseWords, Keys
from cbtui.widgets.diagnosis import Diagnosis, Weight
from cbtui.widgets.shell import Prompt
from cbtui.widgets.tabs import title_of
from lessons.judge import Judge
from lessons.lesson import Lesson

_LOOK = 0.2
"""Seconds after which it is looked whether a run has taken too much."""
_REFUSED = frozenset(
    {
        "call_service",
        "call_service_off",
        "prompt",
        "type",
        "reset_world",
        "threads",
        "group",
        "set_up",
        "exercise",
    }
)
"""Actions that would make the run another than the one that is judged."""


class ExerciseScreen(LessonScreen):
    """Shows the run of a learner's file that a lesson's checks are about, and what came of them.

    The run gets what the lesson says and nothing from the person: what is on the lanes is what was judged.
    """

    CSS_PATH: ClassVar[list[Path]] = [  # type: ignore[assignment]  # a list is as good as one path
        Path(__file__).parent / "lesson" / "lesson.tcss",
        Path(__file__).with_name("exercise.tcss"),
    ]
    PANES_HERE = (*PANES, CHECKS)
    FIRST_SPEED = None
    AUTO_FOCUS = f"#{CHECKS}"

    class Saved(Message):
        """The file holds ``content``, maybe another than before; None: it is gone."""

        def __init__(self, content: bytes | None) -> None:
            super().__init__()
            self.content = content

    def __init__(
        self,
        lesson: Lesson,
        lessons: Sequence[Lesson],
        file: Path,
        open_session: OpenSession,
        charset: Charset,
    ) -> None:
        """Make ready to run a file for a lesson's exercise.

        Raises:
            BadLesson: its checks cannot be read.
        """
        self._judge = Judge(lesson)
        self._judged_lesson = lesson
        self._file = file
        self._content: bytes | None = None
        self._gone = False
        self._judged_sheet: Sheet | None = None
        super().__init__(of_exercise(lesson, lessons, file), open_session, charset)
        self._pane = CHECKS

    @property
    def is_judged(self) -> bool:
        """Whether it is known what came of the run on screen."""
        return self._judged_sheet is not None

    # the panes

    def _panes(self) -> Iterator[Widget]:
        checks = ChecksView(self._sheet, id=CHECKS)
        checks.border_title = title_of(CHECKS)
        checks.add_class("pane")
        yield checks
        yield from super()._panes()

    def on_mount(self) -> None:
        """Watch the file and the run; there is nobody to type a line for."""
        prompt = self.query_one(Prompt)
        prompt.disabled = True
        prompt.display = False
        checks = self.query_one(ChecksView)
        self.watch(checks, "note", self._entitle)
        self.watch(checks, "picked", self._redraw)
        self.set_interval(_LOOK, self.look_at_allowance)
        self.run_worker(self._watch_file(), group="file")

    def _show(self, pane: str) -> None:
        self._widget(CHECKS).set_class(pane == "guide", "-behind", update=False)
        super()._show(pane)

    def _draw_pane(self, name: str) -> None:
        if name == CHECKS:
            self.query_one(ChecksView).show(self._sheet)
        else:
            super()._draw_pane(name)

    @property
    def _notes(self) -> dict[str, str]:
        return super()._notes | {CHECKS: self.query_one(ChecksView).note}

    @on(ChecksView.MomentPicked)
    def _look_there(self, message: ChecksView.MomentPicked) -> None:
        self._move(self._playhead.sought(message.at, self._run.timeline.end))

    @property
    def _page(self) -> Mapping[str, str]:
        lesson, task = self._judged_lesson, self._words_in(STANDARD, Charset.ASCII).page(self._file)
        return page_of_exercise(lesson, self._standing_in(lesson), self._signs, task)

    # what there is to say

    @property
    def _words(self) -> ExerciseWords:
        return self._words_in(keymap_of(self.app), self._charset)

    def _words_in(self, keymap: Keymap, charset: Charset) -> ExerciseWords:
        """Sentences that name the keys of a keymap; the guide shows the registry's as those in force."""
        actions = ("open_source", "watch", "lesson", "next_lesson")
        keys = Keys(*(keymap.sign(Scope.LESSON, action, charset) for action in actions))
        following = self._subject.following
        return ExerciseWords(self._judged_lesson, self._judge.checks, self._file.name, following, keys)

    @property
    def _sheet(self) -> Sheet:
        sheet = self._judged_sheet or self._words.running(self._run.timeline.end)
        return replace(sheet, news=self._words.gone, standing=Standing.FAILED) if self._gone else sheet

    def _verdict(self) -> Diagnosis:
        if self._playhead.at is not None or self._run.alive:
            return super()._verdict()
        sheet = self._sheet
        if sheet.standing is Standing.FAILED and not sheet.note:
            return Diagnosis(sheet.news, Weight.TROUBLE, stays=True)
        return Diagnosis(sheet.news, Weight.FINE)

    # runs

    def _begin(self, speed: float | None) -> None:
        self._content = content_of(self._file)
        self._allowance = Allowance()
        self._judged_sheet = None
        super()._begin(speed)

    def _new_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        title = f"{self._file.name}, run {self._runs}"
        setup = msgspec.structs.replace(self._subject.set_up(None, speed), title=title)
        return LiveRun(setup, self._open_session, deliver, ended)

    @on(LessonScreen.Delivered)
    def _count(self, message: LessonScreen.Delivered) -> None:
        if message.run == self._runs:
            self._allowance.write(message.events)

    @on(LessonScreen.Over)
    def _judge_when_over(self, message: LessonScreen.Over) -> None:
        if message.run == self._runs:
            self._come_to_an_end(over(self._run.timeline, self._file.name, message.loss))

    def allow(self, allowance: Allowance) -> None:
        """Let the run on screen take this much."""
        self._allowance = allowance

    def look_at_allowance(self) -> None:
        """End the run if it has taken too much."""
        run, allowance = self._run, self._allowance
        if not run.alive:
            return
        if run.paused or (run.virtual and run.speed is not None):
            allowance.rest()
        else:
            allowance.pass_time()
        sentence = allowance.spent(run.timeline, self._file.name)
        if sentence is not None:
            self._break_off(sentence)

    def _break_off(self, sentence: str) -> None:
        """End a run that has taken too much; what its engine still sends no longer counts."""
        self._runs += 1
        run = self._run
        self._finish(run.over(sentence))
        self.run_worker(asyncio.to_thread(run.stop), group="stop")
        self._come_to_an_end(Observed(run.timeline, sentence, broken_off=True))

    def _come_to_an_end(self, observed: Observed) -> None:
        self.run_worker(self._judge_run(self._runs, observed), group="judge", exclusive=True)

    async def _judge_run(self, number: int, observed: Observed) -> None:
        """Judge a run that is over, here where it is drawn from: others may not read it meanwhile."""
        judged = []
        if observed.trouble is None:
            for check in self._judge.checks:
                judged.append(self._judge.judge(check, observed.timeline))
                await asyncio.sleep(0)
        checked = Checked(tuple(judged), len(self._judge.checks), observed)
        if number != self._runs:
            return
        self._judged_sheet = self._words.judged(checked)
        self.look_for_findings()
        if checked.good:
            self._progress.passes(self._judged_lesson.id)
            await self._learnt()

    # the file

    async def _watch_file(self) -> None:
        try:
            async for content in contents(self._file):
                self.post_message(self.Saved(content))
        except CANNOT_WATCH:
            self._tell(f"{self._file.parent} cannot be watched, so saving is not noticed there.")

    @on(Saved)
    async def _take_saved(self, message: Saved) -> None:
        gone = message.content is None
        if gone != self._gone:
            self._gone = gone
            self._stale = True
        if not gone and message.content != self._content:
            await self.action_run_again()

    # the keys

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer what leaves the run as it is judged; running again is always possible."""
        if action in _REFUSED or (action == "hint" and self._sheet.standing is Standing.PASSED):
            return False
        if action in {"run_again", "watch", "lesson", "show_pane"}:
            return True
        return super().check_action(action, parameters)

    async def action_run_again(self) -> None:
        """Run the file again and judge it, as fast as that goes."""
        await self._start_over(self._changes, self.FIRST_SPEED)
