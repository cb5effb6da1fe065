"""Whatever legal run it is fed, the timeline answers like a naive search through the events."""

from collections.abc import Callable, Iterable
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from sim.trace import events as ev
from sim.trace.events import AnyEvent
from sim.trace.model import Blocked, Deed, Span, Window
from sim.trace.timeline import Timeline
from tests.trace.naive import Naive
from tests.trace.systems import GROUP_KINDS, GROUP_OF, THREADS, jumbled_runs, legal_runs

places = st.tuples(st.integers(0, 10_000), st.integers(-1, 1))
several = st.lists(places, min_size=6, max_size=6)


def times(events: list[AnyEvent], at: list[tuple[int, int]]) -> list[int]:
    """Times at which something happens, or just before or after."""
    return [events[place % len(events)].t + beside for place, beside in at]


def windows(events: list[AnyEvent], at: list[tuple[int, int]]) -> list[Window]:
    """Windows between such times, some of them empty or the wrong way round."""
    return [Window(start, end) for start, end in pairwise(times(events, at))]


def timeline_of(*batches: Iterable[AnyEvent]) -> Timeline:
    timeline = Timeline()
    for batch in batches:
        timeline.extend(batch)
    return timeline


def assert_same_moment(timeline: Timeline, naive: Naive, at: int) -> None:
    moment = timeline.moment(at)
    assert moment.at == at
    assert moment.running == naive.running(at)
    assert moment.waiting == naive.waiting(at)
    assert moment.blocked == naive.blocked(at)
    assert moment.queues == {entity: naive.queue(entity, at) for entity in GROUP_OF}
    assert moment.holders == {group: naive.holders(group, at) for group in GROUP_KINDS}
    assert tuple(call.id for call in moment.pending_calls) == naive.pending(at)


def assert_same_window(timeline: Timeline, naive: Naive, window: Window) -> None:
    for thread in THREADS:
        assert timeline.spans_on(thread, window) == naive.spans_where(window, thread=thread)
        assert timeline.blocks_on(thread, window) == naive.blocks_on(thread, window)
        assert timeline.busy(thread, window) == naive.busy(thread, window)
    for entity in GROUP_OF:
        assert timeline.spans_of(entity, window) == naive.spans_where(window, entity=entity)
        assert timeline.waits_of(entity, window) == naive.waits_of(entity, window)
        assert timeline.drops_of(entity, window) == naive.drops(window, entity)
    for group in GROUP_KINDS:
        assert timeline.spans_in(group, window) == naive.spans_in(group, window)


@given(legal_runs(), several)
def test_a_moment_is_what_the_events_up_to_it_make(events: list[AnyEvent], at: list[tuple[int, int]]) -> None:
    timeline, naive = timeline_of(events), Naive(events)
    for time in times(events, at):
        assert_same_moment(timeline, naive, time)
        assert timeline.dropped(time) == naive.drops(Window(-1, time + 1))
        assert timeline.scan_seen(time) == naive.scan_seen(time)


@given(legal_runs(), several)
def test_a_window_holds_the_intervals_that_share_time_with_it(
    events: list[AnyEvent], at: list[tuple[int, int]]
) -> None:
    timeline, naive = timeline_of(events), Naive(events)
    for window in windows(events, at):
        assert_same_window(timeline, naive, window)


@given(legal_runs(), several, st.sampled_from([1, -1]))
def test_a_neighbour_is_the_nearest_event_on_its_side(
    events: list[AnyEvent], at: list[tuple[int, int]], step: int
) -> None:
    timeline, naive = timeline_of(events), Naive(events)
    for time in times(events, at):
        assert timeline.neighbour(time, step) == naive.neighbour(time, step)


