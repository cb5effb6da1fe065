"""What a person's tuning means for one node: which group and which period a callback gets."""

from __future__ import annotations

from sim.ros.middleware.tuning import GroupChoice, Tuning
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)


class TunedNode:
    """What a tuning means for one node. Used with the host's lock held."""

    def __init__(self, node: str, tuning: Tuning) -> None:
        self._node = node
        self._tuning = tuning
        self._shared: dict[GroupChoice, CallbackGroup] = {}

    def period(self, callback: str, asked: int) -> int:
        """The period of a timer, in nanoseconds."""
        return self._tuning.period(self._node, callback, asked)

    def group(self, callback: str, asked: CallbackGroup, default: CallbackGroup) -> CallbackGroup:
        """The group of a callback for which the program asked for another; ``default`` is the node's."""
        match self._tuning.group_choice(self._node, callback):
            case None:
                return asked
            case GroupChoice.OWN:
                return MutuallyExclusiveCallbackGroup()
            case GroupChoice.SHARED as wish:
                return self._shared.setdefault(wish, MutuallyExclusiveCallbackGroup())
            case GroupChoice.REENTRANT as wish:
                return self._shared.setdefault(wish, ReentrantCallbackGroup())
            case GroupChoice.DEFAULT:
                return default
