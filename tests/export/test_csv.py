"""The table of calls: what is read back are the timeline's spans."""

import csv
from collections.abc import Sequence
from io import StringIO

import pytest
from hypothesis import given

from sim.export.csv import CallTable
from sim.export.texts import cell, seconds
from sim.trace.events import AnyEvent
from sim.trace.model import Span, Window
from sim.trace.timeline import Timeline
from tests.export.examples import NASTY, small_run, timeline_of
from tests.support.runs import Run
from tests.trace.systems import legal_runs


def table(events: Sequence[AnyEvent]) -> list[dict[str, str]]:
    file = StringIO(newline="")
    calls = CallTable(file)
    for start in range(0, len(events), 5):
        calls.take(events[start : start + 5])
    calls.finish()
    file.seek(0)
    return list(csv.DictReader(file))


def row_of(span: Span, timeline: Timeline) -> dict[str, str]:
    entity = timeline.entities[span.entity]
    return {
        "start_s": seconds(span.start),
        "end_s": "" if span.end is None else seconds(span.end),
        "duration_s": "" if span.end is None else seconds(span.end - span.start),
        "callback": cell(entity.spoken_name),
        "kind": entity.kind.value,
        "entity": entity.name,
        "group": timeline.groups[entity.group].letter,
        "thread": timeline.threads[span.thread].name,
        "age_s": seconds(span.age),
        "error": span.error,
    }


def spans_of(timeline: Timeline) -> list[Span]:
    whole = Window(0, timeline.end + 1)
    return [span for thread in timeline.threads for span in timeline.spans_on(thread, whole)]


def assert_spans(events: Sequence[AnyEvent]) -> None:
    timeline = timeline_of(events)
    expected = [row_of(span, timeline) for span in spans_of(timeline)]
    read = [{name: each[name] for name in each if name != "wait_s"} for each in table(events)]
    assert sorted(read, key=str) == sorted(expected, key=str)


def test_the_table_read_back_is_the_spans() -> None:
    assert_spans(small_run())


@given(legal_runs())
def test_so_it_is_for_whatever_run(events: list[AnyEvent]) -> None:
    assert_spans(events)


def test_lines_stand_in_order_of_their_end_and_calls_without_one_come_last() -> None:
    ends = [float(row["end_s"] or "inf") for row in table(small_run())]
    assert ends == sorted(ends)
    assert ends[-1] == float("inf")


def test_a_call_tells_how_long_its_callback_had_been_ready() -> None:
    waits = {(row["callback"], row["start_s"]): row["wait_s"] for row in table(small_run())}
    assert waits["odom_callback", "1.500000000"] == "0.900000000"
    assert waits["timer_callback", "1.600000000"] == "0.100000000"
    assert waits["odom_callback", "0.250000000"] == "0.000000000"


def test_lines_end_as_rfc_4180_says() -> None:
    file = StringIO(newline="")
    calls = CallTable(file)
    calls.take(small_run())
    calls.finish()
    assert file.getvalue().count("\r\n") == len(file.getvalue().splitlines()) == len(table(small_run())) + 1


@pytest.mark.parametrize("text", [NASTY, "=1+1", "+1", "-1", "@a", "\t=1", "  =1", "\r=1"])
def test_no_cell_is_a_formula(text: str) -> None:
    assert cell(text).startswith("'")


@pytest.mark.parametrize("text", ["odom_callback", "/odom", "a=b", ""])
def test_plain_cells_stay_as_they_are(text: str) -> None:
    assert cell(text) == text


@pytest.mark.parametrize(
    ("time", "text"), [(0, "0.000000000"), (12_480_000_001, "12.480000001"), (-5, "-0.000000005")]
)
def test_times_are_exact(time: int, text: str) -> None:
    assert seconds(time) == text


def test_suspended_calls_of_one_callback_go_on_in_the_order_of_their_suspension() -> None:
    run = Run()
    main = run.thread("MainThread")
    later = run.timer(run.reentrant(run.node("/n")), "later", 1.0)
    for at, late in ((1.0, 0.1), (2.0, 0.2)):
        run.start(later, main, at, late)
        run.suspend(later, main, at + 0.5)
    for at in (3.0, 4.0):
        run.resume(later, main, at)
        run.end(later, main, at + 0.5)
    assert [row["age_s"][:3] for row in table(run.events)] == ["0.1", "0.2", "0.1", "0.2"]
