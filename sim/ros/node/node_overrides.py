"""Applies the run's overrides to one node: the groups of its callbacks and the periods of its timers."""

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
        """The group of a callback; ``asked`` is the program's choice, ``default`` the default group."""
        match self._overrides.group_choice(self._node, callback):
            case None:
                return asked
            case GroupChoice.OWN:
                return _added(MutuallyExclusiveCallbackGroup())
            case GroupChoice.SHARED as choice:
                return self._shared.setdefault(choice, _added(MutuallyExclusiveCallbackGroup()))
            case GroupChoice.REENTRANT as choice:
                return self._shared.setdefault(choice, _added(ReentrantCallbackGroup()))
            case GroupChoice.DEFAULT:
                return default


def _added(group: CallbackGroup) -> CallbackGroup:
    group.is_own = False
    return group
