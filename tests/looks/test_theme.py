"""Colours: readable on both backgrounds, and never the only code."""

import subprocess
import sys
from itertools import combinations, pairwise

import pytest
from rich.color import Color
from rich.color_triplet import ColorTriplet
from rich.style import Style

from cbtui.looks.contrast import BLACK, WHITE, contrast, legible
from cbtui.looks.palettes import DARK, HIGH_CONTRAST, HIGH_CONTRAST_LIGHT, LIGHT, Palette
from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, group_colour, style_of, texture_of
from sim.trace.events import Reason

PALETTES = [DARK, LIGHT, HIGH_CONTRAST, HIGH_CONTRAST_LIGHT]
GROUNDS = {
    name: (palette, ground)
    for name, palette, ground in (
        ("dark", DARK, "#121212"),
        ("dark panel", DARK, "#242f38"),
        ("light", LIGHT, "#ffffff"),
        ("light panel", LIGHT, "#e9ecef"),
        ("Textual's light", LIGHT, "#d0d0d0"),
        ("high contrast", HIGH_CONTRAST, "#000000"),
        ("high contrast panel", HIGH_CONTRAST, "#1a1a1a"),
        ("high contrast, light", HIGH_CONTRAST_LIGHT, "#ffffff"),
        ("high contrast, light panel", HIGH_CONTRAST_LIGHT, "#ededed"),
    )
}
GROUND = pytest.mark.parametrize(("palette", "ground"), GROUNDS.values(), ids=GROUNDS)
DRAWN = {Role.BAR, Role.WALL, Role.SPHERE, Role.ROBOT, Role.TRUE_SCAN, Role.SEEN_SCAN}


def contrast_in(style: Style) -> float:
    assert style.color is not None
    assert style.bgcolor is not None
    return contrast(style.color.get_truecolor(), style.bgcolor.get_truecolor())


@GROUND
@pytest.mark.parametrize(
    "role", [role for role in Role if role not in (Role.TRAIL, Role.LABEL, Role.TEXTURE)]
)
def test_every_ink_stands_out_from_the_background(role: Role, palette: Palette, ground: str) -> None:
    least = palette.shapes if role in DRAWN else palette.words
    for number in range(8):
        assert contrast_in(style_of(Ink(role, number), palette, ground)) >= least
        assert contrast_in(style_of(Ink(role, number, selected=True), palette, ground)) >= least


@GROUND
@pytest.mark.parametrize("role", [Role.TEXT, Role.FAINT, Role.WARN, Role.HATCH, Role.LINE, Role.LETTER])
def test_words_after_the_cursor_are_fainter_and_can_be_read(
    role: Role, palette: Palette, ground: str
) -> None:
    before, after = (contrast_in(style_of(Ink(role, 1, later), palette, ground)) for later in (False, True))
    assert palette.words * 2 / 3 <= after < before


@GROUND
@pytest.mark.parametrize("number", range(8))
def test_a_bars_label_is_readable_on_the_bar(number: int, palette: Palette, ground: str) -> None:
    for later in (False, True):
        assert contrast_in(style_of(Ink(Role.LABEL, number, later), palette, ground)) >= 4.5


@GROUND
@pytest.mark.parametrize("number", range(8))
def test_a_texture_is_seen_on_its_bar_and_is_quieter_than_a_label(
    number: int, palette: Palette, ground: str
) -> None:
    texture, label, bar = (
        style_of(Ink(role, number), palette, ground) for role in (Role.TEXTURE, Role.LABEL, Role.BAR)
    )
    assert texture.bgcolor == label.bgcolor == bar.color
    assert palette.textures <= contrast_in(texture) < contrast_in(label)


@pytest.mark.parametrize("charset", Charset)
def test_neighbouring_groups_are_filled_with_other_textures(charset: Charset) -> None:
    """Letters apart, nothing but the texture tells them apart without colours."""
    glyphs = GLYPHS[charset]
    filled = [texture_of(number, glyphs).text for number in range(12)]
    assert len(set(filled[:6])) == 6
    assert all(one != other for one, other in pairwise(filled))
    meant_otherwise = {*glyphs.hatch.values(), glyphs.blocked, glyphs.lost, glyphs.cross, glyphs.cursor}
    assert not meant_otherwise & set(filled)


@pytest.mark.parametrize("palette", PALETTES)
def test_a_palettes_own_colours_need_no_mending_on_its_background(palette: Palette) -> None:
    backgrounds = {DARK: "#121212", HIGH_CONTRAST: "#000000"}
    ground = Color.parse(backgrounds.get(palette, "#ffffff"))
    for name, colour in vars(palette).items():
        if isinstance(colour, str):
            least = palette.words if name in {"text", "faint", "warn", "mark", "now"} else palette.shapes
            assert contrast(Color.parse(colour).get_truecolor(), ground.get_truecolor()) >= least, name


def test_contrast_is_what_wcag_says_it_is() -> None:
    assert contrast(BLACK, WHITE) == pytest.approx(21)
    assert contrast(WHITE, WHITE) == 1
    assert contrast(Color.parse("#767676").get_truecolor(), WHITE) == pytest.approx(4.54, abs=0.01)


@pytest.mark.parametrize("least", [3, 4.5, 7])
def test_a_colour_is_moved_no_further_than_it_must_be(least: float) -> None:
    orange = Color.parse("#f2460c").get_truecolor()
    moved = legible(orange, WHITE, least)
    assert least <= contrast(moved, WHITE) < least + 0.9
    assert legible(moved, WHITE, least) == moved


@pytest.mark.parametrize("palette", PALETTES)
def test_groups_beyond_the_palette_are_told_by_their_letter_alone(palette: Palette) -> None:
    many = len(palette.groups)
    assert group_colour(many, palette) == group_colour(many + 7, palette)
    assert group_colour(many, palette) not in palette.groups


def test_what_comes_after_the_cursor_is_fainter() -> None:
    ground = ColorTriplet(0x12, 0x12, 0x12)
    before, after = (style_of(Ink(Role.BAR, 1, later), DARK, "#121212").color for later in (False, True))
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
        text
        for value in glyphs.values()
        if not isinstance(value, Role)
        for text in (value.values() if isinstance(value, dict) else [value])
    ]
    assert all(text.isascii() for text in texts)


def test_the_first_picture_of_the_menu_needs_nothing_of_a_trace() -> None:
    code = "import sys, cbtui.app; print(*[name for name in sys.modules if name.startswith('sim.trace')])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
