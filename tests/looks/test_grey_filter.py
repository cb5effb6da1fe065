"""Without colours every contrast is what it was."""

import pytest
from rich.segment import Segment
from rich.style import Style
from textual.color import Color
from textual.theme import Theme

from cbtui.looks.colour_themes import THEMES, palette_of
from cbtui.looks.contrast import contrast
from cbtui.looks.grey_filter import GreyFilter
from cbtui.looks.theme import Ink, Role, style_of
from tests.support.console import RecordedConsole


def in_greys(style: Style) -> Style:
    (segment,) = GreyFilter().apply([Segment("A", style)], Color(0, 0, 0))
    assert segment.style is not None
    return segment.style


@pytest.mark.parametrize("theme", THEMES, ids=lambda theme: theme.name)
@pytest.mark.parametrize("number", range(6))
def test_every_groups_letter_is_readable_in_greys(theme: Theme, number: int) -> None:
    palette, ground = palette_of(theme), theme.background or "#121212"
    style = in_greys(style_of(Ink(Role.LETTER, number), palette, ground))
    assert style.color
    assert style.bgcolor
    colour, behind = style.color.get_truecolor(), style.bgcolor.get_truecolor()
    assert len({*colour}) == len({*behind}) == 1
    assert contrast(colour, behind) >= palette.words


def test_the_terminals_own_colours_stay() -> None:
    assert in_greys(Style(color="default", bold=True)) == Style(color="default", bold=True)


@pytest.mark.parametrize("no_color", [True, False])
def test_a_console_is_grey_where_no_color_is_set(no_color: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1") if no_color else monkeypatch.delenv("NO_COLOR", raising=False)
    filters = RecordedConsole("shared-group", [], 1.0).get_line_filters()
    assert isinstance(filters[0], GreyFilter) is no_color
