"""The widget of the lanes: draws what its painter paints, and reports what the pointer picks."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from operator import itemgetter

from textual.events import Click, MouseScrollDown, MouseScrollUp
from textual.geometry import Offset, Size
from textual.message import Message
from textual.reactive import reactive

from cbtui.looks.theme import GLYPHS, Charset, TextRun
from cbtui.terminal.textual_internals import set_subtitle, set_title
from cbtui.widgets.jump import JumpTarget
from cbtui.widgets.lanes.details import details_of_selection
from cbtui.widgets.lanes.details_rows import ROWS, details_rows
from cbtui.widgets.lanes.keys import USUAL_KEYS, LaneKeys
from cbtui.widgets.lanes.painter import INTERVALS_PER_FRAME, LanePainter
from cbtui.widgets.lanes.picture import LanePicture
from cbtui.widgets.lanes.room import wanted_rows
from cbtui.widgets.lanes.rows import NONE_KEPT, Lane, all_lanes
from cbtui.widgets.lanes.selection import (
    Selection,
    bar_at,
    bar_up_to,
    bars_in,
    end_of,
    neighbouring_bar,
    start_of,
)
from cbtui.widgets.painted_widget import PaintedWidget, painted
from sim.trace.events import EntityId, ThreadId
from sim.trace.figures.chains import ChainStep
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

_LEAST_LANES = 3
"""Rows of lanes below which the details of the selection are hidden."""

_JUMP_WIDTH = 4
"""Least columns of a bar that gets a letter to jump to it."""
_MOST_JUMPS = 100
"""The number of latest bars of a lane that can get a letter."""

_A_FRAME = 1 / 30
"""Seconds between two frames while the lanes fill."""


class Lanes(PaintedWidget, can_focus=True):
    """Threads as lanes, callbacks as bars, waits as hatching; the time axis runs along the bottom.

    Set ``timeline`` again (it may be the same one) when it has grown. ``now`` is the cursor that all panes
    share; words and figures are of the moment ``told``, if that is given. ``service`` is another program's
    service that gets a lane before its first call. The selection stands out and is described below the
    axis. The screen sets ``selection``, ``hint`` (the keys
    in the frame), ``keys``, ``path`` (the steps of a chain to mark) and ``changes`` (the user's changes of
    the run, in words).
    """

    DEFAULT_CSS = "Lanes { height: auto; }"

    timeline: reactive[Timeline] = painted(Timeline, always_update=True)
    window: reactive[Window] = painted(Window(0, 10_000_000_000))
    now: reactive[Nanoseconds] = painted(0)
    told: reactive[Nanoseconds | None] = painted(None)
    service: reactive[str] = reactive("", layout=True)
    charset: reactive[Charset] = reactive(Charset.BRAILLE, repaint=False)
    selection: reactive[Selection | None] = painted(None)
    whole: reactive[Nanoseconds] = painted(0)
    """The end of an overview that is always shown; 0 for one that is shown if there is room."""
    hint: reactive[str] = reactive("", repaint=False)
    path: reactive[Sequence[ChainStep]] = painted(())
    kept: reactive[Mapping[EntityId, int]] = painted(NONE_KEPT)
    """The callbacks whose lanes are the last to be hidden, with their ranks."""
    kept_thread: reactive[ThreadId | None] = painted(None)
    """The thread whose lane is among them; None for none."""
    threads_last = False
    """Whether threads, of which another run may have more, are below the callbacks."""
    changes: reactive[str] = painted("")
    keys: reactive[LaneKeys] = reactive(USUAL_KEYS, repaint=False)

    _painter = LanePainter(looks=INTERVALS_PER_FRAME)
    _picture: LanePicture | None = None
    _laid_out_for = 0
    _end: Nanoseconds = 0
    """The end of the run when the timeline was set; it may have grown before the picture is painted."""
    _goes_on = False

    class BarPicked(Message):
        """The user clicked at the moment ``at``; ``selection`` is the lane and bar there, if any."""

        def __init__(self, lanes: "Lanes", at: Nanoseconds, selection: Selection | None) -> None:
            super().__init__()
            self.lanes = lanes
            self.at = at
            self.selection = selection

        @property
        def control(self) -> "Lanes":
            """The lanes that were pointed at."""
            return self.lanes

    class WheelTurned(Message):
        """The user turned the wheel: ``steps`` > 0 asks for a longer window, < 0 for a shorter one."""

        def __init__(self, steps: int) -> None:
            super().__init__()
            self.steps = steps

    @property
    def picture(self) -> LanePicture | None:
        """The last picture; its lanes, scale and layout tell what a cell shows."""
        return self._picture

    # the selection

    def here(self) -> Selection | None:
        """Return the best first selection: a bar at the cursor, else one before it, else a lane."""
        lanes = [] if self._picture is None else self._picture.lanes
        found = [Selection(lane, bar_at(self.timeline, lane, self._cursor_column)) for lane in lanes]
        found += [self._last_on(lane) for lane in lanes]
        return next((each for each in found if each.bar is not None), found[0] if found else None)

    @property
    def selection_now(self) -> Selection | None:
        """The selection as it has become; of a lane alone, its last bar on screen up to the cursor."""
        selection = None if self.selection is None else self.selection.renewed(self.timeline)
        if selection is None or selection.bar is not None:
            return selection
        bar = neighbouring_bar(self.timeline, selection.lane, min(self.now + 1, self.timeline.end), -1)
        is_shown = bar is not None and (end_of(bar) or self.timeline.end) >= self.window.start
        return Selection(selection.lane, bar if is_shown else None)

    def lane_beside(self, step: int) -> Selection | None:
        """Return the lane above (``step`` < 0) or below the selected one, and its last bar."""
        lanes = all_lanes(self.timeline, self.service)
        if self.selection is None or self.selection.lane not in lanes:
            return self.here()
        place = lanes.index(self.selection.lane) + step
        return self._last_on(lanes[max(0, min(place, len(lanes) - 1))])

    def bar_beside(self, step: int) -> Selection | None:
        """Return the selected lane's next bar after the cursor (``step`` > 0) or the last before it.

        Without a selection the lane of the cursor's bar counts; if it has none, the nearest on screen.
        """
        selection = self.selection or self.here()
        found = None if selection is None else self._beside([selection.lane], step)
        if self.selection is None and self._picture is not None:
            found = found or self._beside(self._picture.lanes, step)
        return found

    def _beside(self, lanes: Sequence[Lane], step: int) -> Selection | None:
        bars = ((lane, neighbouring_bar(self.timeline, lane, self.now, step)) for lane in lanes)
        found = [(abs(start_of(bar) - self.now), Selection(lane, bar)) for lane, bar in bars if bar]
        return min(found, key=itemgetter(0), default=(0, None))[1]

    def _last_on(self, lane: Lane) -> Selection:
        if self._picture is None:
            return Selection(lane)
        shown = self._picture.scale.window
        return Selection(lane, bar_up_to(self.timeline, lane, self._cursor_column, shown))

    @property
    def _cursor_column(self) -> Window:
        """The column in which the cursor stands; at the very end, the last one with what begins then."""
        assert self._picture is not None
        length = self._picture.scale.per_column
        start = max(0, self.now - (self.now == self.timeline.end)) // length * length
        return Window(start, max(start + length, self.now + 1))

    def jump_targets(self) -> Iterator[JumpTarget]:
        """Yield each lane in view, then the bars on them that are wide enough for a letter and more."""
        picture = self._picture
        if picture is None:
            return
        rows = [(y, lane) for y, lane in enumerate(picture.lanes) if lane not in picture.lanes[:y]]
        for y, lane in rows:
            yield JumpTarget(Offset(0, y), self._picks(self._last_on(lane)))
        scale, shown = picture.scale, picture.scale.window
        for y, lane in rows:
            free = 0
            for bar in bars_in(self.timeline, lane, shown)[-_MOST_JUMPS:]:
                first = max(free, scale.column_of(start_of(bar)))
                end = min(end_of(bar) or self.timeline.end, shown.end)
                if scale.column_of(end) - first > _JUMP_WIDTH:
                    free = first + _JUMP_WIDTH
                    place = Offset(picture.layout.names + 1 + first, y)
                    yield JumpTarget(place, self._picks(Selection(lane, bar), start_of(bar)))

    def _picks(self, selection: Selection, at: Nanoseconds | None = None) -> Callable[[], object]:
        return lambda: self.post_message(self.BarPicked(self, self.now if at is None else at, selection))

    # the pointer

    def on_click(self, event: Click) -> None:
        """Report the moment and the bar under the pointer."""
        offset, picture = event.get_content_offset(self), self._picture
        if offset is None or picture is None or offset.y >= len(picture.rows):
            return
        on_overview = offset.y > len(picture.lanes)
        scale = picture.scale if picture.overview is None or not on_overview else picture.overview
        place = offset.x - picture.layout.names - 1
        lane = picture.lanes[offset.y] if offset.y < len(picture.lanes) else None
        if not 0 <= place < scale.columns:
            if lane is not None:
                self.post_message(self.BarPicked(self, self.now, self._last_on(lane)))
            return
        column = Window(max(0, scale.time_at(place)), max(0, scale.time_at(place + 1)))
        bar = None if lane is None else bar_at(self.timeline, lane, column)
        at = column.start if bar is None else max(column.start, start_of(bar))
        self.post_message(self.BarPicked(self, at, None if lane is None else Selection(lane, bar)))

    def on_mouse_scroll_up(self, event: MouseScrollUp) -> None:
        """Ask for a shorter window."""
        event.stop()
        self.post_message(self.WheelTurned(-1))

    def on_mouse_scroll_down(self, event: MouseScrollDown) -> None:
        """Ask for a longer window."""
        event.stop()
        self.post_message(self.WheelTurned(1))

    # drawing

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the lanes, and the details of the selected bar."""
        selection = self.selection_now
        described = self._rows_told(size) if selection is not None else 0
        height = size.height - described
        picture = self._painter.paint(
            self.timeline,
            self.window,
            self.now,
            size.width,
            height,
            selection,
            self.whole,
            self.path,
            self.told,
            self.kept,
            self.kept_thread,
            self._end,
        )
        self._picture = picture
        if not picture.complete:
            self._go_on_later()
        title = ["Lanes", picture.time_per_column, *([f"changed: {self.changes}"] if self.changes else [])]
        set_title(self, f" {GLYPHS[self.charset].between} ".join(title))
        if selection is None or not described:
            return picture.rows
        told = self.now if self.told is None else self.told
        details = details_of_selection(self.timeline, selection, told, self.keys)
        return [*picture.rows, *details_rows(details, size.width, self.charset)]

    def _go_on_later(self) -> None:
        """Paint the missing columns in the next frame, even if the run stands still."""
        if self.is_running and not self._goes_on:
            self._goes_on = True
            self.set_timer(_A_FRAME, self._go_on)

    def _go_on(self) -> None:
        self._goes_on = False
        self.changed()

    def _rows_told(self, size: Size) -> int:
        return ROWS if size.height >= ROWS + _LEAST_LANES and size.width > ROWS else 0

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Return the number of rows that show every lane and describe the selected bar."""
        self._laid_out_for = self._rows_of_lanes(width)
        return self._laid_out_for + (0 if self.selection is None else ROWS)

    @property
    def shows_everything(self) -> bool:
        """Whether more rows would show no more."""
        told = 0 if self.selection is None else ROWS
        return self.size.height >= self._rows_of_lanes(self.size.width) + told

    def _rows_of_lanes(self, width: int) -> int:
        return wanted_rows(self.timeline, self.service, width, self.window, self.whole)

    def watch_timeline(self) -> None:
        """Paint again, with another height if there are new lanes."""
        self._end = self.timeline.end
        # Hidden lanes are not laid out, so the layout is requested until it was done.
        if self._rows_of_lanes(self.size.width) != self._laid_out_for:
            self.refresh(layout=True)

    def watch_selection(self, before: Selection | None, after: Selection | None) -> None:
        """Highlight another bar, and make room for its description."""
        if (before is None) != (after is None):
            self.refresh(layout=True)

    def watch_whole(self, before: Nanoseconds, after: Nanoseconds) -> None:
        """Make room for the overview, which later only grows longer."""
        if (before > 0) != (after > 0):
            self.refresh(layout=True)

    def watch_hint(self) -> None:
        """Show another hint; the keys' signs are not markup."""
        set_subtitle(self, self.hint)

    def watch_service(self) -> None:
        """Give the service a lane."""
        self._begin_anew()

    def watch_keys(self) -> None:
        """Name other keys."""
        self._begin_anew()

    def watch_charset(self) -> None:
        """Paint in other glyphs."""
        self._begin_anew()

    def _begin_anew(self) -> None:
        """Start with another painter and an empty cache."""
        call, more = self.keys.call, self.keys.more
        self._painter = LanePainter(
            self.charset, self.service, INTERVALS_PER_FRAME, call, more, self.threads_last
        )
        self.changed()
