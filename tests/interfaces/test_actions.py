"""Actions and what rosidl makes of them."""

from __future__ import annotations

import pickle

import pytest

from sim.interfaces import (
    UnknownInterfaceError,
    action,
    interface_module,
    message,
    message_of_type,
    names,
    packages,
    service,
    type_name,
)

Fibonacci = action("example_interfaces", "Fibonacci")


def test_an_action_has_goal_result_and_feedback() -> None:
    assert Fibonacci.Goal(order=3).order == 3
    assert Fibonacci.Result(sequence=[0, 1]).sequence.tolist() == [0, 1]
    assert Fibonacci.Feedback.get_fields_and_field_types() == {"sequence": "sequence<int32>"}
    assert repr(Fibonacci.Goal()) == "example_interfaces.action.Fibonacci_Goal(order=0)"


def test_the_goal_service_carries_an_id_and_the_goal() -> None:
    sent = Fibonacci.Impl.SendGoalService
    assert sent.__name__ == "Fibonacci_SendGoal"
    assert sent.Request.get_fields_and_field_types() == {
        "goal_id": "unique_identifier_msgs/UUID",
        "goal": "example_interfaces/Fibonacci_Goal",
    }
    assert sent.Response.get_fields_and_field_types() == {
        "accepted": "boolean",
        "stamp": "builtin_interfaces/Time",
    }
    assert type(sent.Request().goal) is Fibonacci.Goal


def test_the_result_service_carries_an_id_and_status_and_result() -> None:
    result = Fibonacci.Impl.GetResultService
    assert result.Request.get_fields_and_field_types() == {"goal_id": "unique_identifier_msgs/UUID"}
    assert result.Response.get_fields_and_field_types() == {
        "status": "int8",
        "result": "example_interfaces/Fibonacci_Result",
    }


def test_the_feedback_message_carries_an_id_and_the_feedback() -> None:
    assert Fibonacci.Impl.FeedbackMessage.get_fields_and_field_types() == {
        "goal_id": "unique_identifier_msgs/UUID",
        "feedback": "example_interfaces/Fibonacci_Feedback",
    }


def test_all_actions_share_the_cancel_service_and_the_status_message() -> None:
    assert Fibonacci.Impl.CancelGoalService is service("action_msgs", "CancelGoal")
    assert Fibonacci.Impl.GoalStatusMessage is message("action_msgs", "GoalStatusArray")


def test_an_action_class_cannot_be_instantiated() -> None:
    with pytest.raises(NotImplementedError, match=r"^Action classes can not be instantiated$"):
        Fibonacci()


def test_names_lead_to_the_same_classes() -> None:
    assert action("example_interfaces", "Fibonacci") is Fibonacci
    assert type_name(Fibonacci) == "example_interfaces/action/Fibonacci"
    prefix = "example_interfaces/action/Fibonacci"
    assert message_of_type(f"{prefix}_Goal") is Fibonacci.Goal
    assert message_of_type(f"{prefix}_SendGoal_Request") is Fibonacci.Impl.SendGoalService.Request
    assert message_of_type(f"{prefix}_SendGoal_Event") is Fibonacci.Impl.SendGoalService.Event
    with pytest.raises(UnknownInterfaceError, match="has no action part 'Fibonacci_Wish'"):
        message_of_type(f"{prefix}_Wish")


def test_the_modules_are_those_of_rosidl() -> None:
    assert interface_module("example_interfaces.action").Fibonacci is Fibonacci
    inner = interface_module("example_interfaces.action._fibonacci")
    assert inner.Fibonacci_FeedbackMessage is Fibonacci.Impl.FeedbackMessage
    assert inner.Fibonacci_SendGoal is Fibonacci.Impl.SendGoalService
    assert Fibonacci.__module__ == "example_interfaces.action._fibonacci"


def test_goals_pickle() -> None:
    goal = Fibonacci.Impl.SendGoalService.Request(goal=Fibonacci.Goal(order=4))
    assert pickle.loads(pickle.dumps(goal)) == goal


@pytest.mark.parametrize(
    ("package", "name"),
    [(package, name) for package in sorted(packages()) for name in names(package, "action")],
)
def test_every_action_can_be_made(package: str, name: str) -> None:
    found = action(package, name)
    assert found.Goal() == found.Goal()
    assert found.Impl.FeedbackMessage().feedback == found.Feedback()


def test_the_parts_of_two_actions_of_one_name_are_kept_apart() -> None:
    tutorial = action("action_tutorials_interfaces", "Fibonacci")
    assert list(tutorial.Feedback.get_fields_and_field_types()) == ["partial_sequence"]
