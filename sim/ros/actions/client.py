"""Action clients: they send goals, and receive replies, feedback, status and results."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count
from typing import Any
from uuid import UUID, uuid5
from weakref import WeakKeyDictionary, ref

from sim.interfaces import message
from sim.ros.actions.cancelling import uuid_of
from sim.ros.actions.goal_states import TERMINAL, GoalState
from sim.ros.actions.parts import ClientPart, SubscriptionPart
from sim.ros.actions.waitable import ActionWaitable, await_or_execute
from sim.ros.entities.client import Reply, wait_until_ready
from sim.ros.middleware.host import Host
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.task import Future

__all__ = ["ActionClient", "ClientGoalHandle"]

FeedbackCallback = Callable[[Any], Any]

_SPACE = UUID("5e0c1ad2-3f87-4a35-8a3c-0d5a86d7c1f4")
_numbers: WeakKeyDictionary[Host, Iterator[int]] = WeakKeyDictionary()


class ClientGoalHandle:
    """A goal on its client's side. Its status is the last one that the server published."""

    def __init__(self, action_client: ActionClient, goal_id: Any, goal_response: Any) -> None:
        self._action_client = action_client
        self._goal_id = goal_id
        self._goal_response = goal_response
        self._status = int(GoalState.UNKNOWN)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ClientGoalHandle) and self._goal_id == other.goal_id

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"ClientGoalHandle <id={self.goal_id.uuid}, accepted={self.accepted}, status={self.status}>"

    @property
    def goal_id(self) -> Any:
        """The goal's ``unique_identifier_msgs/msg/UUID``."""
        return self._goal_id

    @property
    def stamp(self) -> Any:
        """When the server accepted the goal, a ``builtin_interfaces/msg/Time``."""
        return self._goal_response.stamp

    @property
    def accepted(self) -> bool:
        """Whether the server accepted the goal."""
        return bool(self._goal_response.accepted)

    @property
    def status(self) -> int:
        """The goal's state, a number of ``action_msgs/msg/GoalStatus``."""
        return self._status

    def cancel_goal(self) -> Any:
        """Request a cancellation, and wait on this thread for the response; in a callback that may deadlock.

        Returns the response of ``action_msgs/srv/CancelGoal``.
        """
        return self._action_client._cancel_goal(self)

    def cancel_goal_async(self) -> Future[Any]:
        """Request a cancellation; the future gets the response of ``action_msgs/srv/CancelGoal``."""
        return self._action_client._cancel_goal_async(self)

    def get_result(self) -> Any:
        """Request the result, and wait on this thread for the goal's end; in a callback that may deadlock.

        Returns a response with ``status`` and ``result``.
        """
        return self._action_client._get_result(self)

    def get_result_async(self) -> Future[Any]:
        """Request the result; the future gets a response with ``status`` and ``result`` at the goal's end."""
        return self._action_client._get_result_async(self)


