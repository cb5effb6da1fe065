"""Conversion of images between colour encodings, with OpenCV's rounding."""

from typing import Any

import numpy as np

from sim.ros_packages.cv_bridge.encodings import Encoding

_RED, _GREEN, _BLUE = 9798, 19235, 3735
"""The brightness of each colour, in 1/32768."""


def convert(image: Any, source: Encoding, wanted: Encoding) -> Any:
    """Convert an image from one colour encoding to another."""
    planes = _planes(image, source.colour)
    converted = _arranged(planes, wanted.colour, np.iinfo(source.type).max)
    if source.type == wanted.type:
        return converted
    share = np.iinfo(wanted.type).max / np.iinfo(source.type).max
    return np.rint(converted * share).astype(wanted.type)


def _planes(image: Any, colour: str) -> dict[str, Any]:
    """The image's channels by letter; a grey image has three equal colours."""
    if colour == "mono8":
        return dict.fromkeys("rgb", image.reshape(image.shape[:2])) | {"grey": image.reshape(image.shape[:2])}
    return {letter: image[..., place] for place, letter in enumerate(colour.removesuffix("8"))}


def _arranged(planes: dict[str, Any], colour: str, most: int) -> Any:
    if colour == "mono8":
        return planes["grey"] if "grey" in planes else _grey(planes)
    opaque = np.full_like(planes["r"], most)
    return np.stack([planes.get(letter, opaque) for letter in colour.removesuffix("8")], axis=-1)


def _grey(planes: dict[str, Any]) -> Any:
    r, g, b = (planes[letter].astype(np.uint32) for letter in "rgb")
    return ((r * _RED + g * _GREEN + b * _BLUE + 16384) >> 15).astype(planes["r"].dtype)
