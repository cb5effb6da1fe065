"""A lesson on screen: its run on lanes, the moment in words, and its panes."""

from collections.abc import Iterable
from math import inf
from pathlib import Path
from time import monotonic
from typing import ClassVar

from textual.binding import BindingType

from cbtui.keys.actions import CHECKS, Scope, bindings_of
from cbtui.keys.keymap import keymap_of
from cbtui.runs.live.live_run import State
from cbtui.runs.live.playhead import SPANS
from cbtui.screens.diagnoses import problems_note
from cbtui.screens.layout import Layout
from cbtui.screens.lesson.exporting import ExportingScreen
from cbtui.terminal.processor import not_computing, waited
from cbtui.widgets.checks import ChecksView
from cbtui.widgets.code import CodeView
from cbtui.widgets.diagnosis import Diagnosis, call_note, verdict, way_on, with_worst
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.factory import FactoryView
from cbtui.widgets.key_bar import KeyBar, hint
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogFilter, LogLines, LogView
from cbtui.widgets.robot import RobotView
from cbtui.widgets.shell import ProgramKeyboard, Prompt, ShellView
from cbtui.widgets.status_line import StatusLine, status_of

FRAMES_A_SECOND = 30

_LANES_A_PANE = 6
"""Frames of the lanes for each of the other panes while a run goes on: those tell in words and figures, which
nobody reads as fast as lanes are seen to move."""

_RESTS = 2.0
"""Seconds of rest for each second that a frame had to wait for a processor."""

_LONGEST_REST = 0.5
"""Seconds after which a frame is drawn however short of processors the machine is."""

_LANES_A_TEXT = 12
"""Frames of the lanes for each of log and code: lines that scroll past are read no faster."""

_GLANCE = 150_000_000
"""Nanoseconds of a person's time for which a worker is seen walking."""

_ON_LANES = ("zoom", "pan", "select", "lane", "event", "code", "copy", "deselect")
"""Labels of the actions that the lanes tell of themselves."""

_ON_LINES = ("follow", "pick_line", "pick_callback", "copy", "let_go", "look_there")
"""Actions of log, code and checks that have a meaning for some lines only."""

_WITH_KEYS = (LogLines, CodeView, ChecksView)
"""Panes that know which of their own actions have a meaning."""

_TEXTS = (CodeView, LogView)
"""Panes that are lines of text."""

_DISK = 1.0
"""Seconds after which the source's file is looked at again."""


