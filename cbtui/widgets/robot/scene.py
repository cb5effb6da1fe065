"""The robot's world at a moment, drawn in dots on a map."""

import math
from functools import lru_cache
from itertools import pairwise

import numpy as np

from cbtui.looks.theme import TRAIL_STEPS, Charset, Ink, Role
from cbtui.text.cells import CellRow
from cbtui.widgets.dots import DotGrid, Floats
from cbtui.widgets.robot.extents import MapView
from sim.trace.events import ArenaShown, RobotMoved, Scanned
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

_GRID, _WALL, _TRAIL, _SEEN, _TRUE, _SPHERE, _ROBOT, _HURT, _FLASH = 1, 2, 3, 7, 8, 9, 10, 11, 12
_FAINT = Ink(Role.FAINT)
_INKS = (
    Ink(Role.TEXT),
    _FAINT,
    Ink(Role.WALL),
    *(Ink(Role.TRAIL, age) for age in range(TRAIL_STEPS)),
    Ink(Role.SEEN_SCAN),
    Ink(Role.TRUE_SCAN),
    Ink(Role.SPHERE),
    Ink(Role.ROBOT),
    Ink(Role.WARN),
    Ink(Role.WARN),
)
_SIGNS = " +#',:;x.O@!*"
_ARROWS = {Charset.ASCII: ">/^\\</v\\"}
_ARROWS_ROUND = "▶◥▲◤◀◣▼◢"

_TRAIL_LASTS: Nanoseconds = 60_000_000_000
_TRAIL_POINTS = 300

_FLASH_LASTS: Nanoseconds = 600_000_000
_FLASH_TURNS: Nanoseconds = 150_000_000
_RAYS = 8


