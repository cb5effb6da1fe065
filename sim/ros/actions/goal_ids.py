"""The ids of goals: all different, and the same in every run on virtual time."""

from collections.abc import Iterator
from itertools import count
from typing import Any
from uuid import UUID, uuid5
from weakref import WeakKeyDictionary

from sim.interfaces import message
from sim.ros.middleware.host import Host

_SPACE = UUID("5e0c1ad2-3f87-4a35-8a3c-0d5a86d7c1f4")
_numbers: WeakKeyDictionary[Host, Iterator[int]] = WeakKeyDictionary()


def new_goal_id(host: Host) -> Any:
    """A new ``unique_identifier_msgs/msg/UUID``, unique on this host."""
    with host.lock:
        number = next(_numbers.setdefault(host, count()))
    made = uuid5(_SPACE, f"{host.clock.epoch} {number}")
    return message("unique_identifier_msgs", "UUID")(uuid=list(made.bytes))
