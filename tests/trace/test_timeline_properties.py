"""Whatever legal run it is fed, the timeline answers like a naive search through the events."""

from collections.abc import Callable, Iterable
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from sim.trace.events import AnyEvent
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.trace.naive import Naive
from tests.trace.systems import GROUP_KINDS, GROUP_OF, THREADS, jumbled_runs, legal_runs

moments = st.integers(-2, 250)
windows = st.tuples(moments, moments).map(lambda pair: Window(*pair))


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
    assert moment.queues == {entity: naive.queue(entity, at) for entity in GROUP_OF}
    assert moment.holders == {group: naive.holders(group, at) for group in GROUP_KINDS}
    assert tuple(call.id for call in moment.pending_calls) == naive.pending(at)


def assert_same_window(timeline: Timeline, naive: Naive, window: Window) -> None:
    for thread in THREADS:
        assert timeline.spans_on(thread, window) == naive.spans_where(window, thread=thread)
        assert timeline.busy(thread, window) == naive.busy(thread, window)
    for entity in GROUP_OF:
        assert timeline.spans_of(entity, window) == naive.spans_where(window, entity=entity)
        assert timeline.waits_of(entity, window) == naive.waits_of(entity, window)
        assert timeline.drops_of(entity, window) == naive.drops(window, entity)
    for group in GROUP_KINDS:
        assert timeline.spans_in(group, window) == naive.spans_in(group, window)


@given(legal_runs(), moments)
def test_a_moment_is_what_the_events_up_to_it_make(events: list[AnyEvent], at: int) -> None:
    assert_same_moment(timeline_of(events), Naive(events), at)


@given(legal_runs(), windows)
def test_a_window_holds_the_intervals_that_share_time_with_it(events: list[AnyEvent], window: Window) -> None:
    assert_same_window(timeline_of(events), Naive(events), window)


@given(legal_runs(), moments)
def test_drops_count_from_the_beginning_of_the_run(events: list[AnyEvent], at: int) -> None:
    assert timeline_of(events).dropped(at) == Naive(events).drops(Window(-1, at + 1))


@given(legal_runs(), moments, st.sampled_from([None, *GROUP_OF]), st.sampled_from([1, -1]))
def test_a_neighbour_is_the_nearest_event_on_its_side(
    events: list[AnyEvent], at: int, entity: int | None, step: int
) -> None:
    assert timeline_of(events).neighbour(at, entity, step) == Naive(events).neighbour(at, entity, step)


@given(legal_runs(), moments)
def test_the_scan_seen_is_the_one_last_taken(events: list[AnyEvent], at: int) -> None:
    assert timeline_of(events).scan_seen(at) == Naive(events).scan_seen(at)


@given(legal_runs())
def test_the_outer_spans_of_a_thread_never_overlap(events: list[AnyEvent]) -> None:
    timeline = timeline_of(events)
    for thread in THREADS:
        spans = timeline.spans_on(thread, Window(0, timeline.end + 1))
        for outer, inner in pairwise(spans):
            ended = outer.end_at(timeline.end)
            assert ended <= inner.start or inner.end_at(timeline.end) <= ended


@given(legal_runs(), st.lists(st.integers(0, 200)), moments, windows)
def test_pieces_make_the_same_timeline_as_the_whole(
    events: list[AnyEvent], cuts: list[int], at: int, window: Window
) -> None:
    places = sorted({0, *(min(cut, len(events)) for cut in cuts), len(events)})
    pieces = timeline_of(*(events[start:end] for start, end in pairwise(places)))
    whole = timeline_of(events)
    for answer in everything(at, window):
        assert answer(pieces) == answer(whole)


@given(jumbled_runs(), moments, windows)
def test_threads_may_record_a_little_out_of_order(
    runs: tuple[list[AnyEvent], list[AnyEvent]], at: int, window: Window
) -> None:
    events, jumbled = runs
    timeline, naive = timeline_of(jumbled), Naive(events)
    assert_same_moment(timeline, naive, at)
    assert_same_window(timeline, naive, window)
    for answer in everything(at, window):
        assert answer(timeline) == answer(timeline_of(events))


def everything(at: int, window: Window) -> tuple[Callable[[Timeline], object], ...]:
    return (
        lambda timeline: timeline.end,
        lambda timeline: timeline.started,
        lambda timeline: (timeline.threads, timeline.nodes, timeline.groups, timeline.entities),
        lambda timeline: timeline.moment(at),
        lambda timeline: [timeline.spans_on(thread, window) for thread in THREADS],
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
        lambda timeline: [timeline.neighbour(at, None, step) for step in (1, -1)],
    )
