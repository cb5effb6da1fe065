"""Selects the goals of a cancel request.

Source: the comments of ``action_msgs/srv/CancelGoal``, and rcl_action.
"""

from collections.abc import Iterable
from enum import IntEnum
from typing import Any, Protocol, TypeVar

from sim.ros.actions.goal_states import GoalState, is_cancelable
from sim.ros.time.time import Time


class CancelReturnCode(IntEnum):
    """The return codes of a ``CancelGoal`` response."""

    NONE = 0
    REJECTED = 1
    UNKNOWN_GOAL_ID = 2
    GOAL_TERMINATED = 3


class Cancelable(Protocol):
    """A goal, as the selection uses it."""

    @property
    def info(self) -> Any:
        """The goal's ``action_msgs/msg/GoalInfo``: its id, and when it was accepted."""

    @property
    def state(self) -> GoalState:
        """The goal's state."""


GoalT = TypeVar("GoalT", bound=Cancelable)


def goals_to_cancel(wanted: Any, goals: Iterable[GoalT]) -> tuple[list[GoalT], CancelReturnCode]:
    """The cancelable goals that ``wanted``, a ``GoalInfo``, selects.

    An id alone selects that goal; a time all goals accepted until then; id and time select both; neither
    selects every goal. The return code says why an id alone selected none.
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
    return found, CancelReturnCode.NONE


def _one_goal(key: bytes, goals: Iterable[GoalT]) -> tuple[list[GoalT], CancelReturnCode]:
    goal = next((each for each in goals if uuid_of(each.info.goal_id) == key), None)
    if goal is None:
        return [], CancelReturnCode.UNKNOWN_GOAL_ID
    if not is_cancelable(goal.state):
        return [], CancelReturnCode.GOAL_TERMINATED
    return [goal], CancelReturnCode.NONE


def uuid_of(goal_id: Any) -> bytes:
    """The 16 bytes of a ``unique_identifier_msgs/msg/UUID``, as a key of goals."""
    return bytes(goal_id.uuid)


def _nanoseconds(info: Any) -> int:
    return Time.from_msg(info.stamp).nanoseconds
