"""Which goals a cancel request means.

Source: the comments of ``action_msgs/srv/CancelGoal``, and rcl_action.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntEnum
from typing import Any, Protocol, TypeVar

from sim.ros.actions.goal_states import GoalState, is_cancelable
from sim.ros.time.time import Time


class ReturnCode(IntEnum):
    """What a ``CancelGoal`` response says, numbered as there."""

    NONE = 0
    REJECTED = 1
    UNKNOWN_GOAL_ID = 2
    GOAL_TERMINATED = 3


class Cancelable(Protocol):
    """What has to be known of a goal."""

    @property
    def info(self) -> Any:
        """Its ``action_msgs/msg/GoalInfo``: the id, and when it was accepted."""

    @property
    def state(self) -> GoalState:
        """Its state."""


GoalT = TypeVar("GoalT", bound=Cancelable)


def goals_meant(wanted: Any, goals: Iterable[GoalT]) -> tuple[list[GoalT], ReturnCode]:
    """The goals that can be cancelled among those that ``wanted``, a ``GoalInfo``, means.

    An id alone means that goal, a time all that were accepted until then, both mean either, and neither
    means every goal. The return code tells why an id alone found none.
    """
    key, until = uuid_of(wanted.goal_id), _nanoseconds(wanted)
    if any(key) and not until:
        return _one_goal(key, goals)
    every = not any(key) and not until
    found = [
        goal
        for goal in goals
        if is_cancelable(goal.state)
        and (every or _nanoseconds(goal.info) <= until or uuid_of(goal.info.goal_id) == key)
    ]
    return found, ReturnCode.NONE


def _one_goal(key: bytes, goals: Iterable[GoalT]) -> tuple[list[GoalT], ReturnCode]:
    goal = next((each for each in goals if uuid_of(each.info.goal_id) == key), None)
    if goal is None:
        return [], ReturnCode.UNKNOWN_GOAL_ID
    if not is_cancelable(goal.state):
        return [], ReturnCode.GOAL_TERMINATED
    return [goal], ReturnCode.NONE


def uuid_of(goal_id: Any) -> bytes:
    """The 16 bytes of a ``unique_identifier_msgs/msg/UUID``, to look goals up by."""
    return bytes(goal_id.uuid)


def _nanoseconds(info: Any) -> int:
    return Time.from_msg(info.stamp).nanoseconds
