"""Two runs on screen, one above the other on a common time axis, and a table of what differs."""

import asyncio
from dataclasses import replace
from time import monotonic
from typing import ClassVar

from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.events import Key
from textual.widgets import Static

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.keys.keymap import canonical, keymap_of
from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.runs.compared_runs import ComparedSide
from cbtui.runs.judged.compared_problems import ComparedProblems
from cbtui.runs.live.playhead import SPANS, Playhead
from cbtui.screens.compare_scrolling import TableScrolling
from cbtui.screens.compare_words import about, only_begun, shorter, why_nothing
from cbtui.screens.layout import Layout
from cbtui.screens.parts.bars import BarSelection
from cbtui.screens.parts.frames import FRAMES_A_SECOND
from cbtui.screens.parts.jumps import Jumps
from cbtui.screens.parts.navigation import MomentKey, TimeNavigation
from cbtui.screens.parts.part import ScreenParts
from cbtui.screens.sized import SizedScreen
from cbtui.screens.windows.jump import JumpScreen
from cbtui.terminal.compositing import PatchCompositor
from cbtui.terminal.textual_internals import clear_hints
from cbtui.widgets.comparison import ComparisonHeadings, ComparisonTable, HeadingLine
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.lanes.keys import lane_keys
from sim.quantities.durations import duration, timestamp
from sim.trace.figures.compared_groups import lettered_alike
from sim.trace.figures.comparison import Comparison, compare_incrementally, covered, first_difference
from sim.trace.figures.comparison_rows import Section, sections
from sim.trace.figures.comparison_sentences import (
    NO_PROBLEMS,
    capitalised,
    ended_early,
    extent,
    is_tie,
    notable,
    verdict,
)
from sim.trace.figures.comparison_wording import stretch
from sim.trace.incremental import Incremental, within
from sim.trace.model import Nanoseconds, Window

_STRONG = Ink(Role.STRONG)
_FAINT = Ink(Role.FAINT)
_TABLE_ALONE = "-table-alone"
_LANES_ALONE = "-lanes-alone"
"""Style classes of the screen while the table, or the lanes, fill it."""
_REST_FACTOR = 9
"""Rest after a comparison, as a multiple of its duration: comparing takes at most a tenth of the time."""
_TIME_SLICE = 0.008
"""Seconds of comparing before other tasks get their turn."""
_YIELD_TIME = 0.002
"""Least seconds for other tasks."""
_PROGRESS_AFTER = 0.5
"""Seconds after which progress is shown."""


