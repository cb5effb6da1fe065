"""The part of the arena that a map shows, and the position of places (metres) on it."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cbtui.looks.theme import Charset
from cbtui.widgets.dots import DOTS_PER_CELL, Floats
from sim.trace.events import ArenaShown, RobotMoved

_MARGIN = 0.6
_GRID = 0.5
_GRID_STEPS = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)
_LEAST_GRID_COLUMNS = 8
_SPHERE_WITHIN = 3.0


class Extent(NamedTuple):
    """A rectangle of the arena, in metres."""

    left: float
    bottom: float
    right: float
    top: float


def full_arena(plan: ArenaShown) -> Extent:
    """Return the extent of all walls and the sphere."""
    x, y, radius = plan.sphere
    across = [at for wall in plan.walls for at in (wall[0], wall[2])] + [x - radius, x + radius]
    along = [at for wall in plan.walls for at in (wall[1], wall[3])] + [y - radius, y + radius]
    return Extent(min(across), min(along), max(across), max(along))


def robot_surroundings(plan: ArenaShown, robot: RobotMoved) -> Extent:
    """Return the surroundings of the robot, with the sphere while it is close.

    The borders lie on a coarse grid, so that the map does not move with the robot.
    """
    x, y, radius = plan.sphere
    points = [(robot.x, robot.y, plan.robot_radius)]
    if math.hypot(robot.x - x, robot.y - y) < _SPHERE_WITHIN:
        points.append((x, y, radius))
    return Extent(
        _down(min(x - size for x, _, size in points) - _MARGIN),
        _down(min(y - size for _, y, size in points) - _MARGIN),
        -_down(-max(x + size for x, _, size in points) - _MARGIN),
        -_down(-max(y + size for _, y, size in points) - _MARGIN),
    )


def _down(at: float) -> float:
    return math.floor(at / _GRID) * _GRID


@dataclass(frozen=True, slots=True)
class MapView:
    """A map of ``columns`` x ``lines`` cells; a cell counts as twice as high as wide."""

    left: float
    top: float
    columns: int
    lines: int
    metres_across: float
    metres_down: float
    across: int
    down: int

    @classmethod
    def of(cls, extent: Extent, columns: int, lines: int, charset: Charset) -> "MapView":
        """Fit an extent into cells, centred and as large as possible."""
        width, height = extent.right - extent.left, extent.top - extent.bottom
        cell = max(width / (columns - 1), height / (2 * lines - 1), 1e-6)
        across, down = DOTS_PER_CELL[charset]
        left = (extent.left + extent.right) / 2 - cell * columns / 2
        top = (extent.bottom + extent.top) / 2 + cell * lines
        return cls(left, top, columns, lines, cell / across, 2 * cell / down, across, down)

    @property
    def metres_per_dot(self) -> float:
        """The width of a dot in metres."""
        return self.metres_across

    def shows_size(self, radius: float) -> bool:
        """Whether a circle of this radius (metres) is larger than a point."""
        return radius >= 2 * self.metres_across

    def dot(self, x: float, y: float) -> tuple[float, float]:
        """Return the dot at a place in metres, counted from the top left."""
        return (x - self.left) / self.metres_across, (self.top - y) / self.metres_down

    def dots(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Return the dots at many places."""
        return (x - self.left) / self.metres_across, (self.top - y) / self.metres_down

    def cell(self, x: float, y: float) -> tuple[int, int]:
        """Return the cell (column, line) at a place in metres."""
        column, line = self.dot(x, y)
        return math.floor(column / self.across), math.floor(line / self.down)

    def grid(self) -> tuple[Floats, Floats]:
        """Return the coordinates (x and y, metres) of a grid's lines, round and well apart on the map."""
        columns_per_metre = 1 / (self.metres_across * self.across)
        wide = (step for step in _GRID_STEPS if step * columns_per_metre >= _LEAST_GRID_COLUMNS)
        step = next(wide, _GRID_STEPS[-1])
        right = self.left + self.columns * self.across * self.metres_across
        bottom = self.top - self.lines * self.down * self.metres_down
        return _multiples(step, self.left, right), _multiples(step, bottom, self.top)


def _multiples(step: float, start: float, end: float) -> Floats:
    """The multiples of a step after ``start`` and before ``end``."""
    return np.arange(math.floor(start / step) + 1, math.ceil(end / step), dtype=np.float64) * step
