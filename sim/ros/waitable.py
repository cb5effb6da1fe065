"""Waitables written by a program, which are not supported, and the counts that they are made of."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any


@dataclass
class NumberOfEntities:
    """How many entities of each kind a waitable waits for; two can be added."""

    num_subscriptions: int = 0
    num_guard_conditions: int = 0
    num_timers: int = 0
    num_clients: int = 0
    num_services: int = 0
    num_events: int = 0

    def __add__(self, other: NumberOfEntities) -> NumberOfEntities:
        return NumberOfEntities(
            **{each.name: getattr(self, each.name) + getattr(other, each.name) for each in fields(self)}
        )


class Waitable:
    """Base of the waitables that a program writes.

    Raises:
        NotImplementedError: always, for there is no wait set below that one could add entities to.
    """

    def __init__(self, callback_group: Any) -> None:
        raise NotImplementedError("rclpy.waitable.Waitable is not supported")