class LessonScreen(ExportingScreen):
    """Runs a lesson and shows it: everything on it is a function of the run's timeline and of a moment.

    A timer draws what there is new. However fast a run is, the lanes are drawn ``FRAMES_A_SECOND`` times at
    most, the other panes less often; what the person does is seen on all of them in the next frame.
    """

    SCOPE = Scope.LESSON
    CSS_PATH = Path(__file__).with_name("lesson.tcss")
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.LESSON)]
    AUTO_FOCUS = "#guide"

    _drawn_at = inf
    """When all panes were drawn last; the first time is the timer's."""
    _rests_until = -inf
    """When the next frame may be drawn that nobody asked for."""
    _texts_behind = False
    """Whether log and code have been left out since."""

    def on_mount(self) -> None:
        """Start the run and the timer that draws it."""
        lanes, robot, factory = self.query_one(Lanes), self.query_one(RobotView), self.query_one(FactoryView)
        lanes.charset = robot.charset = factory.charset = self._charset
        lanes.service = self._subject.service
        self._enlarge("")
        lanes.changes = self._changes.words
        self._show(self._pane)
        self._start()
        self.set_interval(1 / FRAMES_A_SECOND, self._draw_if_stale)
        code, log = self.query_one(CodeView), self.query_one(LogView)
        self.set_interval(_DISK, code.look_at_disk)
        for view in (code, log):
            self.watch(view, "note", self._entitle)
        for lines in (code, self.query_one(LogLines)):
            self.watch(lines, "picked", self._redraw)

    def draw(self) -> None:
        """Show the moment that the playhead is at."""
        self._draw_with(self.PANES_HERE)
        self._texts_behind = False

    def _draw_all_but_texts(self) -> None:
        self._draw_with([name for name in self.PANES_HERE if not isinstance(self._widget(name), _TEXTS)])
        self._texts_behind = True

    def _draw_with(self, panes: Iterable[str]) -> None:
        self._stale = self._grown = False
        self._drawn_at = monotonic()
        if self.layout_now is Layout.SMALL:
            return
        self.draw_lanes()
        run, timeline = self._run, self._run.timeline
        now = self._playhead.now(timeline.end)
        subject = self._subject
        self.query_one(StatusLine).status = status_of(
            subject.heading, run, self._playhead, subject.executor, self._exported
        )
        self.query_one(CodeView).over = not run.alive
        line = self.query_one(DiagnosisLine)
        told = self._watch.told
        line.diagnosis = with_worst(self._verdict(), told, way_on(run, keymap_of(self.app)))
        line.note = call_note(timeline, now)
        line.problems = problems_note(told, keymap_of(self.app), self._charset)
        for name in panes:
            if self._widget(name).display:
                self._draw_pane(name)
        self._offer_keys()
        self._look_whether_watched()

    def _verdict(self) -> Diagnosis:
        """What to say of the moment on screen."""
        return verdict(self._run, self._playhead, self._concurrency, keymap_of(self.app))

    def draw_lanes(self) -> None:
        """Show it on the lanes alone."""
        timeline = self._run.timeline
        lanes = self.query_one(Lanes)
        end = timeline.end
        lanes.window, lanes.now, lanes.timeline = (
            self._playhead.window(end),
            self._playhead.now(end),
            timeline,
        )

    def laid_out(self) -> None:
        """Draw what the new layout shows."""
        self._stale = True

    def _draw_at_once(self) -> None:
        """Draw what the person did without waiting for the timer, as long as that is not done in a row."""
        if self._stale and monotonic() - self._drawn_at >= 1 / FRAMES_A_SECOND:
            self.draw()

    def _draw_if_stale(self) -> None:
        if monotonic() < self._rests_until and not self._stale:
            return
        self._frames += 1
        if self._watch.look_when_due():
            self._stale = True
        more = self._grown or self._texts_behind
        if self._stale or (more and self._frames % _LANES_A_TEXT == 0):
            self.draw()
        elif self._grown and self._frames % _LANES_A_PANE == 0:
            self._draw_all_but_texts()
        elif self._grown and self.layout_now is not Layout.SMALL:
            self.draw_lanes()
        else:
            return
        self.call_after_refresh(self._rest, not_computing())

    def _rest(self, before: float) -> None:
        """Draw nothing unasked for as long as the machine let the last frame wait for a processor."""
        self._rests_until = monotonic() + min(_RESTS * waited(before), _LONGEST_REST)

    def _draw_pane(self, name: str) -> None:
        timeline = self._run.timeline
        now = self._playhead.now(timeline.end)
        match self._widget(name):
            case CodeView() | LogView() as view:
                view.show(timeline, now)
            case ShellView() as shell:
                shell.show(timeline, now)
                shell.ask(self._run.asked, keymap_of(self.app), self._charset)
                if not self._run.alive and isinstance(self.focused, ProgramKeyboard):
                    self.focused.action_leave_keyboard()
            case FactoryView() as factory:
                factory.now, factory.timeline = now, timeline
                factory.glance = round(_GLANCE * (self._run.speed or 1.0))
            case RobotView() as robot:
                robot.now, robot.timeline = now, timeline

    def _offer_keys(self) -> None:
        """Tell the line of keys when others have a meaning."""
        run = self._run
        lanes = self.query_one(Lanes)
        offered = (
            run.state,
            self._playhead,
            run.speed,
            run.asked,
            run.timeline.end > 0,
            self._before is None,
            lanes.has_focus,
            lanes.selection is None,
            self._standing,
            self.layout_now,
            *(self.check_action(action, ()) for action in _ON_LINES),
        )
        if offered != self._offered:
            self._offered = offered
            bar = self.query_one(KeyBar)
            # Where the lanes have a frame, that tells of them.
            framed = self.layout_now is Layout.GRID
            bar.first = (*_ON_LANES, "enlarge") if lanes.has_focus and not framed else ()
            bar.changed()
            lanes.hint = hint(bar.working(_ON_LANES), self._charset)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer what has a meaning now."""
        run, playhead = self._run, self._playhead
        focused = self.focused
        if isinstance(focused, _WITH_KEYS) and not focused.check_action(action, parameters):
            return False
        typing = isinstance(focused, Prompt | ProgramKeyboard | LogFilter)
        end = run.timeline.end
        lanes = self.query_one(Lanes)
        on_lanes = lanes.has_focus
        each_key = isinstance(focused, ProgramKeyboard) and focused.reads.takes_keys
        callback = None if lanes.selection is None else lanes.selection.entity
        meaningless = {
            "pan_earlier": typing or playhead.window(end).start == 0,
            "pan_later": typing or playhead.follows or playhead.window(end).end > end,
            "select": typing or (on_lanes and lanes.selection is not None),
            "to_code": not on_lanes or callback is None,
            "lane_above": not on_lanes,
            "lane_below": not on_lanes,
            "deselect": lanes.selection is None and not on_lanes,
            "copy_details": typing or isinstance(focused, LogLines | CodeView),
            "next_pane": typing,
            "prompt": not run.alive,
            "type": run.asked is None,
            "submit": each_key,
            "interrupt": each_key,
            "filter_log": isinstance(focused, LogLines),
            "open_source": isinstance(focused, CodeView),
            "call_service": not run.alive,
            "call_service_off": not run.alive,
            "pause": not run.alive or run.paused,
            "resume": not run.alive or not run.paused,
            "step": playhead.at is None and not (run.virtual and run.state is State.PAUSED),
            "step_back": playhead.now(run.timeline.end) == 0,
            "reset_world": not run.alive or run.state is State.SILENT,
            "record": not run.alive,
            "export": end == 0,
            "run_again": run.alive and run.state is not State.SILENT,
            "slower": not run.alive or run.speed == run.speeds[0],
            "faster": not run.alive or run.speed == run.speeds[-1],
            "live": playhead.follows,
            "later": playhead.at is None,
            "zoom_in": playhead.span == SPANS[0],
            "zoom_out": playhead.span == SPANS[-1],
            "compare": self._before is None,
            "next_lesson": self._subject.following is None,
            "exercise": self.lesson is None or self.lesson.exercise is None,
            "lesson": True,
            "watch": True,
            "show_pane": parameters == (CHECKS,),
            **self._not_to_be_learnt,
        }
        return not meaningless.get(action, False)
