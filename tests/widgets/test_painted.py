"""Which part of a painted row is sent to the terminal again, and what is not done to it on its way."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from textual.filter import ANSIToTruecolor
from textual.geometry import Region

from cbtui.looks.theme import Ink, Role, TextRun
from cbtui.widgets.painted_widget import PaintedWidget, changed_part
from tests.support.console import WIDE, RecordedConsole, settle
from tests.support.runs import shared_group_run

TEXT, WARN = Ink(Role.TEXT), Ink(Role.WARN)


def test_a_row_that_is_as_it_was_is_not_sent() -> None:
    assert changed_part([TextRun("abc", TEXT)], [TextRun("abc", TEXT)]) == (0, 0)


def test_only_the_runs_between_equal_ones_are_sent() -> None:
    before = [TextRun("pose ", TEXT), TextRun("1.0", WARN), TextRun(" m", TEXT)]
    after = [TextRun("pose ", TEXT), TextRun("2.5", WARN), TextRun(" m", TEXT)]
    assert changed_part(before, after) == (5, 8)


def test_another_ink_is_a_change() -> None:
    assert changed_part([TextRun("abc", TEXT)], [TextRun("abc", WARN)]) == (0, 3)


def test_columns_are_counted_and_not_characters() -> None:
    before, after = [TextRun("日本", TEXT), TextRun("a", WARN)], [TextRun("日本", TEXT), TextRun("b", WARN)]
    assert changed_part(before, after) == (4, 5)


rows = st.lists(
    st.tuples(st.sampled_from("ab "), st.integers(1, 3), st.sampled_from([TEXT, WARN])),
    min_size=1,
    max_size=6,
)


def cells(row: list[TextRun]) -> list[tuple[str, Ink]]:
    return [(sign, run.ink) for run in row for sign in run.text]


@given(rows, rows)
def test_what_is_not_sent_is_as_it_was(
    one: list[tuple[str, int, Ink]], other: list[tuple[str, int, Ink]]
) -> None:
    before, after = ([TextRun(sign * length, ink) for sign, length, ink in row] for row in (one, other))
    short = len(cells(after)) - len(cells(before))
    (before if short > 0 else after).append(TextRun("." * abs(short), TEXT))
    start, end = changed_part(before, after)
    old, new = cells(before), cells(after)
    assert old[:start] + new[start:end] + old[max(start, end) :] == new


async def test_no_colour_of_a_painted_row_has_to_be_converted(monkeypatch: pytest.MonkeyPatch) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 6.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        painted = list(app.lesson_screen.query(PaintedWidget))
        assert any(isinstance(each, ANSIToTruecolor) for each in app.get_line_filters())
        monkeypatch.setattr(ANSIToTruecolor, "apply", lambda *_: pytest.fail("a row was converted"))
        for widget in painted:
            top = widget.gutter.top
            for line in widget.render_lines(Region(0, top, widget.outer_size.width, widget.size.height)):
                colours = [each for _, style, _ in line if style for each in (style.color, style.bgcolor)]
                assert all(colour is None or colour.triplet for colour in colours)
