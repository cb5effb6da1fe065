"""Action servers: they accept, execute and cancel goals, and keep their results."""

import traceback
from collections.abc import Callable
from enum import Enum
from functools import partial
from typing import Any

from sim.interfaces import message
from sim.ros.actions.cancelling import goals_to_cancel, uuid_of
from sim.ros.actions.execution import GoalRun
from sim.ros.actions.goal_handle import ServerGoalHandle
from sim.ros.actions.goal_states import GoalEvent, GoalState
from sim.ros.actions.waitable import ActionWaitable, PartData, await_or_execute
from sim.ros.exceptions import RCLError
from sim.ros.middleware.delivery import Request
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import TakenData
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor
from sim.ros.scheduling.program_task import TaskEntity
from sim.ros.scheduling.task import Future
from sim.ros.scheduling.waitable import NumberOfEntities
from sim.trace.events import EntityKind

__all__ = [
    "ActionServer",
    "CancelResponse",
    "GoalEvent",
    "GoalResponse",
    "RCLError",
    "ServerGoalHandle",
    "default_cancel_callback",
    "default_goal_callback",
    "default_handle_accepted_callback",
]


class GoalResponse(Enum):
    """The answer of a goal callback."""

    REJECT = 1
    ACCEPT = 2


class CancelResponse(Enum):
    """The answer of a cancel callback."""

    REJECT = 1
    ACCEPT = 2


def default_handle_accepted_callback(goal_handle: ServerGoalHandle) -> None:
    """Execute the goal at once."""
    goal_handle.execute()


def default_goal_callback(goal_request: Any) -> GoalResponse:  # noqa: ARG001 -- rclpy's name
    """Accept every goal."""
    return GoalResponse.ACCEPT


def default_cancel_callback(cancel_request: Any) -> CancelResponse:  # noqa: ARG001 -- rclpy's name
    """Refuse every cancel request."""
    return CancelResponse.REJECT