class ActionClient(ActionWaitable):
    """Sends goals to the server of one action. It handles replies and feedback in its callback group.

    Raises:
        AttributeError: ``action_type`` is not an action class.
        ValueError: the action's name breaks the rules.
    """

    end = "client"

    def __init__(
        self,
        node: Node,
        action_type: Any,
        action_name: str,
        *,
        callback_group: CallbackGroup | None = None,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_sub_qos_profile: QoSProfile = QoSProfile(depth=10),  # noqa: B008 -- nobody changes it
        status_sub_qos_profile: QoSProfile = qos_profile_action_status_default,
    ) -> None:
        super().__init__(node, action_type, action_name, callback_group)
        self._goal_handles: dict[bytes, ref[ClientGoalHandle]] = {}
        self._goal_ids: dict[int, Any] = {}
        self._feedback_callbacks: dict[bytes, FeedbackCallback] = {}
        self._logger = node.get_logger().get_child("action_client")
        impl = action_type.Impl
        with self._host.lock:
            node._agenda.add(self)
            self._goal_client = self._add_client(
                impl.SendGoalService, "send_goal", goal_service_qos_profile, self._take_goal_response
            )
            self._cancel_client = self._add_client(
                impl.CancelGoalService, "cancel_goal", cancel_service_qos_profile, self._take_cancel_response
            )
            self._result_client = self._add_client(
                impl.GetResultService, "get_result", result_service_qos_profile, self._take_result
            )
            self._clients = (self._goal_client, self._cancel_client, self._result_client)
            self._subscriptions = (
                self._add_subscription(
                    impl.FeedbackMessage, "feedback", feedback_sub_qos_profile, self._take_feedback
                ),
                self._add_subscription(
                    impl.GoalStatusMessage, "status", status_sub_qos_profile, self._take_status
                ),
            )

    # Sending

    def send_goal(
        self, goal: Any, feedback_callback: FeedbackCallback | None = None, goal_uuid: Any = None
    ) -> Any:
        """Send a goal, and wait on this thread until it has ended; in a callback that may deadlock.

        Returns a response with ``status`` and ``result``; otherwise as ``send_goal_async``.
        """
        future = self.send_goal_async(goal, feedback_callback, goal_uuid)
        return self._get_result(self._goal_client.wait_for(future))

    def send_goal_async(
        self, goal: Any, feedback_callback: FeedbackCallback | None = None, goal_uuid: Any = None
    ) -> Future[Any]:
        """Send a goal; the future gets a ClientGoalHandle once the server has answered.

        ``feedback_callback(message)`` is called with each feedback until the result arrives. ``goal_uuid``
        is the goal's id; None: a new one.

        Raises:
            TypeError: the goal does not have the action's type.
        """
        if not isinstance(goal, self._action_type.Goal):
            raise TypeError(f"Expected {self._action_type.Goal}, got {type(goal)}")
        goal_id = _new_goal_id(self._host) if goal_uuid is None else goal_uuid
        request = self._action_type.Impl.SendGoalService.Request(goal_id=goal_id, goal=goal)
        with self._host.lock:
            if feedback_callback is not None:
                self._feedback_callbacks[uuid_of(goal_id)] = feedback_callback
            call, future = self._goal_client._send(request)
            self._goal_ids[call] = goal_id
        future.add_done_callback(lambda _: self._goal_ids.pop(call, None))
        return future

    def _cancel_goal(self, goal_handle: ClientGoalHandle) -> Any:
        return self._cancel_client.wait_for(self._cancel_goal_async(goal_handle))

    def _cancel_goal_async(self, goal_handle: ClientGoalHandle) -> Future[Any]:
        _check_is_goal_handle(goal_handle)
        request = self._action_type.Impl.CancelGoalService.Request()
        request.goal_info.goal_id = goal_handle.goal_id
        return self._cancel_client.call_async(request)

    def _get_result(self, goal_handle: ClientGoalHandle) -> Any:
        return self._result_client.wait_for(self._get_result_async(goal_handle))

    def _get_result_async(self, goal_handle: ClientGoalHandle) -> Future[Any]:
        _check_is_goal_handle(goal_handle)
        if not goal_handle.accepted:
            self._probe.usage.result_of_rejected()
        request = self._action_type.Impl.GetResultService.Request(goal_id=goal_handle.goal_id)
        future = self._result_client.call_async(request)
        key = uuid_of(goal_handle.goal_id)
        future.add_done_callback(lambda _: self._feedback_callbacks.pop(key, None))
        return future

    # Receiving

    def _take_goal_response(self, reply: Reply) -> None:
        future, goal_id = self._goal_client.awaited(reply), self._goal_ids.get(reply.call)
        if future is None or goal_id is None:
            self._ignore("goal")
            return
        goal_handle = ClientGoalHandle(self, goal_id, reply.data)
        if goal_handle.accepted:
            key = uuid_of(goal_id)
            if key in self._goal_handles:
                raise RuntimeError(f"Two goals were accepted with the same ID ({goal_handle})")
            self._goal_handles[key] = ref(goal_handle)
        self._goal_client._settle(future, goal_handle)

    def _take_cancel_response(self, reply: Reply) -> None:
        self._settle(self._cancel_client, reply, "cancel")

    def _take_result(self, reply: Reply) -> None:
        self._settle(self._result_client, reply, "result")

    def _settle(self, client: ClientPart, reply: Reply, what: str) -> None:
        future = client.awaited(reply)
        if future is None:
            self._ignore(what)
        else:
            client._settle(future, reply.data)

    def _ignore(self, what: str) -> None:
        self._logger.warning(
            f"Ignoring unexpected {what} response. There may be more than one action server for the action "
            f"'{self._action_name}'"
        )

    async def _take_feedback(self, feedback: Any) -> None:
        callback = self._feedback_callbacks.get(uuid_of(feedback.goal_id))
        if callback is not None:
            await await_or_execute(callback, feedback)

    def _take_status(self, status: Any) -> None:
        for each in status.status_list:
            key = uuid_of(each.goal_info.goal_id)
            known = self._goal_handles.get(key)
            goal_handle = None if known is None else known()
            if goal_handle is not None:
                goal_handle._status = each.status
            if goal_handle is None or each.status in TERMINAL:
                self._goal_handles.pop(key, None)

    # The server

    def server_is_ready(self) -> bool:
        """Whether the action's three services and two topics are all offered."""
        with self._host.lock:
            return all(client.service_is_ready() for client in self._clients) and all(
                self._is_published(subscription) for subscription in self._subscriptions
            )

    def _is_published(self, subscription: SubscriptionPart) -> bool:
        publishers = self._node.context.network.publishers(subscription.topic_name)
        return any(each.msg_type is subscription.msg_type for each in publishers)

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Wait until the action is offered; False after ``timeout_sec`` seconds.

        It polls four times a second, and so may return a little after the timeout.
        """
        return wait_until_ready(self.server_is_ready, self._node.context, timeout_sec)


def _check_is_goal_handle(goal_handle: Any) -> None:
    if not isinstance(goal_handle, ClientGoalHandle):
        raise TypeError(f"Expected type ClientGoalHandle but received {type(goal_handle)}")


def _new_goal_id(host: Host) -> Any:
    """A new ``unique_identifier_msgs/msg/UUID``, unique on this host, the same in every virtual run."""
    with host.lock:
        number = next(_numbers.setdefault(host, count()))
    made = uuid5(_SPACE, f"{host.clock.epoch} {number}")
    return message("unique_identifier_msgs", "UUID")(uuid=list(made.bytes))
