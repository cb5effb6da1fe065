"""Contrast ratios by WCAG 2, and colours that reach a given contrast."""

from functools import lru_cache

from rich.color import blend_rgb
from rich.color_triplet import ColorTriplet

BLACK, WHITE = ColorTriplet(0, 0, 0), ColorTriplet(255, 255, 255)

_STEPS = 32


def contrast(one: ColorTriplet, other: ColorTriplet) -> float:
    """Return the contrast of two colours, 1 (the same) to 21 (black and white)."""
    dim, bright = sorted((luminance(one), luminance(other)))
    return (bright + 0.05) / (dim + 0.05)


def readable_on(ground: ColorTriplet) -> ColorTriplet:
    """Return black or white, whichever has more contrast, which is at least 4.5."""
    return max(BLACK, WHITE, key=lambda colour: contrast(colour, ground))


@lru_cache(maxsize=1024)
def legible(colour: ColorTriplet, ground: ColorTriplet, least: float) -> ColorTriplet:
    """Return the colour, blended with black or white until it reaches the ``least`` contrast."""
    towards = readable_on(ground)
    for step in range(_STEPS):
        moved = blend_rgb(colour, towards, step / _STEPS)
        if contrast(moved, ground) >= least:
            return moved
    return towards


def luminance(colour: ColorTriplet) -> float:
    """Return WCAG 2's relative luminance, 0 to 1."""
    shares = (part / 255 for part in colour)
    red, green, blue = (
        share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4 for share in shares
    )
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue
