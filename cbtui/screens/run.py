"""The base of screens with a run: lanes, panes, the moment in words, and common keys."""

import asyncio
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import ClassVar, Generic

from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.events import DescendantFocus
from textual.message import Message
from textual.widget import Widget

from cbtui.keys.action import PANES, Scope
from cbtui.keys.bindings import bindings_of
from cbtui.keys.keymap import keymap_of
from cbtui.learning.stage import LessonStep
from cbtui.looks.theme import Charset
from cbtui.runs.live.live_run import LiveRun, has_robot
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.console import ConsoleApp, console_of
from cbtui.screens.layout import Layout
from cbtui.screens.parts import exporting
from cbtui.screens.parts.bars import BarSelection
from cbtui.screens.parts.chains import ChainPath
from cbtui.screens.parts.copying import DetailsCopy
from cbtui.screens.parts.exporting import Exports
from cbtui.screens.parts.finishing import FileFinisher
from cbtui.screens.parts.frames import FrameContent, FrameLoop
from cbtui.screens.parts.jumps import Jumps
from cbtui.screens.parts.keys import OfferedKeys
from cbtui.screens.parts.narration import Narration
from cbtui.screens.parts.navigation import MomentKey, TimeNavigation
from cbtui.screens.parts.panes import PaneLayout
from cbtui.screens.parts.part import ScreenPart, ScreenParts
from cbtui.screens.parts.runs import RunController, RunT_co
from cbtui.screens.parts.selection import LaneSelection
from cbtui.screens.parts.sizes import SizeKeys
from cbtui.screens.parts.ways_out import NextLesson, WaysBack
from cbtui.screens.sized import SizedScreen
from cbtui.screens.windows.finding_texts import problems_note
from cbtui.screens.windows.jump import JumpScreen
from cbtui.terminal.compositing import PatchCompositor
from cbtui.terminal.garbage_collector import collect_now
from cbtui.widgets.checks import ChecksView
from cbtui.widgets.code import CodeView
from cbtui.widgets.diagnosis import (
    Diagnosis,
    DiagnosisLevel,
    call_note,
    diagnosis_on_screen,
    how_to_continue,
    with_worst_problem,
)
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.factory import FactoryView
from cbtui.widgets.guide import Guide
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogLines, LogView
from cbtui.widgets.robot import RobotView
from cbtui.widgets.shell import ProgramKeyboard, Prompt, ShellView
from cbtui.widgets.status_line import StatusLine, status_of
from cbtui.widgets.tabs import Tabs, title_of

_TEXTS = (CodeView, LogView)
"""Panes that show lines of text."""

_DISK = 1.0
"""Seconds between two checks whether the source file has changed."""


