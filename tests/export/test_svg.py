"""The picture for paper: well-formed, with every lane, and no larger than what can be seen."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.export.bars import ticks
from sim.export.svg import svg
from sim.trace.events import AnyEvent, Reason
from sim.trace.figures.chains import ChainStep, StepKind
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.export.examples import small_run, timeline_of
from tests.support.runs import Run, ns, shared_group_run
from tests.trace.systems import legal_runs

SPACE = "{http://www.w3.org/2000/svg}"


def drawn(timeline: Timeline, start: float, end: float, width: int = 1100) -> ElementTree.Element:
    return ElementTree.fromstring(svg(timeline, Window(ns(start), ns(end)), width))


def texts(picture: ElementTree.Element) -> list[str]:
    return [element.text or "" for element in picture.iter(f"{SPACE}text")]


def bars(picture: ElementTree.Element, fill: str) -> Iterator[ElementTree.Element]:
    return (each for each in picture.iter(f"{SPACE}rect") if str(each.get("fill")).startswith(f"url(#{fill}"))


def test_every_thread_group_and_callback_has_its_lane() -> None:
    labels = texts(drawn(timeline_of(small_run()), 0, 2.5))
    for label in ("MainThread", "ThreadPoolExecutor-0_0", "A exclusive /sub_node", "odom_callback", "later"):
        assert label in labels


def test_a_wait_is_hatched_by_its_reason_and_says_why() -> None:
    picture = drawn(timeline_of(shared_group_run().events), 2, 12)
    assert "waits 20.0 s: group A held by timer_callback" in texts(picture)
    assert len(list(bars(picture, "group-held"))) > 2
    assert len(list(bars(picture, Reason.NOBODY_SPINS.value.replace(" ", "-")))) == 1


def test_a_bar_lies_where_its_call_does() -> None:
    run = Run()
    main = run.thread("MainThread")
    tick = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.callback(tick, main, 1.0, 1.0)
    run.over(4.0)
    picture = drawn(timeline_of(run.events), 0, 4, width=1000)
    call = next(bars(picture, "group-0"))
    left, right = 224, 986
    assert float(str(call.get("x"))) == pytest.approx(left + (right - left) / 4, abs=0.01)
    assert float(str(call.get("width"))) == pytest.approx((right - left) / 4, abs=0.01)
    assert "A tick" in texts(picture)


def test_the_axis_is_in_seconds_and_the_legend_explains_every_sign() -> None:
    labels = texts(drawn(timeline_of(small_run()), 0, 2.5))
    assert {"0.0", "0.5", "1.0", "s"} <= {*labels}
    assert {f"waits: {reason.value}" for reason in Reason} <= {*labels}
    assert {"message lost", "raised an exception", "A MutuallyExclusiveCallbackGroup"} <= {*labels}


def test_losses_and_errors_are_marked() -> None:
    picture = drawn(timeline_of(small_run()), 0, 2.5)
    titles = [element.text for element in picture.iter(f"{SPACE}title")]
    assert "1 lost" in titles
    assert texts(picture).count("✗") == 4


def test_a_learners_texts_cannot_break_out() -> None:
    text = svg(timeline_of(small_run()), Window(0, ns(2.5)))
    assert "<b>" not in text
    assert "\x1b" not in text


@given(legal_runs(), st.integers(0, 50), st.integers(1, 100))
def test_any_window_of_any_run_can_be_drawn(events: list[AnyEvent], start: int, length: int) -> None:
    ElementTree.fromstring(svg(timeline_of(events), Window(start, start + length)))


def test_a_picture_of_many_calls_stays_small() -> None:
    run = Run()
    main = run.thread("MainThread")
    tick = run.timer(run.exclusive(run.node("/n")), "tick", 0.001)
    for number in range(20_000):
        run.callback(tick, main, number / 1000, 0.0004)
    assert len(list(drawn(timeline_of(run.events), 0, 20).iter())) < 8000


@pytest.mark.parametrize(("end", "width"), [(0.0, 1100), (1.0, 100), (1.0, 1_000_000)])
def test_no_picture_without_length_or_of_a_silly_size(end: float, width: int) -> None:
    with pytest.raises(ValueError, match="picture"):
        drawn(timeline_of(small_run()), 0, end, width)


@given(st.integers(0, 10**13), st.integers(1, 10**13), st.integers(2, 20))
def test_ticks_are_round_even_and_few(start: int, length: int, most: int) -> None:
    found = ticks(Window(start, start + length), most)
    assert len(found) <= most + 1
    assert all(start <= t <= start + length for t in found)
    assert len({after - before for before, after in pairwise(found)}) <= 1


def test_the_critical_path_of_a_chain_is_framed() -> None:
    timeline = timeline_of(shared_group_run().events)
    entity = next(each for each in timeline.entities.values() if each.callback)
    inside = ChainStep(StepKind.WAITS, "scan", ns(3), ns(4), "no free worker", entity.id)
    outside = ChainStep(StepKind.RUNS, "scan", ns(20), ns(21), "", entity.id)
    picture = ElementTree.fromstring(svg(timeline, Window(ns(2), ns(12)), path=[inside, outside]))
    framed = [each for each in picture.iter(f"{SPACE}rect") if each.get("fill") == "none"]
    assert [each.findtext(f"{SPACE}title") for each in framed] == ["1.0 s: scan waits, no free worker", ""]
    assert "critical path of a chain" in texts(picture)
    assert "critical path of a chain" not in texts(drawn(timeline, 2, 12))
