"""Colours: readable on both backgrounds, and never the only code."""

from itertools import combinations

import pytest
from rich.color_triplet import ColorTriplet

from cbtui.theme import DARK, GLYPHS, LIGHT, Charset, Ink, Palette, Role, group_colour, style_of
from sim.trace.events import Reason


def luminance(colour: ColorTriplet) -> float:
    linear = [part / 3294.6 if part <= 10 else ((part / 255 + 0.055) / 1.055) ** 2.4 for part in colour]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: ColorTriplet, other: ColorTriplet) -> float:
    bright, dim = sorted((luminance(one), luminance(other)), reverse=True)
    return (bright + 0.05) / (dim + 0.05)


@pytest.mark.parametrize(("dark", "ground"), [(True, "#121212"), (False, "#e0e0e0")])
@pytest.mark.parametrize("role", [role for role in Role if role not in (Role.TRAIL, Role.LABEL)])
def test_every_ink_stands_out_from_the_background(role: Role, dark: bool, ground: str) -> None:
    style = style_of(Ink(role, 0), dark, ground)
    assert style.color is not None
    assert style.bgcolor is not None
    assert contrast(style.color.get_truecolor(), style.bgcolor.get_truecolor()) >= 3


@pytest.mark.parametrize("dark", [True, False])
@pytest.mark.parametrize("number", range(8))
def test_a_bars_label_is_readable_on_the_bar(number: int, dark: bool) -> None:
    style = style_of(Ink(Role.LABEL, number), dark, "#121212" if dark else "#e0e0e0")
    assert style.color is not None
    assert style.bgcolor is not None
    assert contrast(style.color.get_truecolor(), style.bgcolor.get_truecolor()) >= 4.5


@pytest.mark.parametrize("palette", [DARK, LIGHT])
def test_groups_beyond_the_palette_are_told_by_their_letter_alone(palette: Palette) -> None:
    many = len(palette.groups)
    assert group_colour(many, palette) == group_colour(many + 7, palette)
    assert group_colour(many, palette) not in palette.groups


def test_what_comes_after_the_cursor_is_fainter() -> None:
    ground = ColorTriplet(0x12, 0x12, 0x12)
    before, after = (style_of(Ink(Role.BAR, 1, later), True, "#121212").color for later in (False, True))
    assert before is not None
    assert after is not None
    assert contrast(after.get_truecolor(), ground) < contrast(before.get_truecolor(), ground)


def test_each_reason_has_a_texture_of_its_own() -> None:
    for glyphs in GLYPHS.values():
        assert set(glyphs.hatch) == set(Reason)
        assert all(one != other for one, other in combinations(glyphs.hatch.values(), 2))


def test_ascii_has_no_other_glyphs() -> None:
    glyphs = vars(GLYPHS[Charset.ASCII])
    texts = [
        text for value in glyphs.values() for text in (value.values() if isinstance(value, dict) else [value])
    ]
    assert all(text.isascii() for text in texts)
