"""Work in slices: the same result, however small they are, and no slice that grows with the run."""

import sys
from collections.abc import Sequence
from itertools import pairwise
from types import FrameType

import pytest
from msgspec.structs import replace

from sim.trace import incremental
from sim.trace.events import AnyEvent, WaitStarted
from sim.trace.figures.comparison import compare, compare_incrementally
from sim.trace.incremental import Incremental, collect, run_to_end, split
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.runs import shared_group_run, split_groups_run

EVENTS = shared_group_run().events


def later(event: AnyEvent, by: int) -> AnyEvent:
    """The same a while later."""
    moved = replace(event, t=event.t + by)
    return replace(moved, since=moved.since + by) if isinstance(moved, WaitStarted) else moved


def told(events: Sequence[AnyEvent], times: int = 1) -> Timeline:
    """A run in which the same happens again and again."""
    timeline = Timeline()
    length = events[-1].t + 1
    for number in range(times):
        timeline.extend([later(event, number * length) for event in events])
    return timeline


def dearest(work: Incremental[object]) -> int:
    """How many functions are called in the slice that calls most."""
    called = 0
    most = 0

    def count(_frame: FrameType, event: str, _what: object) -> None:
        nonlocal called
        called += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(count)
    try:
        for _ in work:
            called, most = 0, max(most, called)
    finally:
        sys.setprofile(before)
    return max(most, called)


def test_no_slice_of_a_comparison_grows_with_the_length_of_the_runs() -> None:
    costs = []
    for times in (1, 4):
        timeline = told(EVENTS, times)
        costs.append(dearest(compare_incrementally(timeline, timeline, Window(0, timeline.end))))
    assert costs[1] < 1.5 * costs[0]
    assert costs[1] < 60 * incremental.STEP_SIZE


@pytest.mark.parametrize("piece", [1, 7, 100])
def test_figures_are_the_same_however_small_the_slices(monkeypatch: pytest.MonkeyPatch, piece: int) -> None:
    first, second = told(EVENTS), told(split_groups_run().events)
    window = Window(1_500_000_000, 12_300_000_000)
    monkeypatch.setattr(incremental, "STEP_SIZE", 10**9)
    whole = compare(first, second, window)
    monkeypatch.setattr(incremental, "STEP_SIZE", piece)
    assert compare(first, second, window) == whole


def test_what_comes_in_between_plays_no_part() -> None:
    timeline = told([event for event in EVENTS if event.t <= 5_000_000_000])
    window = Window(0, 4_000_000_000)
    before = compare(timeline, timeline, window)
    work = compare_incrementally(timeline, timeline, window)
    next(work)
    timeline.extend([event for event in EVENTS if event.t > 5_000_000_000])
    after = run_to_end(work)
    assert after.callbacks == before.callbacks


@pytest.mark.parametrize(
    ("length", "things"), [(0, 0), (1, 5000), (10, 0), (10**9 + 1, 999), (10**9, 10_000)]
)
def test_parts_make_up_the_whole(length: int, things: int) -> None:
    found = list(split(Window(5, 5 + length), things))
    assert found[0].start == 5
    assert found[-1].end == 5 + length
    assert all(one.end == other.start for one, other in pairwise(found))


def test_a_list_is_the_whole_of_what_it_is_made_of() -> None:
    work = collect(range(3 * incremental.STEP_SIZE + 1))
    assert len(list(work)) == 3
    assert run_to_end(collect("abc")) == ["a", "b", "c"]