class RobotScene:
    """The robot's world at one moment, as far as a timeline knows it."""

    def __init__(self, plan: ArenaShown, timeline: Timeline, now: Nanoseconds, robot: RobotMoved) -> None:
        self.plan = plan
        self.robot = robot
        seen = timeline.scan_seen(now)
        self._true, self._seen = self._points(timeline.scan(now)), self._points(seen)
        self.seen_age = None if seen is None else now - seen.t
        self.hit_age = since_hit(timeline, now)
        trail = timeline.trail(Window(max(0, now - _TRAIL_LASTS), now + 1))
        step = max(1, len(trail) // _TRAIL_POINTS)
        places = [(moved.x, moved.y) for moved in (trail[place] for place in range(0, len(trail), step))]
        self._trail = np.array(places).reshape(-1, 2)
        """The robot's places in metres, the oldest first."""

    def picture(self, view: MapView, charset: Charset) -> list[CellRow]:
        """Draw everything in one view."""
        dots = _arena_dots(self.plan, view, charset).copy()
        self._draw_trail(dots, view)
        dots.plot_sparsely(*view.dots(*self._seen), _SEEN)
        dots.plot(*view.dots(*self._true), _TRUE)
        layer = _HURT if self.robot.touching else _ROBOT
        self._draw_robot(dots, view, layer)
        self._draw_flash(dots, view)
        rows = dots.rows(_INKS, _SIGNS)
        across, along = view.grid()
        for x in across:
            _write_metres(rows[-1], view.cell(x, 0)[0], x)
        for row, y in ((view.cell(0, y)[1], y) for y in along):
            if row < len(rows) - 1:
                _write_metres(rows[row], 0, y)
        column, line = view.cell(self.robot.x, self.robot.y)
        if not view.shows_size(self.plan.robot_radius) and 0 <= line < len(rows):
            rows[line].put(column, _arrow(self.robot.yaw, charset), _INKS[layer])
        return rows

    def _draw_trail(self, dots: DotGrid, view: MapView) -> None:
        lengths = list(map(len, np.array_split(self._trail, TRAIL_STEPS)))
        layers = np.repeat(np.arange(_TRAIL, _TRAIL + TRAIL_STEPS, dtype=np.uint8), lengths)
        dots.plot(*view.dots(self._trail[:, 0], self._trail[:, 1]), layers)

    def _draw_robot(self, dots: DotGrid, view: MapView, layer: int) -> None:
        robot, radius = self.robot, self.plan.robot_radius
        if view.shows_size(radius):
            dots.plot(*view.dots(*_circle(robot.x, robot.y, radius, view.metres_per_dot / 2)), layer)
        ahead = max(2.2 * radius, 3 * view.metres_per_dot)
        tip = (robot.x + ahead * math.cos(robot.yaw), robot.y + ahead * math.sin(robot.yaw))
        dots.line(view.dot(robot.x, robot.y), view.dot(*tip), layer)

    def _draw_flash(self, dots: DotGrid, view: MapView) -> None:
        """Draw rays around the robot, which alternate between two positions."""
        if self.hit_age is None:
            return
        first = self.hit_age // _FLASH_TURNS % 2 * math.pi / _RAYS
        angles = first + np.arange(_RAYS) * (2 * math.pi / _RAYS)
        inner = max(1.5 * self.plan.robot_radius, 2.5 * view.metres_per_dot)
        for cos, sin in zip(np.cos(angles), np.sin(angles), strict=True):
            start = (self.robot.x + inner * cos, self.robot.y + inner * sin)
            end = (self.robot.x + 1.8 * inner * cos, self.robot.y + 1.8 * inner * sin)
            dots.line(view.dot(*start), view.dot(*end), _FLASH)

    def _points(self, scan: Scanned | None) -> tuple[Floats, Floats]:
        """Return the ends of a scan's beams, in metres, for the robot's position; none of no scan."""
        robot = self.robot
        ranges = np.frombuffer(b"" if scan is None else scan.ranges, dtype="<u2") / 1000.0
        angles = robot.yaw - math.pi + np.arange(len(ranges)) * (2 * math.pi / max(1, len(ranges)))
        hit = ranges > 0
        return robot.x + ranges[hit] * np.cos(angles[hit]), robot.y + ranges[hit] * np.sin(angles[hit])


@lru_cache(maxsize=8)
def _arena_dots(plan: ArenaShown, view: MapView, charset: Charset) -> DotGrid:
    """Return the constant dots of a view: its grid, the walls and the sphere. Not to be changed."""
    dots = DotGrid(view.columns, view.lines, charset)
    across, along = view.grid()
    dots.plot(*view.dots(np.repeat(across, len(along)), np.tile(along, len(across))), _GRID)
    for x0, y0, x1, y1 in plan.walls:
        dots.line(view.dot(x0, y0), view.dot(x1, y1), _WALL)
    x, y, radius = plan.sphere
    dots.plot(*view.dots(*_disc(x, y, radius, view.metres_per_dot / 2)), _SPHERE)
    return dots


def _write_metres(row: CellRow, column: int, metres: float) -> None:
    """Write a coordinate where nothing but the grid is drawn."""
    text = f"{metres:g} m"
    under = slice(column, column + len(text))
    cells, inks = row.cells[under], row.inks[under]
    if len(cells) == len(text) and all(map(_is_grid, cells, inks)):
        row.write(column, text, _FAINT)


def _is_grid(glyph: str, ink: Ink) -> bool:
    return glyph == " " or ink == _FAINT


def since_hit(timeline: Timeline, now: Nanoseconds) -> Nanoseconds | None:
    """Return the time since the last collision; None if its flash is over."""
    start = now - _FLASH_LASTS
    before = timeline.robot(start)
    moves = timeline.trail(Window(start + 1, now + 1))
    hits = [
        after.t for moved, after in pairwise((before, *moves)) if after is not None and _hits(moved, after)
    ]
    return now - hits[-1] if hits else None


def _hits(before: RobotMoved | None, after: RobotMoved) -> bool:
    return after.touching and not (before is not None and before.touching)


def _circle(x: float, y: float, radius: float, step: float) -> tuple[Floats, Floats]:
    angles = np.arange(0, 2 * math.pi, min(1.0, step / radius))
    return x + radius * np.cos(angles), y + radius * np.sin(angles)


def _disc(x: float, y: float, radius: float, step: float) -> tuple[Floats, Floats]:
    steps = np.arange(-radius, radius + step, step)
    across, along = np.meshgrid(steps, steps)
    inside = across**2 + along**2 <= radius**2
    return x + across[inside], y + along[inside]


def _arrow(yaw: float, charset: Charset) -> str:
    eighth = round(yaw / (math.pi / 4)) % 8
    return _ARROWS.get(charset, _ARROWS_ROUND)[eighth]
