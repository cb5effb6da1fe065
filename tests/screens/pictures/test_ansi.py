"""Screens as text with colours: small, and nothing to be seen is lost."""

from hypothesis import given
from hypothesis import strategies as st
from rich.segment import Segment
from rich.style import Style
from rich.text import Text

from tests.support.ansi import PLAIN, Look, line_of, look_of

SEEN_ON_BLANKS = {"underline", "reverse", "strike"}

colours = st.sampled_from([None, "#102030", "#ffffff", "default"])
switches = st.sampled_from([None, True])
styles = st.builds(Style, color=colours, bgcolor=colours, bold=switches, dim=switches, reverse=switches)
segments = st.builds(Segment, st.sampled_from(["a", "│ b", "  ", " "]), st.one_of(st.none(), styles))


def cells(characters: list[tuple[str, Look]]) -> list[tuple[str, Look]]:
    """What is seen in each column: of blanks the paper, and what is drawn through them."""
    return [
        (text, look)
        if text != " " or look.attributes & SEEN_ON_BLANKS
        else (text, Look(frozenset(), (), look.paper))
        for text, look in characters
    ]


@given(st.lists(segments, max_size=8))
def test_a_terminal_shows_what_was_drawn(line: list[Segment]) -> None:
    drawn = [(character, look_of(segment.style)) for segment in line for character in segment.text]
    shown = Text.from_ansi(line_of(line))
    styles = [Style() for _ in shown.plain]
    for start, end, style in shown.spans:
        assert isinstance(style, Style)
        for column in range(start, end):
            styles[column] += style
    assert cells(list(zip(shown.plain, map(look_of, styles), strict=True))) == cells(drawn)


def test_a_line_that_ends_in_a_colour_ends_plain() -> None:
    assert line_of([Segment("a", Style(color="#102030"))]) == "\x1b[38;2;16;32;48ma\x1b[0m"


def test_a_style_is_told_once_for_neighbours_and_not_for_the_ink_of_blanks() -> None:
    red, blue = Style(color="#ff0000"), Style(color="#0000ff")
    line = [Segment("a", red), Segment("  ", blue), Segment("b", red)]
    assert line_of(line) == "\x1b[38;2;255;0;0ma  b\x1b[0m"
    assert look_of(None) == PLAIN
