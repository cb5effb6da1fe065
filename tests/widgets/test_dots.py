"""Pictures made of dots, as rows of few runs."""

import numpy as np

from cbtui.looks.theme import Charset, Ink, Role
from cbtui.widgets.dots import DotGrid

INKS = (Ink(Role.TEXT), Ink(Role.WALL), Ink(Role.ROBOT))


def row_of(*places: tuple[int, int]) -> list[tuple[str, Role]]:
    """The runs of a row of ten cells with layers at columns."""
    dots = DotGrid(10, 1, Charset.ASCII)
    for column, layer in places:
        dots.plot(np.array([float(column)]), np.array([0.0]), layer)
    (row,) = dots.rows(INKS, " #@")
    return [(run.text, run.ink.role) for run in row.runs()]


def test_blanks_go_on_in_the_ink_before_them() -> None:
    assert row_of((2, 1), (5, 1), (8, 2)) == [
        ("  ", Role.TEXT),
        ("#  #  ", Role.WALL),
        ("@ ", Role.ROBOT),
    ]


def test_an_empty_row_is_one_run() -> None:
    assert row_of() == [(" " * 10, Role.TEXT)]


def test_of_two_layers_in_a_cell_the_higher_gives_sign_and_ink() -> None:
    assert row_of((0, 2), (0, 1)) == [("@" + " " * 9, Role.ROBOT)]