@given(legal_runs())
def test_the_outer_spans_of_a_thread_never_overlap(events: list[AnyEvent]) -> None:
    timeline = timeline_of(events)
    for thread in THREADS:
        spans = timeline.spans_on(thread, Window(0, timeline.end + 1))
        for outer, inner in pairwise(spans):
            ended = outer.end_at(timeline.end)
            assert ended <= inner.start or inner.end_at(timeline.end) <= ended


@given(legal_runs(), st.lists(st.integers(0, 200)), several)
def test_pieces_make_the_same_timeline_as_the_whole(
    events: list[AnyEvent], cuts: list[int], at: list[tuple[int, int]]
) -> None:
    edges = sorted({0, *(min(cut, len(events)) for cut in cuts), len(events)})
    pieces = timeline_of(*(events[start:end] for start, end in pairwise(edges)))
    assert_same_answers(pieces, timeline_of(events), events, at)


@given(jumbled_runs(), several)
def test_threads_may_record_a_little_out_of_order(
    runs: tuple[list[AnyEvent], list[AnyEvent]], at: list[tuple[int, int]]
) -> None:
    events, jumbled = runs
    timeline, naive = timeline_of(jumbled), Naive(events)
    for time, window in zip(times(events, at), windows(events, at), strict=False):
        assert_same_moment(timeline, naive, time)
        assert_same_window(timeline, naive, window)
    assert_same_answers(timeline, timeline_of(events), events, at)


def assert_same_answers(
    one: Timeline, other: Timeline, events: list[AnyEvent], at: list[tuple[int, int]]
) -> None:
    for time, window in zip(times(events, at), windows(events, at), strict=False):
        for answer in everything(time, window):
            assert answer(one) == answer(other)


def everything(at: int, window: Window) -> tuple[Callable[[Timeline], object], ...]:
    return (
        lambda timeline: timeline.end,
        lambda timeline: timeline.started,
        lambda timeline: (timeline.threads, timeline.nodes, timeline.groups, timeline.entities),
        lambda timeline: timeline.moment(at),
        lambda timeline: [timeline.spans_on(thread, window) for thread in THREADS],
        lambda timeline: [timeline.blocks_on(thread, window) for thread in THREADS],
        lambda timeline: [timeline.busy(thread, window) for thread in THREADS],
        lambda timeline: [timeline.spans_in(group, window) for group in GROUP_KINDS],
        lambda timeline: [timeline.calls_of(entity, window) for entity in GROUP_OF],
        lambda timeline: [timeline.waits_of(entity, window) for entity in GROUP_OF],
        lambda timeline: timeline.dropped(at),
        lambda timeline: timeline.marks(window),
        lambda timeline: timeline.calls,
        lambda timeline: (timeline.logs, timeline.logs_until(at)),
        lambda timeline: (timeline.robot(at), timeline.trail(window)),
        lambda timeline: (timeline.scan(at), timeline.scan_seen(at)),
        lambda timeline: [timeline.neighbour(at, step) for step in (1, -1)],
    )


DEEDS = {
    ev.CallbackStarted: Deed.BEGUN,
    ev.CallbackResumed: Deed.RESUMED,
    ev.CallbackSuspended: Deed.SUSPENDED,
    ev.CallbackEnded: Deed.ENDED,
    ev.CallBlocked: Deed.BLOCKED,
    ev.CallUnblocked: Deed.UNBLOCKED,
    ev.MessageDropped: Deed.LOST,
}


@given(legal_runs(), several)
def test_decisions_are_in_the_order_of_the_trace(events: list[AnyEvent], at: list[tuple[int, int]]) -> None:
    timeline = timeline_of(events)
    for window in windows(events, at):
        made = [
            (deed, what.thread if isinstance(what, Span | Blocked) else what)
            for deed, what in timeline.decisions(window)
        ]
        assert made == [
            (
                DEEDS[type(event)],
                getattr(event, "entity" if isinstance(event, ev.MessageDropped) else "thread"),
            )
            for event in events
            if type(event) in DEEDS and window.start <= event.t < window.end
        ]