class CompareScreen(SizedScreen[None]):
    """Compares two runs; one that is still going on is drawn and counted as it grows.

    Both share the window of time and the cursor, which is clamped to the end of each run. The playhead
    follows the end of a live or the longer run. ``bounds`` is the table's window; None: all that both cover.
    """

    SCOPE = Scope.COMPARE
    CSS_PATH = "compare.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.COMPARE)]
    AUTO_FOCUS = ""

    def __init__(
        self, first: ComparedSide, second: ComparedSide, charset: Charset, bounds: Window | None = None
    ) -> None:
        super().__init__()
        self._compositor = PatchCompositor()
        self._sides = (first, second)
        self.charset = charset
        """What the terminal can show."""
        self._bounds = bounds
        self._whole = True
        self.navigation = TimeNavigation(
            lambda: [side.timeline for side in self._sides], lambda: self._end, self._moved
        )
        if bounds is not None:
            self.navigation.playhead = _at_the_end_of(bounds, self._end)
        self.bars = BarSelection(
            lambda: list(self.query(Lanes)),
            self.navigation,
            lambda: self.query_one(KeyBar).changed(),
            lambda sentence: self.notify(sentence, markup=False),
        )
        self._parts = ScreenParts(
            self,
            Scope.COMPARE,
            self.navigation,
            MomentKey(self, self.navigation),
            self.bars,
            Jumps(self, self),
            TableScrolling(lambda: self.query_one(ComparisonTable)),
        )
        self._drawn: tuple[object, ...] = ()
        self._compared: tuple[object, ...] | None = None
        self._comparing = False
        self._rest_until = 0.0
        self._problems = ComparedProblems(first.timeline, second.timeline)
        self._told = self._verdict = ""
        self._is_tie = False
        self._comparison: Comparison | None = None
        self._first_difference: Nanoseconds | None = None
        self._has_moved = bounds is not None

    def compose(self) -> ComposeResult:
        """Lay out both runs and the table."""
        yield HeadingLine(self.charset, id="status")
        yield Static(id="verdict", markup=False)
        for number in range(len(self._sides)):
            yield HeadingLine(self.charset, id=f"run{number}")
            yield Lanes(id=f"lanes{number}")
        yield HeadingLine(self.charset, ruled="-" if self.charset is Charset.ASCII else "─", id="window")
        yield ComparisonHeadings(self.charset)
        yield ComparisonTable(self.charset)
        yield KeyBar(Scope.COMPARE, self.charset)

    def on_mount(self) -> None:
        """Start drawing, and warn of damaged runs; what was said before is about another screen."""
        clear_hints(self.app)
        for number, side in enumerate(self._sides):
            lanes = self._lanes(number)
            lanes.threads_last, lanes.can_focus = True, False
            lanes.charset, lanes.service = self.charset, side.service
            if side.damage is not None:
                self.notify(side.damage, severity="warning", markup=False)
        self._enlarge("")
        self.watch(self.query_one(ComparisonTable), "show_vertical_scrollbar", self.query_one(KeyBar).changed)
        self.set_interval(1 / FRAMES_A_SECOND, self.draw)

    # drawing

    def draw(self) -> None:
        """Show the playhead's moment if it or a run has changed."""
        state = (self.navigation.playhead, self.layout_now, *(side.alive() for side in self._sides))
        now = (state, *(side.timeline.end for side in self._sides))
        if self.layout_now is Layout.SMALL or isinstance(self.app.screen, JumpScreen):
            return
        if now != self._drawn:
            if now[:1] != self._drawn[:1]:
                self.query_one(KeyBar).changed()
            self._drawn = now
            self._draw_runs()
        self._draw_table()

    def laid_out(self) -> None:
        """Draw what the new layout shows."""
        self._drawn = ()
        self._limit_lanes()
        self.draw()

    def _limit_lanes(self) -> None:
        """Leave room for the table, if there is one."""
        for lanes in self.query(Lanes):
            lanes.styles.max_height = None if self.has_class(_LANES_ALONE) else (self.size.height - 1) // 4

    def _draw_runs(self) -> None:
        at, shown = self.navigation.now, self.navigation.window
        self.query_one("#status", HeadingLine).words = (
            TextRun(" Two runs", _STRONG),
            TextRun(f"   t {timestamp(at)}", _STRONG),
            TextRun(f"   {duration(shown.length)} on screen", _FAINT),
        )
        for number, side in enumerate(self._sides):
            self.query_one(f"#run{number}", HeadingLine).words = about(
                number, side, self.size.width, self.charset
            )
            lanes = self._lanes(number)
            # Nothing is known of a run after its end, even of a callback that was still running.
            lanes.window, lanes.now = shown, min(at, side.timeline.end)
            lanes.whole = max(each.timeline.end for each in self._sides)
            lanes.timeline = side.timeline

    def _draw_table(self) -> None:
        """Start a new comparison if the window changed, but rarely enough to keep the keys responsive."""
        asked = self._common(self._asked)
        compared = asked, *(side.timeline.ended for side in self._sides)
        if compared == self._compared and self._whole and not self._comparing and self._verdict:
            self._title(self._extent(asked))  # a run goes on
            self._compare_problems()
        if compared == self._compared or self._comparing or monotonic() < self._rest_until:
            return
        self._compared = compared
        self._comparing = True
        self.run_worker(self._compare(asked), group="comparison", exclusive=True)

    def _compare_problems(self) -> None:
        """Update what is gone or new, as a run goes on beyond the end of the other one; but rarely."""
        began = monotonic()
        if began >= self._rest_until and any(side.alive() for side in self._sides):
            self._told = self._problems.compared(self._comparison).told
            self._show_first_difference()
            self.query_one(KeyBar).changed()
            self._rest_until = monotonic() + _REST_FACTOR * (monotonic() - began)

    async def _compare(self, asked: Window) -> None:
        """Compare in slices on the UI thread, which alone reads timelines, and show the result."""
        began, worked, work = monotonic(), 0.0, self._figures(asked)
        while self.query(Lanes):  # none are left of a screen that is being closed
            turn = monotonic()
            found = within(_TIME_SLICE, work)
            worked += monotonic() - turn
            if found is not None:
                self._title(found[0])
                self.query_one(ComparisonTable).show(found[1])
                self._show_first_difference()
                self._comparing = False
                self._rest_until = monotonic() + _REST_FACTOR * worked
                return
            if monotonic() - began >= _PROGRESS_AFTER:
                self._title(f"Comparing, {monotonic() - began:.0f} s so far")
            await asyncio.sleep(_YIELD_TIME)

    def _show_first_difference(self) -> None:
        """Show the verdict; of whole runs go to where they differ, as long as nobody has moved the cursor."""
        compared = self._comparison
        if not self._verdict or compared is None:
            self.query_one("#verdict", Static).update(self._told)
            return
        at, early = self._first_difference, self._ended_early
        none = f"no call differs{' notably' if compared.is_real else ''}"
        where = none if at is None else f"they differ from {timestamp(at)} on"
        is_part = self._whole and (compared.window.end < self._end or compared.window.start > 0)
        span = f"in {stretch(compared.window)} " if is_part else ""
        verdict = f"{where}; {span}{self._verdict[0].lower()}{self._verdict[1:]}"
        if not self._whole:
            verdict = f"On screen, {stretch(compared.window)}: {verdict}"
        elif compared.shares_little:
            verdict = self._verdict
        elif early:
            verdict = f"{early}; {'until then ' if at is None else ''}{where}"
        elif self._is_tie and any(side.alive() for side in self._sides):
            verdict = f"{where} so far; neither run is better yet: {shorter(*self._sides)}"
        before = f"{self._told} " if self._told and self._whole else ""
        self.query_one("#verdict", Static).update(before + capitalised(verdict))
        at = min(side.timeline.end for side in self._sides) if at is None and early else at
        if at is not None and self._whole and not self._has_moved and at != self.navigation.now:
            self.navigation.seek(at)
            self._has_moved = False

    @property
    def _ended_early(self) -> str:
        """Which run an exception ended while the other one goes on, and how far that has come; or ""."""
        ends = (side.timeline.end for side in self._sides)
        return "" if self._comparison is None else ended_early(self._comparison, *ends)

    def _title(self, words: str) -> None:
        self.query_one("#window", HeadingLine).words = (TextRun(f" {words} ", _STRONG),)

    def _forget_comparison(self) -> None:
        """Discard the comparison, as another one is needed."""
        self.workers.cancel_group(self, "comparison")
        self._comparing = False
        self._compared = None
        self._rest_until = 0.0

    def _figures(self, asked: Window) -> Incremental[tuple[str, tuple[Section, ...]]]:
        first, second = self._sides
        begun = only_begun(first, second)
        if begun or asked.length <= 0:
            self._verdict = ""
            return f"{self._what}: {begun or f'nothing that both runs have; {shorter(first, second)}'}", ()
        alike = yield from lettered_alike(first.timeline, self._problems.second, second.timeline)
        self._lanes(1).timeline = alike
        self._sides = first, replace(second, timeline=alike)
        compared = yield from compare_incrementally(first.timeline, alike, asked)
        self._first_difference = yield from first_difference(first.timeline, alike, asked)
        problems = NO_PROBLEMS
        if self._whole:
            yield
            problems = self._problems.compared(compared)
            self._told = problems.told
        self._verdict, self._is_tie = verdict(compared, problems), is_tie(compared, problems)
        self._comparison = compared
        for number, kept in enumerate(notable(compared, problems)):
            self._lanes(number).kept = kept
        if self._whole:
            return self._extent(asked), sections(compared)
        cut = asked.end < min(self._asked.end, self._end)
        after = f"; {shorter(first, second)}" if cut else ""
        return f"{self._what}, {stretch(asked)}{after}", sections(compared)

    @property
    def _what(self) -> str:
        if not self._whole:
            return "On screen"
        if self._bounds is not None:
            return "As asked"
        return "What both runs have" if self._ended_early else "Whole runs"

    def _extent(self, compared: Window) -> str:
        runs = [side.timeline for side in self._sides]
        is_real = any(run.is_real for run in runs)
        return f"{self._what}, {extent(compared, *(run.end for run in runs), is_real=is_real)}"

    @property
    def _asked(self) -> Window:
        """The requested window of the table, which may exceed a run."""
        if not self._whole:
            return self.navigation.window
        return self._bounds or Window(0, max(covered(side.timeline) for side in self._sides))

    def _common(self, asked: Window) -> Window:
        end = min(asked.end, *(covered(side.timeline) for side in self._sides))
        return Window(asked.start, max(asked.start, end))

    @property
    def _end(self) -> Nanoseconds:
        """The end of the axis: that of the running run, else that of the longer one."""
        going_on = [side.timeline.end for side in self._sides if side.alive()]
        return max(going_on or [side.timeline.end for side in self._sides])

    def _lanes(self, number: int) -> Lanes:
        return self.query_one(f"#lanes{number}", Lanes)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the actions that are available now."""
        match action:
            case "deselect":
                return self.bars.selection is not None
            case "earlier":
                return self.navigation.now > 0
        return self._parts.offer(action, parameters)

    @on(Lanes.BarPicked)
    def _pick_bar(self, message: Lanes.BarPicked) -> None:
        self.bars.pick(message)

    @on(Lanes.WheelTurned)
    def _turn(self, message: Lanes.WheelTurned) -> None:
        self.navigation.zoom(message.steps)

    def on_key(self, event: Key) -> None:
        """Say why a key of a run does nothing here."""
        meant = keymap_of(self.app).on(event.key, Scope.COMPARE, Scope.LESSON)
        if meant and canonical(event.key) not in self.query_one(KeyBar).in_force():
            event.stop()
            for reason in why_nothing(meant, self.charset):
                clear_hints(self.app)  # two would reach down to the verdict
                self.notify(reason, markup=False)

    def action_deselect(self) -> None:
        """Select nothing."""
        self.bars.select(None)

    def _moved(self) -> None:
        self._has_moved = True
        if self._comparing and not self._whole:
            self._forget_comparison()
        self.draw()

    def action_window(self) -> None:
        """Switch the table between the whole runs and the window on screen."""
        self._whole = not self._whole
        self._forget_comparison()
        self.draw()

    def action_maximise(self) -> None:
        """Let the table fill the screen, or undo that."""
        self._enlarge("" if self.has_class(_TABLE_ALONE) else _TABLE_ALONE)

    def action_enlarge_lanes(self) -> None:
        """Let the lanes fill the screen, or undo that."""
        self._enlarge("" if self.has_class(_LANES_ALONE) else _LANES_ALONE)

    def _enlarge(self, alone: str) -> None:
        """Let the table or the lanes fill the screen; "" for neither."""
        for name in (_TABLE_ALONE, _LANES_ALONE):
            self.set_class(name == alone, name)
        self._drawn = ()
        self._limit_lanes()
        more = () if alone == _LANES_ALONE else ("enlarge_lanes",)
        for lanes in self.query(Lanes):
            lanes.keys = lane_keys(keymap_of(self.app), Scope.COMPARE, self.charset, *more)

    def action_leave(self) -> None:
        """Go back to where the comparison was opened."""
        self.dismiss()


def _at_the_end_of(bounds: Window, end: Nanoseconds) -> Playhead:
    """The playhead that shows the bounds, in runs of length ``end``."""
    span = next((span for span in SPANS if span >= bounds.length), SPANS[-1])
    return Playhead(span, start=bounds.start).moved_to(bounds.end, end)