class RunScreen(SizedScreen[None], Generic[RunT_co]):
    """Shows a run as a function of its timeline and a moment.

    A timer draws what is new: the lanes at most ``FRAMES_A_SECOND`` times a second, the other panes less
    often; the effect of a key is drawn everywhere in the next frame. ``live`` returns the run if it has an
    engine. A subclass adds its own parts with ``add_parts`` and begins the first run.
    """

    SCOPE = Scope.LESSON
    CSS_PATH = Path(__file__).with_name("run.tcss")
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.LESSON)]
    PANES_HERE: ClassVar[tuple[str, ...]] = PANES
    """The panes that there are, in the order of their keys."""
    FIRST_PANE: ClassVar[str] = PANES[0]
    AUTO_FOCUS = f"#{PANES[0]}"

    def __init__(
        self,
        subject: ShownProgram,
        charset: Charset,
        runs: RunController[RunT_co],
        live: Callable[[], LiveRun | None] = lambda: None,
    ) -> None:
        super().__init__()
        self._compositor = PatchCompositor()
        self.subject = subject
        self.charset = charset
        """What the terminal can show."""
        self.runs = runs
        self._frames = FrameLoop(self, runs, self._draw, lambda: isinstance(self.app.screen, JumpScreen))
        self.finisher = FileFinisher(self.tell)
        self.navigation = TimeNavigation(
            lambda: [runs.timeline], lambda: runs.timeline.end, self.redraw, live
        )
        self.panes = PaneLayout(self, self, self.PANES_HERE, self.FIRST_PANE, lambda: self.changes.words)
        self._narration = Narration(self, runs, self.navigation, self.panes)
        self._sizes = SizeKeys(self, self.panes, self.tell)
        self.bars = BarSelection(lambda: [self.query_one(Lanes)], self.navigation, self.redraw, self.tell)
        selected = (self.navigation, self.bars, self.panes, subject)
        self.selection = LaneSelection(self, self, runs, *selected)
        self._exports = Exports(self, runs, self.navigation, self.finisher)
        self._chain = ChainPath(self, runs, self.navigation)
        self._copy = DetailsCopy(self, self, runs, self.navigation, subject)

    def add_parts(self, *parts: ScreenPart, **more: Callable[[], object]) -> None:
        """Add a screen's own parts, and actions by their ids, to the common ones."""
        following = self.subject.following
        ways: list[ScreenPart] = [WaysBack(self), Jumps(self, self, self.panes)]
        if following is not None:
            ways.append(NextLesson(self, self.runs, following))
        time = (self.navigation, MomentKey(self, self.navigation), self._chain, self._narration)
        shown = (self.panes, self.bars, self.selection, self._sizes, self._exports, self._copy)
        self._parts = ScreenParts(self, Scope.LESSON, *time, *shown, *ways, *parts, **more)
        self._keys = OfferedKeys(self, self._parts, self.charset)

    def post(self, message: Message) -> None:
        """Post a message from any thread; a closing screen drops it."""
        self.post_message(message)

    # the interface for parts

    @property
    def console(self) -> ConsoleApp:
        """The app."""
        return console_of(self)

    def tell(self, sentence: str | None, holds: Callable[[], bool] | None = None) -> None:
        """Show a sentence for a few seconds, and no longer than it ``holds``; nothing for None."""
        if sentence is not None:
            self._keys.take_back_reason()
            self.notify(sentence, markup=False)
            self._keys.reason = None if holds is None else (sentence, holds)

    def key(self, action: str) -> str:
        """Return the key in force of one of a lesson's actions, as people write it."""
        return keymap_of(self.app).sign(Scope.LESSON, action, self.charset)

    def redraw(self) -> None:
        """Draw everything in the next frame, or at once if none was just drawn."""
        self._frames.redraw()

    def go_on(self) -> None:
        """Note that the run has grown, which the next frames draw."""
        self._frames.grow()

    # what differs from screen to screen

    @property
    def changes(self) -> Changes:
        """The changes to the program's set-up."""
        return Changes()

    def page(self) -> Mapping[str, str]:
        """Return the unlocked sections of the guide."""
        return {"guide": self.subject.guide}

    @property
    def steps(self) -> tuple[LessonStep, ...]:
        """The steps through a lesson, with how far the learner is."""
        return ()

    def drawn(self) -> None:
        """Hook that is called after each drawing."""

    def diagnosis(self) -> Diagnosis:
        """Return the diagnosis of the moment on screen."""
        runs, sentence = self.runs, self._chain.sentence
        if sentence:
            return Diagnosis(sentence, DiagnosisLevel.FINE, stays=True)
        return diagnosis_on_screen(runs.run, self.navigation.playhead, runs.concurrency, keymap_of(self.app))

    def show_new_run(self) -> None:
        """Show another run from its beginning, before it is started."""
        self.navigation.action_live()
        self.query_one(Lanes).changes = self.changes.words
        self.panes.update_titles()
        self.bars.select(None)
        self.query_one(CodeView).read_anew(self.changes.texts)

    # layout

    def compose(self) -> ComposeResult:
        """Lay out lines, lanes and panes."""
        yield StatusLine()
        yield Lanes()
        yield self._narration.widget
        yield Tabs(self.PANES_HERE)
        with Container(id="panes"):
            for pane in self.compose_panes():
                assert pane.id is not None
                pane.border_title = title_of(pane.id)
                pane.add_class("pane")
                yield pane
        yield DiagnosisLine()
        yield KeyBar(Scope.LESSON, self.charset)

    def compose_panes(self) -> Iterator[Widget]:
        """Yield the panes."""
        factory, robot = FactoryView(id="factory"), RobotView(id="robot")
        factory.can_focus = robot.can_focus = True
        subject = self.subject
        code = CodeView(subject.node_path, subject.source, subject.sources, id="code")
        yield from (Guide(self.page(), id="guide"), code, robot, factory, LogView(id="log"))
        yield ShellView(id="shell")

    def on_mount(self) -> None:
        """Start the run and the timer that draws it."""
        lanes, robot, factory = self.query_one(Lanes), self.query_one(RobotView), self.query_one(FactoryView)
        robot.actors = self.subject.scene
        lanes.charset = robot.charset = factory.charset = self.charset
        lanes.service, lanes.changes = self.subject.service, self.changes.words
        self.panes.enlarge("")
        self.panes.name_robot()
        prompt, takes_lines = self.query_one(Prompt), self._parts.has("prompt")
        prompt.disabled, prompt.display = not takes_lines, takes_lines
        self.panes.show(self.panes.current)
        self.start()
        self._frames.start()
        self.set_interval(exporting.PROGRESS_INTERVAL, self._exports.show_progress)
        code = self.query_one(CodeView)
        self.set_interval(_DISK, lambda: code.check_disk(self.runs.timeline.entities.values()))
        for name in self.PANES_HERE:
            pane = self.panes.pane(name)
            if isinstance(pane, CodeView | FactoryView | LogView | ChecksView):
                self.watch(pane, "note", self.panes.update_titles)
        for lines in (*self.query(CodeView), *self.query(LogLines), *self.query(ChecksView)):
            self.watch(lines, "picked", self.redraw)
        self.watch(self.query_one(LogLines), "follows", self.redraw)
        self.call_after_refresh(collect_now)  # before the first key, as it takes longer than drawing

    def start(self) -> None:
        """Start the first run."""
        self.tell(self.runs.run.start())

    def on_unmount(self) -> None:
        """End the run, every recording and every export, whatever way the screen is left."""
        self._exports.leave()
        self.finisher.tell = self.console.tell_saved
        self.console.collect_later()
        self.console.end_later(self._end())

    async def _end(self) -> None:
        saved = await asyncio.to_thread(self.runs.run.stop)
        if saved is not None:
            self.console.tell_saved(saved)
        await self.finisher.wait()

    # the run

    @on(RunController.Delivered)
    def _take(self, message: RunController.Delivered) -> None:
        if (warning := self.runs.take(message)) is not None:
            self.notify(warning, severity="warning", markup=False)
        if message.run == self.runs.number:
            self._frames.grow()

    @on(RunController.Over)
    def _note_the_end(self, message: RunController.Over) -> None:
        if message.run == self.runs.number:
            self.finisher.finish(self.runs.run.over(message.trouble))
            self.redraw()

    def update_findings(self) -> None:
        """Update the findings now."""
        self.runs.findings.update()
        self.redraw()

    # drawing

    def draw(self) -> None:
        """Show the playhead's moment."""
        self._frames.draw(FrameContent.ALL)

    def _draw(self, content: FrameContent) -> None:
        if self.layout_now is Layout.SMALL:
            return
        if content is not FrameContent.TEXTS:
            self.draw_lanes()
        if content in (FrameContent.ALL_BUT_TEXTS, FrameContent.ALL):
            self._draw_beside_lanes()
        if content in (FrameContent.TEXTS, FrameContent.ALL):
            self._draw_panes(lambda pane: isinstance(pane, _TEXTS))
            self._keys.show()

    def _draw_beside_lanes(self) -> None:
        self.query_one(Lanes).told = self.navigation.now  # all panes show the same moment
        self._narration.draw()
        run, findings, keymap = self.runs.run, self.runs.findings.findings, keymap_of(self.app)
        self.panes.set_robot(has_robot(run) or bool(self.subject.scene))
        self.query_one(StatusLine).status = status_of(
            self.subject.heading_of(run.timeline),
            run,
            self.navigation.playhead,
            self.subject.executor,
            self._exports.percent,
            self.steps,
            self.runs.findings.standstill(),
            self.runs.pace.slow,
        )
        self.query_one(CodeView).over = not run.alive
        line = self.query_one(DiagnosisLine)
        at = self.navigation.playhead.at
        line.diagnosis = with_worst_problem(self.diagnosis(), findings, how_to_continue(run, keymap), at)
        line.note = call_note(run.timeline, self.navigation.now)
        line.problems = problems_note(findings, keymap, self.charset)
        self._draw_panes(lambda pane: not isinstance(pane, _TEXTS))
        self.drawn()

    def _draw_panes(self, chosen: Callable[[Widget], bool]) -> None:
        for pane in map(self.panes.pane, self.PANES_HERE):
            if pane.display and chosen(pane):
                self.draw_pane(pane)

    def draw_lanes(self) -> None:
        """Show it on the lanes only."""
        lanes = self.query_one(Lanes)
        lanes.window, lanes.now = self.navigation.window, self.navigation.now
        here = self._chain.here
        lanes.path = () if here is None else here.steps
        lanes.timeline = self.runs.timeline

    def draw_pane(self, pane: Widget) -> None:
        """Show it on one pane."""
        run, now = self.runs.run, self.query_one(Lanes).told or 0
        match pane:
            case CodeView() | LogView():
                pane.show(run.timeline, now)
            case ShellView():
                pane.show(run.timeline, now)
                pane.ask(run.asked, keymap_of(self.app), self.charset)
                if not run.alive and isinstance(self.focused, ProgramKeyboard):
                    self.focused.action_leave_keyboard()
            case FactoryView():
                stuck = self.runs.findings.stuck_at(now)
                pane.show(run.timeline, now, run.speed or 1.0, () if stuck is None else stuck.ring)
            case RobotView():
                pane.now, pane.timeline = now, run.timeline

    def laid_out(self) -> None:
        """Draw again for the new layout."""
        if self.is_mounted:
            self._sizes.apply()
        self.redraw()

    # keys

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the actions that are available now."""
        return self._keys.offer(action, parameters)

    # messages of widgets

    def on_descendant_focus(self, event: DescendantFocus) -> None:
        """Make the pane with the focus current, and show its keys."""
        self.panes.follow_focus(event.widget)
        self._keys.follow_focus()

    @on(Tabs.TabPicked)
    def _pick_pane(self, message: Tabs.TabPicked) -> None:
        self.panes.show(message.pane)

    @on(Lanes.WheelTurned)
    def _turn(self, message: Lanes.WheelTurned) -> None:
        self.navigation.zoom(message.steps)

    @on(Lanes.BarPicked)
    def _pick_bar(self, message: Lanes.BarPicked) -> None:
        self.bars.pick(message)

    @on(LogLines.MomentPicked)
    @on(ChecksView.MomentPicked)
    def _pick_moment(self, message: LogLines.MomentPicked | ChecksView.MomentPicked) -> None:
        self.selection.pick_moment(message.at)

    @on(CodeView.CallbackPicked)
    def _pick_callback(self, message: CodeView.CallbackPicked) -> None:
        self.selection.pick_callback(message)

    @on(CodeView.EditorWanted)
    def _edit(self) -> None:
        self.panes.action_open_source()

    @on(DiagnosisLine.Clicked)
    def _list_diagnoses(self) -> None:
        self.selection.action_diagnoses()
