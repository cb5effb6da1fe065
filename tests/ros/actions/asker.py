"""Asks an action server by plain clients of its services, and hears it by plain subscriptions."""

from typing import Any

import sim.ros.rclpy as rclpy
from sim.interfaces import action, message, service
from sim.ros.actions.server import ServerGoalHandle
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.task import Future

Fibonacci = action("example_interfaces", "Fibonacci")
Impl = Fibonacci.Impl
CancelGoal = service("action_msgs", "CancelGoal")
GoalStatus = message("action_msgs", "GoalStatus")
Int32 = message("std_msgs", "Int32")


class Asker:
    """Asks an action server by its services, and keeps what it publishes."""

    def __init__(self, node: Node, name: str = "/fibonacci") -> None:
        self.node = node
        self.feedback: list[tuple[int, list[int]]] = []
        self.statuses: list[list[int]] = []
        group = ReentrantCallbackGroup()
        self.goals, self.cancels, self.results = (
            node.create_client(kind, f"{name}/_action/{part}", callback_group=group)
            for kind, part in (
                (Impl.SendGoalService, "send_goal"),
                (Impl.CancelGoalService, "cancel_goal"),
                (Impl.GetResultService, "get_result"),
            )
        )
        node.create_subscription(
            Impl.FeedbackMessage, f"{name}/_action/feedback", self._hear, 10, callback_group=group
        )
        node.create_subscription(
            Impl.GoalStatusMessage, f"{name}/_action/status", self._see, 10, callback_group=group
        )

    def _hear(self, feedback: Any) -> None:
        self.feedback.append((int(feedback.goal_id.uuid[0]), list(feedback.feedback.sequence)))

    def _see(self, status: Any) -> None:
        self.statuses.append([each.status for each in status.status_list])

    def send(self, number: int, order: int = 0) -> Any:
        return self._answer(self.goals.call_async(self.goal(number, order)))

    def goal(self, number: int, order: int = 0) -> Any:
        request = Impl.SendGoalService.Request()
        request.goal_id.uuid = [number] * 16
        request.goal.order = order
        return request

    def cancel(self, number: int) -> Any:
        request = CancelGoal.Request()
        request.goal_info.goal_id.uuid = [number] * 16
        return self._answer(self.cancels.call_async(request))

    def result(self, number: int) -> Any:
        request = Impl.GetResultService.Request()
        request.goal_id.uuid = [number] * 16
        return self._answer(self.results.call_async(request))

    def _answer(self, future: Future[Any]) -> Any:
        rclpy.spin_until_future_complete(self.node, future, timeout_sec=50)
        return future.result()


def spin_for(node: Node, seconds: float) -> None:
    rclpy.spin_until_future_complete(node, Future(), timeout_sec=seconds)


def succeed(goal_handle: ServerGoalHandle) -> Any:
    goal_handle.succeed()
    return Fibonacci.Result(sequence=[1, 1, 2])
