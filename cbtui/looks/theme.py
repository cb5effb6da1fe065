"""Styles of drawn things by their role, and the glyphs of each charset."""

from dataclasses import dataclass
from enum import StrEnum, auto
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, NamedTuple

from rich.color import Color, blend_rgb
from rich.color_triplet import ColorTriplet
from rich.style import Style

from cbtui.looks.contrast import legible, readable_on
from cbtui.looks.palettes import Palette

if TYPE_CHECKING:
    from sim.trace.events import Reason


class Charset(StrEnum):
    """The glyphs that a terminal can show."""

    BRAILLE = "braille"
    BLOCK = "block"
    ASCII = "ascii"


class Role(StrEnum):
    """What a piece of a picture represents; the palette gives its colour by the value."""

    TEXT = auto()
    FAINT = auto()
    STRONG = auto()
    LETTER = auto()
    BAR = auto()
    TEXTURE = auto()
    LABEL = auto()
    LINE = auto()
    HATCH = auto()
    WARN = auto()
    MARK = auto()
    NOW = auto()
    WALL = auto()
    SPHERE = auto()
    ROBOT = auto()
    TRAIL = auto()
    TRUE_SCAN = auto()
    SEEN_SCAN = auto()


class Ink(NamedTuple):
    """A semantic style, which ``style_of`` resolves for a palette and background.

    ``number`` is the place of a callback group (0 for A) for the roles that show one, and the age step
    for ``TRAIL`` (0 the oldest). ``later`` marks what is after the cursor, ``selected`` what the user
    has selected.
    """

    role: Role
    number: int = -1
    later: bool = False
    selected: bool = False


class TextRun(NamedTuple):
    """Text in one ink."""

    text: str
    ink: Ink


TRAIL_STEPS = 4
"""The number of age steps of the robot's trail."""


@dataclass(frozen=True)
class Glyphs:
    """The glyphs of one charset. ``left`` and ``right`` fill a column from that side, by eighths.

    ``textures`` fill whole columns of callback groups, A's first; they are drawn in the role ``textured``.
    """

    left: str
    right: str
    line: str
    double_line: str
    line_start: str
    point: str
    hatches: str
    """Of waits, by the order of their reasons."""
    frame: str
    cursor: str
    up: str
    back: str
    forth: str
    now: str
    ellipsis: str
    degree: str
    cross: str
    lost: str
    blocked: str
    inner: str
    between: str
    heights: str
    """From nothing to a full column, by eighths."""
    sleeps: str
    textures: str
    textured: Role

    @cached_property
    def hatch(self) -> "dict[Reason, str]":
        """The hatches of waits by their reasons."""
        from sim.trace.events import Reason  # imported when a wait is drawn: the menu must appear first

        return dict(zip(Reason, self.hatches, strict=True))


_BLOCKS = Glyphs(
    left=" ▎▎▍▌▋▊▉█",
    right=" ▕▕▐▐▐▐██",
    line="─",
    double_line="═",
    line_start="╶",
    point="·",
    hatches="╱╲≡╳",
    frame="│",
    cursor="┊",
    up="▲",
    back="◂",
    forth="▸",
    now="▲",
    ellipsis="…",
    degree="°",
    cross="✗",
    lost="×",
    blocked="░",
    inner="▪",
    between="·",
    heights=" ▁▂▃▄▅▆▇█",
    sleeps="┄",
    textures="█·═║┼○",
    textured=Role.TEXTURE,
)
_PLAIN = Glyphs(
    left=" ||||####",
    right=" ||||####",
    line="-",
    double_line="=",
    line_start=" ",
    point=".",
    hatches="/\\_x",
    frame="|",
    cursor=":",
    up="^",
    back="<",
    forth=">",
    now="^",
    ellipsis="~",
    degree=" deg",
    cross="X",
    lost="*",
    blocked="%",
    inner="o",
    between="-",
    heights=" ..::==##",
    sleeps=".",
    textures="#+=o@&",
    textured=Role.BAR,
)
GLYPHS = {Charset.BRAILLE: _BLOCKS, Charset.BLOCK: _BLOCKS, Charset.ASCII: _PLAIN}


def texture_of(number: int, glyphs: Glyphs) -> TextRun:
    """Return the texture of the group at a place in the order of letters (0 for A), for one column.

    Neighbours differ; the textures repeat after the last one.
    """
    glyph = glyphs.textures[number % len(glyphs.textures)]
    return TextRun(glyph, Ink(Role.BAR if glyph == glyphs.left[8] else glyphs.textured, number))


def group_colour(number: int, palette: Palette) -> str:
    """Return the colour of the group at a place in the order of letters (0 for A), as ``#RRGGBB``."""
    return palette.groups[number] if 0 <= number < len(palette.groups) else palette.other


@lru_cache(maxsize=2048)
def style_of(ink: Ink, palette: Palette, background: str) -> Style:
    """Return the Rich style of an ink on a background (``#RRGGBB``), with the palette's least contrast."""
    ground = _triplet(background)
    least = palette.shapes if ink.role in _SHAPES else palette.words
    colour = legible(_triplet(_colour(ink, palette)), ground, least)
    if ink.role is Role.TRAIL:
        colour = blend_rgb(ground, colour, 0.4 + 0.6 * ink.number / (TRAIL_STEPS - 1))
    if ink.later:
        colour = blend_rgb(colour, ground, 0.55)
        if ink.role not in _SHAPES:
            colour = legible(colour, ground, least * _LATER)
    if ink.selected:
        bright = _triplet(palette.text)
        ground = blend_rgb(ground, bright, 0.25)
        colour = legible(blend_rgb(colour, bright, 0.45), ground, least)
    if ink.role is Role.TEXTURE:
        drawn = legible(colour, colour, palette.textures)
        return Style(color=Color.from_triplet(drawn), bgcolor=Color.from_triplet(colour))
    if ink.role is Role.LABEL:
        return Style(color=Color.from_triplet(readable_on(colour)), bgcolor=Color.from_triplet(colour))
    return Style(color=Color.from_triplet(colour), bgcolor=Color.from_triplet(ground), bold=ink.role in _BOLD)


_LATER = 2 / 3
"""The share of the least contrast that text after the cursor keeps."""

_BOLD = {Role.STRONG, Role.LETTER, Role.WARN, Role.MARK, Role.NOW, Role.ROBOT}
_OF_A_GROUP = {Role.LETTER, Role.BAR, Role.TEXTURE, Role.LABEL, Role.LINE, Role.HATCH}
_SHAPES = {
    Role.BAR,
    Role.TEXTURE,
    Role.LABEL,
    Role.WALL,
    Role.SPHERE,
    Role.ROBOT,
    Role.TRAIL,
    Role.TRUE_SCAN,
    Role.SEEN_SCAN,
}
"""Roles of shapes; the text of labels and textures contrasts with their bar instead."""


def _colour(ink: Ink, palette: Palette) -> str:
    if ink.role in _OF_A_GROUP:
        return group_colour(ink.number, palette)
    if ink.role is Role.STRONG:
        return palette.text
    colour: str = getattr(palette, ink.role)
    return colour


def _triplet(colour: str) -> ColorTriplet:
    return Color.parse(colour).get_truecolor()
