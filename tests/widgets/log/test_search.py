from collections.abc import Iterable

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from cbtui.widgets.log.filter import Filter, LogEvent, filter_of
from cbtui.widgets.log.line import line_of, width_of
from cbtui.widgets.log.search import LogSearch
from sim.trace.events import Logged, Printed, Severity
from sim.trace.timeline import Timeline


def line(at: int, text: str) -> Logged:
    return Logged(at, Severity.INFO, "n", text, 0, 0)


def timeline_of(lines: Iterable[LogEvent]) -> Timeline:
    timeline = Timeline()
    timeline.extend(lines)
    return timeline


def every_third(count: int) -> list[LogEvent]:
    return [line(number, "third" if number % 3 == 0 else "other") for number in range(count)]


def searched(timeline: Timeline, text: str) -> LogSearch:
    search = LogSearch(timeline, filter_of(text))
    while search.go_on(100):
        pass
    return search


def test_the_places_of_the_lines_that_are_let_through_are_found() -> None:
    assert list(searched(timeline_of(every_third(1000)), "third").places) == list(range(0, 1000, 3))


def test_a_step_looks_at_so_many_lines_and_tells_whether_there_are_more() -> None:
    search = LogSearch(timeline_of(every_third(10)), filter_of("third"))
    assert search.go_on(4)
    assert list(search.places) == [0, 3]
    assert search.go_on(4)
    assert not search.go_on(4)
    assert list(search.places) == [0, 3, 6, 9]


def test_only_new_lines_are_looked_at() -> None:
    looked_at: list[int] = []

    class Counting(Filter):
        def passes(self, event: LogEvent, timeline: Timeline) -> bool:
            looked_at.append(event.t)
            return False

    timeline = timeline_of(every_third(500))
    search = LogSearch(timeline, Counting(("x",)))
    while search.go_on(100):
        pass
    assert looked_at == list(range(500))
    timeline.extend([line(500, "third"), line(501, "other")])
    search.go_on(100)
    assert looked_at == list(range(502))


def test_without_a_filter_every_line_is_there_before_it_was_looked_at() -> None:
    search = LogSearch(timeline_of(every_third(500)), Filter())
    assert search.places == range(500)


def test_the_lines_up_to_a_place_are_counted() -> None:
    search = searched(timeline_of(every_third(30)), "third")
    assert [search.until(count) for count in (0, 1, 3, 4, 30)] == [0, 1, 1, 2, 10]


@given(st.text(st.characters(exclude_categories=()), max_size=20))
def test_the_width_of_a_line_is_that_of_what_is_shown_of_it(text: str) -> None:
    assert width_of(line(0, text)) == cell_len(line_of(line(0, text)))


def test_plain_lines_are_measured_without_going_through_their_characters(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("cbtui.widgets.log.line.visible", None)
    assert width_of(Printed(0, "x" * 4096, error=False)) == 4096


def test_a_late_line_is_noticed_among_lines_that_are_the_same() -> None:
    timeline = timeline_of([line(0, "first"), line(5, "third"), line(5, "third")])
    search = searched(timeline, "third")
    timeline.extend([line(1, "late")])
    search.go_on(100)
    assert list(search.places) == [2, 3]


@given(
    st.lists(st.integers(0, 400), max_size=12),
    st.integers(1, 150),
)
def test_lines_that_come_late_are_found_where_they_are(late: list[int], step: int) -> None:
    timeline = timeline_of(line(10 * number, f"{number} third") for number in range(0, 40, 3))
    search = LogSearch(timeline, filter_of("third"))
    for at in late:
        search.go_on(step)
        timeline.extend([line(at, "third, late" if at % 2 else "late")])
    while search.go_on(step):
        pass
    places = [place for place, event in enumerate(timeline.logs) if "third" in event.text]
    assert list(search.places) == places
