"""The help explains what lanes, factory and code draw."""

from pathlib import Path
from re import findall

import pytest

import cbtui
from cbtui.looks.theme import GLYPHS, Charset
from cbtui.screens.windows.signs import code_signs, factory_signs, lane_signs
from cbtui.widgets.code.signs import CODE_SIGNS
from cbtui.widgets.factory.glyphs import FACTORY_GLYPHS, FigureGlyphs, Walls

PLAIN = {"ellipsis", "frame", "between", "line_start", "right"}
"""Parts of a table, a sentence or a bar, which mean nothing by themselves."""


def drawn(room: str) -> set[str]:
    """The names of the glyphs that the painters of a room of widgets draw."""
    files = (Path(cbtui.__file__).parent / "widgets" / room).glob("*.py")
    return {name for file in files for name in findall(r"(?:glyphs|\])\.(\w+)\b(?!\()", file.read_text())}


def glyphs_of(value: object) -> tuple[str, ...]:
    """One glyph for each meaning that a value of a table of glyphs has."""
    match value:
        case str():
            return tuple(value.strip()[:1])
        case tuple():
            return tuple(str(each) for each in value)
        case dict():
            return tuple(str(each) for each in value.values())
        case Walls():
            return (value.top, value.side)
        case FigureGlyphs():
            return (value.body,)
    raise TypeError(value)


@pytest.mark.parametrize("charset", Charset)
def test_every_glyph_of_a_painter_is_explained(charset: Charset) -> None:
    lanes, factory = GLYPHS[charset], FACTORY_GLYPHS[charset]
    for room, list_of, tables in (
        ("lanes", lane_signs, (lanes,)),
        ("factory", factory_signs, (factory, lanes)),
    ):
        explained = " ".join(sign for sign, _ in list_of(charset).rows)
        for table in tables:
            for name in drawn(room) & set(type(table).__annotations__) - PLAIN:
                if name in type(tables[0]).__annotations__ and table is not tables[0]:
                    continue
                for glyph in glyphs_of(getattr(table, name)):
                    assert glyph in explained, (room, name)
    margin = {sign for sign, _ in code_signs(charset).rows}
    assert margin >= set(CODE_SIGNS)
    assert " ".join(lanes.hatch.values()) in margin


@pytest.mark.parametrize("word", ["worker", "seat", "belt", "message"])
def test_what_the_factory_is_about_is_found_among_its_signs(word: str) -> None:
    assert any(word in meaning for _, meaning in factory_signs(Charset.BRAILLE).rows)


@pytest.mark.parametrize("charset", Charset)
def test_signs_fit_beside_their_meaning(charset: Charset) -> None:
    lists = (lane_signs(charset), factory_signs(charset), code_signs(charset))
    assert max(len(sign) for each in lists for sign, _ in each.rows) <= 9
