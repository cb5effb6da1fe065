"""What goes to the process that draws pictures, and what comes back from it."""

import msgspec


class Shot(msgspec.Struct, frozen=True, array_like=True):
    """A picture to be taken: of which arena, where the robot stands in it, and how many pixels.

    Metres and radians; walls and sphere as ``ArenaShown`` has them. A pixel is as high as wide.
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
    """There are no pictures on this machine; ``why`` is a sentence for a person."""

    why: str
