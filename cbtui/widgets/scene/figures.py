"""The figures of scenes as lines of dots: their resting and moving parts.

A figure has 20 dots across and 8 down, which are ten by two cells of braille. A line is ``(x, y, x, y)``.
"""

from typing import NamedTuple, TypeAlias

Line: TypeAlias = tuple[int, int, int, int]
ACROSS, DOWN = 20, 8


class Moving(NamedTuple):
    """Lines that are moved by ``by`` dots at most while the callback runs, and back afterwards."""

    by: tuple[int, int]
    lines: tuple[Line, ...]


class Figure(NamedTuple):
    """The lines of the resting part, and the moving parts."""

    still: tuple[Line, ...]
    moving: tuple[Moving, ...]


_GROUND: Line = (0, 7, 19, 7)
_PARCEL: tuple[Line, ...] = ((8, 5, 11, 5), (8, 6, 11, 6))

FIGURES = {
    "antenna": Figure(
        ((3, 1, 3, 7), (1, 7, 5, 7)), (Moving((10, 0), ((6, 3, 6, 4), (8, 1, 8, 2), (8, 5, 8, 6))),)
    ),
    "bell": Figure(
        ((9, 0, 10, 0),),
        (
            Moving((3, 0), ((7, 1, 10, 1), (6, 2, 11, 2), (6, 3, 11, 3), (5, 4, 12, 4), (5, 5, 12, 5))),
            Moving((-2, 0), ((10, 7, 11, 7),)),
        ),
    ),
    "belt": Figure((_GROUND,), (Moving((16, 0), ((0, 4, 3, 4), (0, 5, 3, 5))),)),
    "camera": Figure(
        ((3, 2, 16, 2), (3, 7, 16, 7), (3, 2, 3, 7), (16, 2, 16, 7), (12, 1, 14, 1)),
        (Moving((8, 0), ((5, 4, 6, 4), (5, 5, 6, 5))),),
    ),
    "clamp": Figure((_GROUND, *_PARCEL), (Moving((0, 3), ((5, 1, 14, 1), (9, 0, 10, 0))),)),
    "crane": Figure(
        ((2, 0, 2, 7), (0, 7, 5, 7), (2, 0, 18, 0)), (Moving((0, 4), ((13, 1, 13, 2), (12, 3, 14, 3))),)
    ),
    "gripper": Figure(
        ((3, 0, 16, 0), (8, 6, 11, 6), (8, 7, 11, 7)),
        (Moving((4, 0), ((3, 1, 3, 6), (3, 6, 4, 6))), Moving((-4, 0), ((16, 1, 16, 6), (15, 6, 16, 6)))),
    ),
    "hand": Figure((_GROUND,), (Moving((13, 0), ((3, 0, 3, 3), (1, 3, 5, 3), (1, 4, 1, 5), (5, 4, 5, 5))),)),
    "heart": Figure((), (Moving((15, 0), ((0, 5, 1, 1), (1, 1, 2, 7), (2, 7, 3, 4), (3, 5, 4, 5))),)),
    "lamp": Figure(
        ((8, 1, 11, 1), (7, 2, 7, 3), (12, 2, 12, 3), (8, 4, 11, 4), (8, 6, 11, 6), (9, 7, 10, 7)),
        (Moving((-3, 0), ((4, 2, 5, 2),)), Moving((3, 0), ((14, 2, 15, 2),))),
    ),
    "lorry": Figure(
        (_GROUND,),
        (
            Moving(
                (12, 0), ((0, 2, 4, 2), (0, 3, 6, 3), (0, 4, 7, 4), (0, 5, 7, 5), (1, 6, 1, 6), (6, 6, 6, 6))
            ),
        ),
    ),
    "oven": Figure(
        ((3, 0, 16, 0), (3, 7, 16, 7), (3, 0, 3, 7), (16, 0, 16, 7)),
        (Moving((0, -3), ((6, 6, 13, 6), (7, 5, 12, 5))),),
    ),
    "scales": Figure(
        ((9, 4, 10, 4), (9, 5, 10, 5), (6, 7, 13, 7), (9, 6, 10, 6)),
        (Moving((0, 2), ((2, 1, 17, 1), (8, 0, 11, 0))),),
    ),
    "watchman": Figure(
        (_GROUND, (18, 1, 18, 6), (17, 1, 19, 1)),
        (
            Moving(
                (13, 0), ((1, 1, 2, 1), (0, 3, 3, 3), (1, 2, 1, 5), (2, 2, 2, 5), (0, 6, 0, 6), (3, 6, 3, 6))
            ),
        ),
    ),
}
