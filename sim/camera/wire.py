"""The messages to and from the process that draws pictures."""

import msgspec


class Shot(msgspec.Struct, frozen=True, array_like=True):
    """A request for a picture: the arena, the robot's pose, and the size in pixels.

    Metres and radians; walls and sphere as in ``ArenaShown``. Pixels are square.
    """

    walls: tuple[tuple[float, float, float, float], ...]
    sphere: tuple[float, float, float]
    x: float
    y: float
    yaw: float
    width: int
    height: int


class Picture(msgspec.Struct, frozen=True, array_like=True, tag=True):
    """A picture: ``pixels`` are red, green and blue bytes, row by row from the top left."""

    width: int
    height: int
    pixels: bytes


class NoCamera(msgspec.Struct, frozen=True, array_like=True, tag=True):
    """No pictures can be drawn on this machine; ``why`` is a sentence for a person."""

    why: str
