"""Text as cells: strange text is shown and never obeyed, and widths add up."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.cells import cell_len

from cbtui.looks.theme import Charset, Ink, Role
from cbtui.text.cells import CellRow, fit, lines_of_text, to_cells, visible, without_tabs


def test_escape_sequences_become_pictures() -> None:
    assert visible("\x1b[2Jcallback\x07", Charset.BRAILLE) == "␛[2Jcallback␇"


def test_ascii_shows_nothing_but_ascii() -> None:
    assert visible("\x1b[2J rückruf 回", Charset.ASCII) == "?[2J ruckruf ??"
    assert visible("pick → /gripper", Charset.ASCII) == "pick > /gripper"


@given(st.text(), st.sampled_from(Charset))
def test_no_text_reaches_the_terminal_as_a_control(text: str, charset: Charset) -> None:
    assert visible(text, charset).isprintable()


@given(st.text(max_size=30), st.integers(0, 40), st.sampled_from(Charset))
def test_fitted_text_has_exactly_the_width(text: str, width: int, charset: Charset) -> None:
    assert cell_len(fit(text, width, charset)) == width


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("\tx", "        x"),
        ("abc\tx\ty", "abc     x       y"),
        ("12345678\tx", "12345678        x"),
        ("回\tx", "回      x"),
        ("first\n\tsecond", "first\n        second"),
        ("no tab", "no tab"),
    ],
)
def test_a_tab_goes_on_to_the_next_multiple_of_eight_columns(text: str, shown: str) -> None:
    assert without_tabs(text) == shown


def test_a_wide_character_takes_two_cells() -> None:
    assert to_cells("a回b", Charset.BRAILLE) == ("a", "回", "", "b")


def test_painting_over_half_a_wide_character_keeps_the_width() -> None:
    for column in (1, 2):
        row = CellRow(4, Charset.BRAILLE)
        row.write(0, "a回b", Ink(Role.TEXT))
        row.put(column, "x", Ink(Role.WARN))
        assert cell_len("".join(run.text for run in row.runs())) == 4


def test_a_row_is_given_as_runs_of_one_ink() -> None:
    row = CellRow(6, Charset.BRAILLE)
    row.write(1, "ab", Ink(Role.WARN))
    row.put(3, "c", Ink(Role.NOW))
    assert [run.text for run in row.runs()] == [" ", "ab", "c", "  "]


def test_text_that_does_not_fit_ends_in_an_ellipsis() -> None:
    row = CellRow(5, Charset.BRAILLE)
    row.write(2, "timer", Ink(Role.TEXT))
    assert "".join(row.cells) == "  ti…"


def test_no_word_is_left_alone_on_the_last_line() -> None:
    assert lines_of_text("the timer waits for the group", 24) == ["the timer waits for", "the group"]
    assert lines_of_text("expected nothing; saw deadlock, at 1.500 s", 40)[-1] == "1.500 s"
    assert lines_of_text("anextraordinarily longword", 20) == ["anextraordinarily", "longword"]
