"""The states of a goal, and which goals a cancel request means."""

from itertools import product
from types import SimpleNamespace
from typing import Any

import pytest

from sim.interfaces import message, service
from sim.ros.actions.cancelling import CancelReturnCode, goals_to_cancel
from sim.ros.actions.goal_states import TERMINAL, GoalEvent, GoalState, next_state
from sim.ros.exceptions import RCLError

GoalInfo = message("action_msgs", "GoalInfo")
GoalStatus = message("action_msgs", "GoalStatus")


def test_states_are_numbered_as_in_the_message() -> None:
    assert {f"STATUS_{state.name}": state.value for state in GoalState} == {
        name: getattr(GoalStatus, name) for name in dir(GoalStatus) if name.startswith("STATUS_")
    }


def test_return_codes_are_those_of_the_service() -> None:
    codes = service("action_msgs", "CancelGoal").Response
    assert [int(code) for code in CancelReturnCode] == [
        codes.ERROR_NONE,
        codes.ERROR_REJECTED,
        codes.ERROR_UNKNOWN_GOAL_ID,
        codes.ERROR_GOAL_TERMINATED,
    ]


@pytest.mark.parametrize(("state", "event"), product(TERMINAL, GoalEvent))
def test_a_terminal_state_is_never_left(state: GoalState, event: GoalEvent) -> None:
    with pytest.raises(RCLError, match=f"from state {state.name} with event {event.name}$"):
        next_state(state, event)


def test_only_a_goal_that_is_asked_to_stop_can_be_canceled() -> None:
    reached = {state for state in GoalState if _leads_to_canceled(state)}
    assert reached == {GoalState.CANCELING}


def test_an_accepted_goal_ends_only_through_executing_or_canceling() -> None:
    for event in (GoalEvent.SUCCEED, GoalEvent.ABORT, GoalEvent.CANCELED):
        with pytest.raises(RCLError):
            next_state(GoalState.ACCEPTED, event)


def _leads_to_canceled(state: GoalState) -> bool:
    try:
        return next_state(state, GoalEvent.CANCELED) is GoalState.CANCELED
    except RCLError:
        return False


def _goal(number: int, second: int, state: GoalState) -> Any:
    return SimpleNamespace(info=_info(number, second), state=state)


def _info(number: int, second: int) -> Any:
    info = GoalInfo()
    info.goal_id.uuid = [0] * 15 + [number]
    info.stamp.sec = second
    return info


GOALS = [
    _goal(1, 10, GoalState.EXECUTING),
    _goal(2, 20, GoalState.ACCEPTED),
    _goal(3, 30, GoalState.EXECUTING),
    _goal(4, 15, GoalState.SUCCEEDED),
    _goal(5, 15, GoalState.CANCELING),
]


@pytest.mark.parametrize(
    ("number", "second", "found", "code"),
    [
        (0, 0, [1, 2, 3], CancelReturnCode.NONE),
        (2, 0, [2], CancelReturnCode.NONE),
        (0, 20, [1, 2], CancelReturnCode.NONE),
        (3, 10, [1, 3], CancelReturnCode.NONE),
        (9, 0, [], CancelReturnCode.UNKNOWN_GOAL_ID),
        (4, 0, [], CancelReturnCode.GOAL_TERMINATED),
        (5, 0, [], CancelReturnCode.GOAL_TERMINATED),
        (0, 5, [], CancelReturnCode.NONE),
    ],
)
def test_a_cancel_request_means_a_goal_a_time_both_or_all(
    number: int, second: int, found: list[int], code: CancelReturnCode
) -> None:
    goals, answer = goals_to_cancel(_info(number, second), GOALS)
    assert [int(goal.info.goal_id.uuid[-1]) for goal in goals] == found
    assert answer is code
