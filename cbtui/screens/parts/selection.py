"""Keys and clicks that navigate between lanes, code and findings."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from textual.screen import Screen

from cbtui.runs.live.findings import ExplainedFinding
from cbtui.runs.live.live_run import ShownRun
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.parts.bars import BarSelection
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.panes import PaneLayout
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.screens.windows.diagnoses import ChosenStep, DiagnosesScreen, NextStep
from cbtui.widgets.code import CodeView
from cbtui.widgets.lanes import Lanes, Selection
from cbtui.widgets.lanes.details import position_in
from cbtui.widgets.lanes.rows import all_lanes
from cbtui.widgets.lanes.selection import neighbouring_bar
from lessons.catalogue import lesson_on
from lessons.lesson import Lesson
from sim.quantities.durations import timestamp
from sim.trace.descriptions import nothing_came, silent_topics
from sim.trace.events import EntityId
from sim.trace.model import Nanoseconds, Span

if TYPE_CHECKING:
    from cbtui.screens.parts.cures import CureTrials


@dataclass
class LaneSelection(ScreenPart):
    """Moves the selection along the lanes of one run, and between lanes and code.

    ``cures`` tries the cures of findings, if the run can be made again.
    """

    screen: Screen[None]
    host: ScreenHost
    runs: RunController[ShownRun]
    navigation: TimeNavigation
    bars: BarSelection
    panes: PaneLayout
    subject: ShownProgram
    cures: "CureTrials | None" = None

    @property
    def _lanes(self) -> Lanes:
        return self.screen.query_one(Lanes)

    @property
    def callback(self) -> EntityId | None:
        """The selected callback."""
        selection = self._lanes.selection
        return None if selection is None else selection.entity

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer the actions for the selection."""
        lanes = self._lanes
        match action:
            case "select":
                return not lanes.has_focus or lanes.selection is None
            case "to_code":
                return lanes.has_focus and self.callback is not None
            case "lane_above" | "lane_below":
                return lanes.has_focus
            case "deselect":
                return lanes.has_focus or lanes.selection is not None
        return True

    def action_select(self) -> None:
        """Focus the lanes, and select the most relevant bar if nothing is selected."""
        lanes = self._lanes
        lanes.focus()
        self.bars.select(lanes.selection or lanes.here())
        if not (timeline := self.runs.timeline).entities:
            sentence = "There is no bar to select yet: the lanes come with the first callbacks."
            self.host.tell(sentence, lambda: not timeline.entities)

    def action_lane_above(self) -> None:
        """Select the lane above."""
        self.bars.select(self._lanes.lane_beside(-1))

    def action_lane_below(self) -> None:
        """Select the lane below."""
        self.bars.select(self._lanes.lane_beside(1))

    def action_deselect(self) -> None:
        """Leave the lanes."""
        self.bars.select(None)
        self.panes.show(self.panes.current)

    def action_to_code(self) -> None:
        """Show the line at which the selected call is, or was longest; else its callback."""
        callback, timeline, selection = self.callback, self.runs.timeline, self._lanes.selection
        entity = None if callback is None else timeline.entities.get(callback)
        if entity is None:
            return
        self.panes.show("code")
        bar = None if selection is None else selection.bar
        position = position_in(timeline, bar, self.navigation.now) if isinstance(bar, Span) else None
        code = self.screen.query_one(CodeView)
        if position is None:
            code.show_callback(entity)
        else:
            code.show_line(position.file, position.line)

    def action_diagnoses(self) -> None:
        """List the findings."""
        monitor = self.runs.findings
        monitor.update()
        self.host.redraw()
        trial = None if self.cures is None else self.cures.begin()

        def latest() -> Sequence[ExplainedFinding] | None:
            return monitor.findings if self.runs.findings is monitor else None

        def beside() -> str:
            return nothing_came(silent_topics(self.runs.timeline))

        screen = DiagnosesScreen(
            monitor.findings,
            self.host.charset,
            trial,
            self._lesson_on,
            latest,
            lambda: monitor.looked_to,
            beside,
        )
        self.host.ask(screen, self._take)

    def _lesson_on(self, found: ExplainedFinding) -> Lesson | None:
        """The lesson that shows a problem, unless it is on screen."""
        lesson = lesson_on(found.kind) if found.is_problem else None
        return None if lesson == self.subject.lesson else lesson

    async def _take(self, chosen: ChosenStep | None) -> None:
        if chosen is None:
            return
        lesson = self._lesson_on(chosen.finding)
        if chosen.cure is not None and self.cures is not None:
            await self.cures.run(chosen.cure)
        elif chosen.step is NextStep.LESSON and lesson is not None:
            self._show_lesson(lesson)
        else:
            self._go_to_finding(chosen.finding)

    def _show_lesson(self, lesson: Lesson) -> None:
        """Open a lesson; the run of a learner's own file waits below, paused if it can be."""
        run, comes_back = self.runs.run, self.subject.is_learners
        if comes_back and run.can_be_paced and not run.paused:
            run.pause()
        self.host.console.open_lesson(lesson, over=comes_back)

    def _go_to_finding(self, found: ExplainedFinding) -> None:
        """Go to a finding's moment and code, and select its callback's lane."""
        if found.at is not None:
            begun = self.runs.timeline.begun
            self.navigation.seek(found.at)
            if found.at < begun:
                self.host.tell(
                    f"{timestamp(found.at)} is before this recording begins, at {timestamp(begun)}"
                )
        self.bars.select(self._last_of(found.finding.subject))
        place = found.explanation.place
        if place is not None:
            self.panes.show("code")
            self.screen.query_one(CodeView).show_line(place.file, place.first_line)

    def pick_moment(self, moment: Nanoseconds | None) -> None:
        """Go to a moment that was picked; without one, to the line that ended the program, or say why not."""
        ended = self.runs.timeline.ended
        if moment is not None:
            self.navigation.seek(moment)
        elif ended is not None and ended.problem and ended.place[1]:
            self.panes.show("code")
            self.screen.query_one(CodeView).show_line(*ended.place)
        else:
            self.host.tell("There is no moment to show for this check.")

    def pick_callback(self, message: CodeView.CallbackPicked) -> None:
        """Select the callback whose code was picked."""
        self.bars.select(self._last_of(message.entity))
        if message.leaves:
            self._lanes.focus()

    def _last_of(self, entity: EntityId) -> Selection | None:
        """The lane of a callback, and its call at the moment on screen, or its last bar up to then."""
        timeline = self.runs.timeline
        lanes = all_lanes(timeline, self.subject.service)
        lane = next((lane for lane in lanes if Selection(lane).entity == entity), None)
        if lane is None:
            return None
        now = self.navigation.now
        running = (span for span in timeline.moment(now).running.values() if span.entity == entity)
        after = min(now + 1, timeline.end)
        return Selection(lane, next(running, None) or neighbouring_bar(timeline, lane, after, -1))
