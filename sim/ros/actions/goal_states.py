"""The states of a goal, and the events that change them.

Source: the goal state machine of ROS 2's design documents ("Actions"), and rcl_action.
"""

from enum import Enum, IntEnum
from types import MappingProxyType

from sim.ros.exceptions import RCLError


class GoalState(IntEnum):
    """The states, numbered as in ``action_msgs/msg/GoalStatus``."""

    UNKNOWN = 0
    ACCEPTED = 1
    EXECUTING = 2
    CANCELING = 3
    SUCCEEDED = 4
    CANCELED = 5
    ABORTED = 6


class GoalEvent(Enum):
    """The events of an accepted goal."""

    EXECUTE = 0
    CANCEL_GOAL = 1
    SUCCEED = 2
    ABORT = 3
    CANCELED = 4


TERMINAL = frozenset({GoalState.SUCCEEDED, GoalState.CANCELED, GoalState.ABORTED})
"""The states in which a goal has ended."""

_TRANSITIONS = MappingProxyType(
    {
        (GoalState.ACCEPTED, GoalEvent.EXECUTE): GoalState.EXECUTING,
        (GoalState.ACCEPTED, GoalEvent.CANCEL_GOAL): GoalState.CANCELING,
        (GoalState.EXECUTING, GoalEvent.CANCEL_GOAL): GoalState.CANCELING,
        (GoalState.EXECUTING, GoalEvent.SUCCEED): GoalState.SUCCEEDED,
        (GoalState.EXECUTING, GoalEvent.ABORT): GoalState.ABORTED,
        (GoalState.CANCELING, GoalEvent.SUCCEED): GoalState.SUCCEEDED,
        (GoalState.CANCELING, GoalEvent.ABORT): GoalState.ABORTED,
        (GoalState.CANCELING, GoalEvent.CANCELED): GoalState.CANCELED,
    }
)


def next_state(state: GoalState, event: GoalEvent) -> GoalState:
    """The state after an event; RCLError if the state does not allow the event."""
    following = _TRANSITIONS.get((state, event))
    if following is None:
        raise RCLError(
            "Failed to update goal state: goal_handle attempted invalid transition "
            f"from state {state.name} with event {event.name}"
        )
    return following


def is_cancelable(state: GoalState) -> bool:
    """Whether a goal in that state can be cancelled; a goal that is being cancelled cannot."""
    return (state, GoalEvent.CANCEL_GOAL) in _TRANSITIONS
