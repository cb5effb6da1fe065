"""The signs of the factory in each charset: workers, seats, boxes, belts, walls."""

from dataclasses import dataclass, replace

from cbtui.looks.theme import Charset


@dataclass(frozen=True, slots=True)
class Walls:
    """The walls of an area; the joints are where it stands on the wall of the one above."""

    top: str
    side: str
    top_left: str
    top_right: str
    left_joint: str
    right_joint: str
    bottom_left: str
    bottom_right: str


@dataclass(frozen=True, slots=True)
class FigureGlyphs:
    """A worker in three rows and three columns, and what it sits on: rows of seven columns, the lower two."""

    body: str
    legs: str
    comes: str
    leaves: str
    armchair: tuple[str, str]
    stool: tuple[str, str]


@dataclass(frozen=True, slots=True)
class FactoryGlyphs:
    """One charset's signs. Seats are pairs of signs left and right of the worker."""

    busy: str
    idle: str
    away: str
    seat: tuple[str, str]
    open_seat: tuple[str, str]
    comes: str
    leaves: str
    box: str
    slot: str
    belt: str
    door: str
    clock: str
    tick: str
    walled: Walls
    open: Walls
    figure: FigureGlyphs


_BRAILLE = FactoryGlyphs(
    busy="☻",
    idle="☺",
    away="·",
    seat=("▐", "▌"),
    open_seat=("(", ")"),
    comes="◂",
    leaves="▸",
    box="■",
    slot="□",
    belt="─",
    door="▸",
    clock="◷",
    tick="◆",
    walled=Walls("━", "┃", "┏", "┓", "┣", "┫", "┗", "┛"),
    open=Walls("╌", "╎", "┌", "┐", "├", "┤", "└", "┘"),
    figure=FigureGlyphs("/█\\", "/ \\", "< \\", "/ >", ("▐     ▌", "▐▄▄▄▄▄▌"), ("       ", " (___) ")),
)
FACTORY_GLYPHS = {
    Charset.BRAILLE: _BRAILLE,
    Charset.BLOCK: replace(
        _BRAILLE,
        comes="◄",
        leaves="►",
        slot="·",
        door="►",
        clock="○",
        tick="♦",
        walled=Walls("═", "║", "╔", "╗", "╠", "╣", "╚", "╝"),
        open=Walls("·", ":", "·", "·", "·", "·", "·", "·"),
    ),
    Charset.ASCII: FactoryGlyphs(
        busy="@",
        idle="o",
        away=".",
        seat=("[", "]"),
        open_seat=("(", ")"),
        comes="<",
        leaves=">",
        box="#",
        slot=".",
        belt="-",
        door=">",
        clock="every",
        tick="*",
        walled=Walls("=", "|", "+", "+", "+", "+", "+", "+"),
        open=Walls(".", ":", ".", ".", ":", ":", ".", "."),
        figure=FigureGlyphs("/|\\", "/ \\", "< \\", "/ >", ("[     ]", "[_____]"), ("       ", " (___) ")),
    ),
}
