"""What a person can do to a console: keys, text, clicks, other sizes; and how anybody gets out of it."""

from typing import NamedTuple, TypeAlias

from textual.pilot import OutOfBounds, Pilot

from cbtui.keys.actions import ACTIONS


class Size(NamedTuple):
    """The terminal is drawn to another size."""

    columns: int
    rows: int


class Place(NamedTuple):
    """Somebody clicks."""

    column: int
    row: int


class Text(NamedTuple):
    """Somebody types, character by character."""

    characters: str


Step: TypeAlias = "str | Text | Size | Place"
"""A key, or something else that is done."""

SIZES = (Size(80, 24), Size(140, 40), Size(100, 30), Size(79, 23), Size(20, 5), Size(250, 70))

LEAVE_ALONE = {"ctrl+c"}
"""Keys that a terminal may have another meaning for."""

KEYS = sorted({key for action in ACTIONS for key in action.key.split(",")} - LEAVE_ALONE)
"""Every key that something is bound to."""

OTHERS = ("home", "end", "pageup", "pagedown", "backspace", "delete", "shift+tab", "x", "1", "ä", "f5")
"""Keys that mean something where one types, or nothing at all."""

LEAVES = 12
"""How many times ``escape`` and ``q`` have to lead out of wherever one is: windows lie above windows."""


async def take(pilot: Pilot[None], step: Step) -> None:
    """Do one thing, and let the console deal with it."""
    match step:
        case str():
            await pilot.press(step)
        case Text(characters):
            await pilot.press(*("space" if each == " " else each for each in characters))
        case Size(columns, rows):
            await pilot.resize_terminal(columns, rows)
        case Place(column, row):
            try:
                await pilot.click(offset=(column, row))
            except OutOfBounds:
                await pilot.pause()


async def leave(pilot: Pilot[None]) -> None:
    """Do what a person does who wants to be gone."""
    for _ in range(LEAVES):
        if pilot.app._exit:
            return
        await pilot.press("escape")
        if not pilot.app._exit:
            await pilot.press("q")
    await pilot.pause()
