"""The selected lane and bar, and the way to neighbouring ones."""

from dataclasses import dataclass, replace
from typing import TypeAlias

from cbtui.widgets.lanes.rows import GroupLane, Lane, MemberLane, ServiceLane, SoleLane, ThreadLane
from sim.trace.events import EntityId
from sim.trace.model import Call, Nanoseconds, Span, Wait, Window
from sim.trace.timeline import Timeline

Bar: TypeAlias = Span | Wait | Call
"""Something that can be selected on lanes: a call or wait of a callback, or a service call."""

_FIRST_REACH: Nanoseconds = 1_000_000
_REACH_GROWS = 4


@dataclass(frozen=True, slots=True)
class Selection:
    """A lane, and a bar on it; None if no bar is selected."""

    lane: Lane
    bar: Bar | None = None

    @property
    def entity(self) -> EntityId | None:
        """The selected callback; None for a thread or a group without a bar."""
        match self:
            case Selection(bar=Span() | Wait() as bar):
                return bar.entity
            case Selection(lane=MemberLane(entity) | SoleLane(entity)):
                return entity.id
        return None

    def renewed(self, timeline: Timeline) -> "Selection":
        """Return the selection with the timeline's current values: an open interval may have ended."""
        if self.bar is None:
            return self
        start = start_of(self.bar)
        found = bars_in(timeline, self.lane, Window(start, start + 1))
        return replace(self, bar=next((bar for bar in found if _same(bar, self.bar)), None))


def start_of(bar: Bar) -> Nanoseconds:
    """Return when a bar begins; a service call begins when it is sent."""
    return bar.sent if isinstance(bar, Call) else bar.start


def end_of(bar: Bar) -> Nanoseconds | None:
    """Return when a bar ends, None while it is open; a service call ends when its reply comes."""
    return bar.replied if isinstance(bar, Call) else bar.end


def bars_in(timeline: Timeline, lane: Lane, window: Window) -> list[Bar]:
    """Return the bars of a lane in a window, in order of start."""
    match lane:
        case ThreadLane(thread):
            return [*timeline.spans_on(thread.id, window)]
        case GroupLane(group):
            return [*timeline.spans_in(group.id, window)]
        case MemberLane(entity) | SoleLane(entity):
            both: list[Bar] = [*timeline.waits_of(entity.id, window), *timeline.spans_of(entity.id, window)]
            return sorted(both, key=start_of)
        case ServiceLane(service):
            near = timeline.calls_within(Window(window.start - 1, window.end))
            return [call for call in near if call.service == service and _lies_in(call, window)]


def bar_at(timeline: Timeline, lane: Lane, column: Window) -> Bar | None:
    """Return the bar with the largest share of a column; of equal ones the later."""
    found = bars_in(timeline, lane, column)
    return max(found, key=lambda bar: (_share(bar, column), start_of(bar)), default=None)


def bar_up_to(timeline: Timeline, lane: Lane, column: Window, shown: Window) -> Bar | None:
    """Return a column's bar, or else the lane's last bar before it."""
    before = bars_in(timeline, lane, Window(shown.start, max(shown.start, column.start)))
    return bar_at(timeline, lane, column) or (before[-1] if before else None)


def neighbouring_bar(timeline: Timeline, lane: Lane, at: Nanoseconds, step: int) -> Bar | None:
    """Return the lane's next bar that begins after ``at`` (``step`` > 0), or the last that does before."""
    reach = _FIRST_REACH
    while True:
        window = Window(at + 1, at + 1 + reach) if step > 0 else Window(max(0, at - reach), at)
        inside = (
            bar for bar in bars_in(timeline, lane, window) if window.start <= start_of(bar) < window.end
        )
        found = list(inside)
        if found:
            return found[0] if step > 0 else found[-1]
        if window.start == 0 or window.end > timeline.end:
            return None
        reach *= _REACH_GROWS


def _same(one: Bar, other: Bar) -> bool:
    match one, other:
        case Span(), Span():
            return (one.start, one.entity, one.thread) == (other.start, other.entity, other.thread)
        case Wait(), Wait():
            return (one.start, one.entity) == (other.start, other.entity)
        case Call(), Call():
            return one.id == other.id
    return False


def _lies_in(call: Call, window: Window) -> bool:
    return call.sent < window.end and (call.replied is None or call.replied >= window.start)


def _share(bar: Bar, column: Window) -> Nanoseconds:
    end = end_of(bar)
    return (column.end if end is None else min(end, column.end)) - max(start_of(bar), column.start)
