"""The robot's figures in a few lines: its position, the command, its velocity, the free distance."""

import math
from collections.abc import Sequence

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role
from cbtui.text.cells import CellRow
from sim.trace.events import RobotMoved, VelocityCommanded

PLAIN = Ink(Role.TEXT)
FAINT = Ink(Role.FAINT)
WARN = Ink(Role.WARN)

_GAP = 3
_Figure = tuple[str, str, Ink]


def figures(
    robot: RobotMoved, command: VelocityCommanded | None, width: int, charset: Charset
) -> list[CellRow]:
    """Return lines with the figures; their number depends only on the width, so that nothing below moves."""
    entries = _entries(robot, command, charset)
    rows: list[CellRow] = []
    at = width
    for name, value, ink in entries:
        length = len(name) + 1 + len(value)
        if not rows or at + length > width:
            rows.append(CellRow(width, charset))
            at = 0
        rows[-1].write(at, name, FAINT)
        rows[-1].write(at + len(name) + 1, value, ink)
        at += length + _GAP
    return rows


def _entries(robot: RobotMoved, command: VelocityCommanded | None, charset: Charset) -> Sequence[_Figure]:
    degree = GLYPHS[charset].degree
    text = "nothing yet".ljust(22) if command is None else _velocity(command.linear, command.angular)
    place = f"{_two_places(robot.x)} {_two_places(robot.y)} m"
    front = f"{robot.front:5.2f} m" if math.isfinite(robot.front) else "   free"
    return (
        ("pose", f"{place} {round(math.degrees(robot.yaw)):4}{degree}", PLAIN),
        ("front", front, PLAIN),
        ("told", text, PLAIN),
        ("motors", "on " if robot.motors else "OFF", PLAIN if robot.motors else WARN),
        ("real", _velocity(robot.linear, robot.angular), PLAIN),
        ("touching", "YES" if robot.touching else "no ", WARN if robot.touching else PLAIN),
    )


def _velocity(linear: float, angular: float) -> str:
    return f"{_two_places(linear)} m/s {_two_places(angular)} rad/s"


def _two_places(figure: float) -> str:
    """Return a number with two decimals, five columns wide, without a negative zero."""
    return f"{round(figure, 2) + 0.0:5.2f}"
