"""The encodings of ``sensor_msgs/Image``: number, type and colours of the channels."""

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

TYPES: dict[str, np.dtype[Any]] = {
    "8U": np.dtype(np.uint8),
    "8S": np.dtype(np.int8),
    "16U": np.dtype(np.uint16),
    "16S": np.dtype(np.int16),
    "32S": np.dtype(np.int32),
    "32F": np.dtype(np.float32),
    "64F": np.dtype(np.float64),
}
"""The types of a channel by OpenCV's names, in the order of OpenCV's numbers."""

_COLOURS: dict[str, tuple[str, str]] = {
    **{
        name: (f"8UC{channels}", name)
        for name, channels in (("rgb8", 3), ("bgr8", 3), ("rgba8", 4), ("bgra8", 4))
    },
    **{
        name: (f"16UC{channels}", name.replace("16", "8"))
        for name, channels in (("rgb16", 3), ("bgr16", 3), ("rgba16", 4), ("bgra16", 4))
    },
    "mono8": ("8UC1", "mono8"),
    "mono16": ("16UC1", "mono8"),
    **{f"bayer_{order}8": ("8UC1", "") for order in ("rggb", "bggr", "gbrg", "grbg")},
    **{f"bayer_{order}16": ("16UC1", "") for order in ("rggb", "bggr", "gbrg", "grbg")},
    **dict.fromkeys(("uyvy", "yuyv", "yuv422", "yuv422_yuy2"), ("8UC2", "")),
}
_NUMBERED = re.compile(r"(8U|8S|16U|16S|32S|32F|64F)C?(\d*)")


@dataclass(frozen=True, slots=True)
class Encoding:
    """The meaning of an image's bytes."""

    name: str
    type: np.dtype[Any]
    channels: int
    colour: str
    """The order of the colours, such as ``rgb8``; empty if the colours are unknown."""

    @property
    def cv_type(self) -> str:
        """OpenCV's name for images of this type and number of channels, such as ``8UC3``."""
        return f"{next(name for name, known in TYPES.items() if known == self.type)}C{self.channels}"


def encoding_of(name: str) -> Encoding | None:
    """The encoding of a name; None for an unknown name."""
    cv_type, colour = _COLOURS.get(name, (name, ""))
    found = _NUMBERED.fullmatch(cv_type)
    return None if found is None else Encoding(name, TYPES[found[1]], int(found[2] or 1), colour)
