"""The table of a comparison as text: sections below each other, in columns where there is room."""

import pytest

from cbtui.looks.theme import Charset, Role
from cbtui.widgets.comparison_painter import BLOCK, StyledLine, headings, table
from sim.trace.figures.comparison_rows import Assessment, ComparisonRow, Section

CALLBACKS = tuple(
    Section(
        f"{name}_callback",
        (
            ComparisonRow("calls", ("79", "399"), "320 more"),
            ComparisonRow("lost", ("310", "0"), "310 fewer", Assessment.BETTER),
            ComparisonRow(
                "wait med/max", ("100 ms / 16.0 s", "0 s / 0 s"), "max 16.0 s shorter", Assessment.BETTER
            ),
        ),
        ("run A waits: group A held by timer_callback",),
    )
    for name in ("odom", "scan")
)
WHOLE = Section(
    "whole program",
    (ComparisonRow("heading", ("-60°", "30°"), "+90° left"), ComparisonRow("at once", ("1", "1"), "same")),
)
SECTIONS = (*CALLBACKS, WHOLE)


def text(lines: list[StyledLine]) -> list[str]:
    return ["".join(run.text for run in line).rstrip() for line in lines]


def test_a_narrow_table_is_one_column_of_sections() -> None:
    assert text(table(SECTIONS, 79, Charset.BRAILLE)) == [
        "odom_callback",
        " calls            79              399             320 more",
        " lost             310             0               310 fewer",
        " wait med/max     100 ms / 16.0 s 0 s / 0 s       max 16.0 s shorter",
        " run A waits: group A held by timer_callback",
        "",
        "scan_callback",
        " calls            79              399             320 more",
        " lost             310             0               310 fewer",
        " wait med/max     100 ms / 16.0 s 0 s / 0 s       max 16.0 s shorter",
        " run A waits: group A held by timer_callback",
        "",
        "whole program",
        " heading          -60°            30°             +90° left",
        " at once          1               1               same",
    ]
    assert text([headings(79, Charset.BRAILLE)]) == [
        "                  run A           run B           B against A"
    ]


def test_a_wide_table_shares_whole_sections_out_over_columns() -> None:
    width = 2 * BLOCK + 1
    lines = text(table(SECTIONS, width, Charset.BRAILLE))
    heads = [(line[:14].rstrip(), line[BLOCK + 1 :][:14].rstrip()) for line in lines]
    assert [head for head in heads if "calls" not in head[1] and head[1][:1] not in ("", " ")] == [
        ("odom_callback", "scan_callback"),
        ("", "whole program"),
    ]
    assert len(lines) == 9
    assert text([headings(width, Charset.BRAILLE)])[0].count("B against A") == 2


@pytest.mark.parametrize("width", [1, 20, BLOCK, 79, 2 * BLOCK, 2 * BLOCK + 1, 139, 250])
@pytest.mark.parametrize("charset", Charset)
def test_every_line_has_exactly_the_width(width: int, charset: Charset) -> None:
    lines = [*table(SECTIONS, width, charset), headings(width, charset)]
    assert {sum(len(run.text) for run in line) for line in lines} == {width}


def test_an_ascii_table_is_ascii() -> None:
    lines = text(table(SECTIONS, 79, Charset.ASCII))
    assert all(line.isascii() for line in lines)
    assert " heading          -60 deg         30 deg          +90 deg left" in lines


def test_what_is_worse_is_in_another_ink_beside_its_sign_and_word() -> None:
    worse = Section("scan", (ComparisonRow("lost", ("0", "3"), "3 more", Assessment.WORSE),))
    (_, row) = table((worse,), BLOCK, Charset.BRAILLE)
    assert [run.ink.role for run in row if "3 more" in run.text] == [Role.WARN]
