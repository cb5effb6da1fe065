"""The regions of the robot pane: maps, the camera's picture, and the lines between them."""

from enum import StrEnum
from typing import NamedTuple

from textual.geometry import Region

_TWO_MAPS_FROM = 40
_MAPS_AND_CAMERA_FROM = 100
_LEAST_WIDTH = 12
_LEAST_HEIGHT = 3


class RobotViewMode(StrEnum):
    """What the robot pane shows: map, camera or both."""

    MAP = "map"
    CAMERA = "camera"
    BOTH = "both"

    @property
    def following(self) -> "RobotViewMode":
        """The next mode, in a circle."""
        looks = list(RobotViewMode)
        return looks[(looks.index(self) + 1) % len(looks)]


class PaneRegions(NamedTuple):
    """Regions in cells: the robot's surroundings, the whole room, the picture; None if not shown.

    ``lines`` are one column wide or one row high.
    """

    near: Region | None = None
    room: Region | None = None
    camera: Region | None = None
    lines: tuple[Region, ...] = ()


def arrange(body: Region, look: RobotViewMode) -> PaneRegions:
    """Divide the part of the pane between legend and figures; one that is too small shows nothing."""
    if body.width < _LEAST_WIDTH or body.height < _LEAST_HEIGHT:
        return PaneRegions()
    match look:
        case RobotViewMode.CAMERA:
            return PaneRegions(camera=body)
        case RobotViewMode.MAP if body.width < _TWO_MAPS_FROM:
            return PaneRegions(near=body)
        case RobotViewMode.MAP:
            near, line, room = _halves(body)
            return PaneRegions(near, room, lines=(line,))
    maps, line, camera = _halves(body)
    if body.width < _MAPS_AND_CAMERA_FROM:
        return PaneRegions(maps, camera=camera, lines=(line,))
    near, between, room = _halves(maps)
    return PaneRegions(near, room, camera, (between, line))


def _halves(region: Region) -> tuple[Region, Region, Region]:
    """Halve a region across its longer side, with a line between; a cell counts as twice as high as wide."""
    x, y, width, height = region
    if width >= 2 * height:
        half = width // 2
        rest = Region(x + half + 1, y, width - half - 1, height)
        return Region(x, y, half, height), Region(x + half, y, 1, height), rest
    half = height // 2
    rest = Region(x, y + half + 1, width, height - half - 1)
    return Region(x, y, width, half), Region(x, y + half, width, 1), rest
