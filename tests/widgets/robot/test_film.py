"""Pixels as cells of a terminal."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.style import Style
from textual.strip import Strip

from cbtui.widgets.robot.camera_picture import half_blocks, ramp
from sim.camera import Picture


def picture(rows: list[list[tuple[int, int, int]]]) -> Picture:
    pixels = np.array(rows, dtype=np.uint8)
    return Picture(pixels.shape[1], pixels.shape[0], pixels.tobytes())


RED, BLUE, BLACK, WHITE = (255, 0, 0), (0, 0, 255), (0, 0, 0), (255, 255, 255)


def colours(strip: Strip) -> list[tuple[str, str, str]]:
    """Every segment's text, and the colours of its upper and lower halves."""
    found = []
    for text, style, _ in strip:
        assert style is not None
        assert style.color is not None
        assert style.bgcolor is not None
        found.append((text, style.color.name, style.bgcolor.name))
    return found


def test_a_cell_has_the_colours_of_the_pixels_above_and_below() -> None:
    (strip,) = half_blocks(picture([[RED, BLACK], [BLUE, WHITE]]))
    assert colours(strip) == [("▀", "#ff0000", "#0000ff"), ("▀", "#000000", "#ffffff")]


def test_neighbours_of_the_same_colours_are_one_segment() -> None:
    (strip,) = half_blocks(picture([[RED] * 5 + [BLUE] * 3, [RED] * 8]))
    assert [text for text, _, _ in colours(strip)] == ["▀" * 5, "▀" * 3]


def test_colours_that_hardly_differ_are_one() -> None:
    (strip,) = half_blocks(picture([[(100, 100, 100), (104, 98, 103)]] * 2))
    assert colours(strip) == [("▀▀", "#6d6d6d", "#6d6d6d")]


def test_colours_are_cut_to_eight_levels_a_channel() -> None:
    (strip,) = half_blocks(picture([[(level, 0, 0) for level in range(256)]] * 2))
    assert len(colours(strip)) == 8


@given(st.integers(1, 60), st.integers(1, 20), st.integers(0, 1000))
def test_every_cell_of_a_picture_is_filled(width: int, lines: int, seed: int) -> None:
    pixels = np.random.default_rng(seed).integers(0, 256, (2 * lines, width, 3), dtype=np.uint8)
    noise = Picture(width, 2 * lines, pixels.tobytes())
    for strips in (half_blocks(noise), ramp(noise, True, Style())):
        assert [strip.cell_length for strip in strips] == [width] * lines
        assert all(len(strip.text) == width for strip in strips)


@pytest.mark.parametrize(("dark", "signs"), [(True, " =@"), (False, "@+ ")])
def test_without_colours_the_bright_is_what_stands_out_from_the_ground(dark: bool, signs: str) -> None:
    (strip,) = ramp(picture([[BLACK, (125, 125, 125), WHITE]] * 2), dark, Style())
    assert strip.text == signs
    assert strip.text.isascii()
