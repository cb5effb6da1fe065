"""``rclpy.timer``, as programs import it."""

from typing import Any

from sim.ros.entities import timer
from sim.ros.entities.timer import *
from sim.ros.middleware.host import current_host

del TimerInfo  # noqa: F821 -- it came with the star


def __getattr__(name: str) -> Any:
    """Return ``TimerInfo`` in releases that have it."""
    if name == "TimerInfo" and current_host().profile.gives_timer_info:
        return timer.TimerInfo
    raise AttributeError(f"module 'rclpy.timer' has no attribute {name!r}")