class ActionServer(ActionWaitable):
    """Serves one action. It handles requests in its callback group, and executes goals outside of the group.

    ``goal_callback`` gets a goal; ``handle_accepted_callback`` and ``cancel_callback`` get a
    ServerGoalHandle, and so does ``execute_callback``, which returns a result. Results are kept for
    ``result_timeout`` seconds after the end of their goals; a negative timeout keeps them for ever.

    Raises:
        AttributeError: ``action_type`` is not an action class.
        TypeError: ``execute_callback`` is not callable.
        ValueError: the action's name breaks the rules.
    """

    end = "server"

    def __init__(
        self,
        node: Node,
        action_type: Any,
        action_name: str,
        execute_callback: Callable[[ServerGoalHandle], Any] | None = None,
        *,
        callback_group: CallbackGroup | None = None,
        goal_callback: Callable[[Any], Any] | None = default_goal_callback,
        handle_accepted_callback: Callable[[ServerGoalHandle], Any] | None = default_handle_accepted_callback,
        cancel_callback: Callable[[ServerGoalHandle], Any] | None = default_cancel_callback,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_pub_qos_profile: QoSProfile = QoSProfile(depth=10),  # noqa: B008 -- nobody changes it
        status_pub_qos_profile: QoSProfile = qos_profile_action_status_default,
        result_timeout: float = 10,
    ) -> None:
        self.register_handle_accepted_callback(handle_accepted_callback)
        self.register_goal_callback(goal_callback)
        self.register_cancel_callback(cancel_callback)
        self._execute_callback: Callable[[ServerGoalHandle], Any] | None = None
        if execute_callback is not None:
            self.register_execute_callback(execute_callback)
        super().__init__(node, action_type, action_name, callback_group)
        self._result_timeout = int(result_timeout * 1e9)
        self._goal_handles: dict[bytes, ServerGoalHandle] = {}
        self._goal_info = message("action_msgs", "GoalInfo")
        self._goal_status = message("action_msgs", "GoalStatus")
        self._logger = node.get_logger().get_child("action_server")
        impl = action_type.Impl
        with self._host.lock:
            node._agenda.add(self)
            node.context.process.callbacks += 1
            self._goal_service = self._add_service(
                impl.SendGoalService, "send_goal", goal_service_qos_profile, self._serve_goal
            )
            self._cancel_service = self._add_service(
                impl.CancelGoalService, "cancel_goal", cancel_service_qos_profile, self._serve_cancel
            )
            self._result_service = self._add_service(
                impl.GetResultService, "get_result", result_service_qos_profile, self._serve_result
            )
            self._feedback = self._add_publisher(impl.FeedbackMessage, "feedback", feedback_pub_qos_profile)
            self._status = self._add_publisher(impl.GoalStatusMessage, "status", status_pub_qos_profile)
            self._execution = TaskEntity(node, EntityKind.WAITABLE, self.action, self._execute_callback)

    # Callbacks

    def register_goal_callback(self, goal_callback: Callable[[Any], Any] | None) -> None:
        """Let ``goal_callback(goal)`` decide whether a goal is accepted; None: accept every goal."""
        self._goal_callback = goal_callback or default_goal_callback

    def register_handle_accepted_callback(
        self, handle_accepted_callback: Callable[[ServerGoalHandle], Any] | None
    ) -> None:
        """Call ``handle_accepted_callback(goal_handle)`` for an accepted goal; None: execute the goal."""
        self._handle_accepted_callback = handle_accepted_callback or default_handle_accepted_callback

    def register_cancel_callback(self, cancel_callback: Callable[[ServerGoalHandle], Any] | None) -> None:
        """Let ``cancel_callback(goal_handle)`` decide whether a goal is cancelled; None: cancel no goal."""
        self._cancel_callback = cancel_callback or default_cancel_callback

    def register_execute_callback(self, execute_callback: Callable[[ServerGoalHandle], Any]) -> None:
        """Let ``execute_callback(goal_handle)`` execute a goal and return its result.

        Raises:
            TypeError: the callback is not callable.
        """
        if not callable(execute_callback):
            raise TypeError("Failed to register goal execution callback: not callable")
        self._execute_callback = execute_callback

    # Taking

    def take(self, now: int) -> TakenData | None:
        """Take the oldest request of each service, and the goals whose results have expired."""
        taken = super().take(now)
        expired = self._expired(now)
        if not expired:
            return taken
        late = now - min(self._expires_at(goal) for goal in expired)
        taken = taken or TakenData([], 0, late, self.queued)
        taken.data.append(PartData(self._forget_goals, expired))
        return taken

    def get_num_entities(self) -> NumberOfEntities:
        """The number of entities of each kind; the timer is that of the results."""
        return super().get_num_entities() + NumberOfEntities(num_timers=1)

    # Goals

    async def _serve_goal(self, header: Request) -> None:
        asked = header.data
        self._logger.debug(f"New goal request with ID: {asked.goal_id.uuid}")
        response = self._action_type.Impl.SendGoalService.Response()
        goal_handle = await self._accepted(asked)
        if goal_handle is not None:
            response.accepted = True
            response.stamp = goal_handle.info.stamp
        self._goal_service.send_response(response, header)
        if goal_handle is None:
            self._logger.debug(f"New goal rejected: {asked.goal_id.uuid}")
            return
        self._logger.debug(f"New goal accepted: {asked.goal_id.uuid}")
        with self._host.lock:
            self.publish_status()
        await await_or_execute(self._handle_accepted_callback, goal_handle)

    async def _accepted(self, asked: Any) -> ServerGoalHandle | None:
        """The handle of a requested goal; None: the goal is refused."""
        key = uuid_of(asked.goal_id)
        if key in self._goal_handles:
            return None
        answer = await await_or_execute(self._goal_callback, asked.goal)
        if not isinstance(answer, GoalResponse):
            self._logger.warning("Goal request callback did not return a GoalResponse type. Rejecting goal.")
            return None
        if answer is GoalResponse.REJECT:
            return None
        stamp = self._node.get_clock().now().to_msg()
        info = self._goal_info(goal_id=asked.goal_id, stamp=stamp)
        with self._host.lock:
            if key in self._goal_handles:
                return None
            goal_handle = ServerGoalHandle(self, info, asked.goal)
            self._goal_handles[key] = goal_handle
        return goal_handle

    def notify_execute(
        self, goal_handle: ServerGoalHandle, execute_callback: Callable[[ServerGoalHandle], Any] | None
    ) -> None:
        """Let the executor run a goal's execute callback, if there is one, as a task."""
        callback = execute_callback or self._execute_callback
        if callback is None:
            return
        executor = self._executor()
        executor.create_task(self._execute_goal(executor, callback, goal_handle))

    def _executor(self) -> Executor:
        """The executor that serves the node, or served it last."""
        executor = self._node.executor
        if executor is None:
            raise RCLError(f"no executor serves {self._node.get_name()}, so no goal of {self.action} can run")
        return executor

    async def _execute_goal(
        self,
        executor: Executor,
        execute_callback: Callable[[ServerGoalHandle], Any],
        goal_handle: ServerGoalHandle,
    ) -> None:
        uuid = goal_handle.goal_id.uuid
        self._logger.debug(f"Executing goal with ID {uuid}")
        goal_handle.begin()
        try:
            result = await GoalRun(self._execution, executor).run(execute_callback, goal_handle)
        except Exception as error:  # noqa: BLE001 -- the client gets an empty result
            result = self._action_type.Result()
            self._logger.error(f"Error raised in execute callback: {error}")  # noqa: TRY400 -- rclpy's logger
            traceback.print_exc()
        if goal_handle.is_active:
            self._logger.warning(f"Goal state not set, assuming aborted. Goal ID: {uuid}")
            # rclpy has written a line. The first one of a process takes 11 ms, for its caller is looked for
            # among all modules (``inspect.getframeinfo``). Of two goals on pools of 2 and 3 the aborted one
            # so ended last in 68 of 68 runs on Jazzy 7.1.5 and Kilted 9.1.2; behind another line in 10 of 22.
            self._let_others_go_first(1)
            goal_handle.abort()
        self._logger.debug(f"Goal with ID {uuid} finished with state {goal_handle.status}")
        goal_handle.set_result(result)

    def let_clients_hear(self) -> None:
        """Let clients in other threads hear that a goal is accepted before its first feedback.

        So they do behind a single-threaded executor in 4 of 6 runs on Jazzy 7.1.5, and on a network. The
        callback goes on in all 24 with a pool, whose other threads serve the clients behind it.
        """
        if not isinstance(self._node.executor, MultiThreadedExecutor):
            self._let_others_go_first(0)

    def _let_others_go_first(self, duration: int) -> None:
        """Let other threads do all that they can in ``duration`` nanoseconds, 0 for this moment.

        The schedule may choose that they do not.
        """
        with self._host.lock:
            goes_on = self._host.clock.choose(2)
        if not goes_on:
            self._host.clock.sleep(duration)

    # Cancelling

    async def _serve_cancel(self, header: Request) -> None:
        self._logger.debug(f"Cancel request received: {header.data}")
        with self._host.lock:
            asked, code = goals_to_cancel(header.data.goal_info, self._goal_handles.values())
        canceling = [goal.info for goal in asked if await self._cancels(goal)]
        response = self._action_type.Impl.CancelGoalService.Response(
            return_code=int(code), goals_canceling=canceling
        )
        self._cancel_service.send_response(response, header)

    async def _cancels(self, goal_handle: ServerGoalHandle) -> bool:
        answer = await await_or_execute(self._cancel_callback, goal_handle)
        if answer is not CancelResponse.ACCEPT:
            return False
        try:
            goal_handle.change(GoalEvent.CANCEL_GOAL)
        except RCLError as error:
            self._logger.debug(f"Failed to cancel goal in cancel callback: {error}")
            return False
        return True

    def notify_cancel_ignored(self, seconds: int) -> None:
        """An execute callback has not asked for so long for its cancel. Called with the host's lock held."""
        self._node.context.probe.usage.cancel_ignored(self._execution, seconds)

    # Results

    def _serve_result(self, header: Request) -> None:
        goal_id = header.data.goal_id
        self._logger.debug(f"Result request received for goal with ID: {goal_id.uuid}")
        goal_handle = self._goal_handles.get(uuid_of(goal_id))
        if goal_handle is None:
            self._logger.debug(f"Sending result response for unknown goal ID: {goal_id.uuid}")
            response = self._action_type.Impl.GetResultService.Response(status=int(GoalState.UNKNOWN))
            self._result_service.send_response(response, header)
            return
        executor = self._node.executor
        if executor is not None:
            goal_handle.result_response._set_executor(executor)
        goal_handle.result_response.add_done_callback(partial(self._send_result, header))

    def _send_result(self, header: Request, response: Future[Any]) -> None:
        if not self.destroyed:
            self._result_service.send_response(response.result(), header)

    def notify_goal_done(self) -> None:
        """A goal has ended: drop it when its result expires. Called with the host's lock held."""
        if self._result_timeout >= 0:
            if self._node.executor is not None:
                self._node.executor._expiry_set(self._node.get_clock())
            self._host.clock.call_at(self._host.clock.now() + self._result_timeout, self._check_expiry)

    def _check_expiry(self) -> None:
        with self._host.lock:
            now = self._host.clock.now()
            if not self.destroyed and self._expired(now):
                self.arrived_at = None
                self.become_ready(now)

    def _expired(self, now: int) -> list[ServerGoalHandle]:
        if self._result_timeout < 0:
            return []
        ended = (goal for goal in self._goal_handles.values() if goal.done_at is not None)
        return [goal for goal in ended if self._expires_at(goal) <= now]

    def _expires_at(self, goal_handle: ServerGoalHandle) -> int:
        assert goal_handle.done_at is not None
        return goal_handle.done_at + self._result_timeout

    def _forget_goals(self, expired: list[ServerGoalHandle]) -> None:
        with self._host.lock:
            for goal_handle in expired:
                goal_handle.destroy()
                self._goal_handles.pop(uuid_of(goal_handle.goal_id), None)

    # Publishing

    def send_feedback(self, goal_id: Any, feedback: Any) -> None:
        """Publish feedback of a goal."""
        if not self.destroyed:
            self._feedback.publish(self._action_type.Impl.FeedbackMessage(goal_id=goal_id, feedback=feedback))

    def publish_status(self) -> None:
        """Publish the states of all goals. Called with the host's lock held."""
        if not self.destroyed:
            statuses = [
                self._goal_status(goal_info=goal.info, status=int(goal.state))
                for goal in self._goal_handles.values()
            ]
            self._status.publish(self._action_type.Impl.GoalStatusMessage(status_list=statuses))

    def destroy(self) -> None:
        """Remove the server from the network, and drop its goals."""
        with self._host.lock:
            if self.destroyed:
                return
            for goal_handle in self._goal_handles.values():
                goal_handle.destroy()
            self._execution.destroy()
            for publisher in (self._feedback, self._status):
                self._node.destroy_publisher(publisher)
            super().destroy()
