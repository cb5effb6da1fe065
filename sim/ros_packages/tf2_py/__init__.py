"""``tf2_py``: transforms between frames over time, and their exceptions."""

from sim.ros_packages.tf2_py.buffer_core import BufferCore
from sim.ros_packages.tf2_py.exceptions import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

__all__ = [
    "BufferCore",
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]
