"""What the run's overrides mean for one node: which group and which period a callback gets."""

from __future__ import annotations

from sim.ros.middleware.callback_overrides import CallbackOverrides, GroupChoice
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)


class NodeOverrides:
    """The run's overrides for one node. Use it with the host's lock held."""

    def __init__(self, node: str, overrides: CallbackOverrides) -> None:
        self._node = node
        self._overrides = overrides
        self._shared: dict[GroupChoice, CallbackGroup] = {}

    def period(self, callback: str, asked: int) -> int:
        """The period of a timer, in nanoseconds."""
        return self._overrides.period(self._node, callback, asked)

    def group(self, callback: str, asked: CallbackGroup, default: CallbackGroup) -> CallbackGroup:
        """The group of a callback for which the program asked for another; ``default`` is the node's."""
        match self._overrides.group_choice(self._node, callback):
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
