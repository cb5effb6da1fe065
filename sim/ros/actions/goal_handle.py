"""A goal on its server's side: its request, its state, its feedback and its result."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from sim.quantities.nanoseconds import SECOND
from sim.ros.actions.goal_states import TERMINAL, GoalEvent, GoalState, next_state
from sim.ros.scheduling.task import Future

if TYPE_CHECKING:
    from sim.ros.actions.server import ActionServer

PATIENCE = 2
"""Seconds after an accepted cancel in which an execute callback should ask for it."""


class ServerGoalHandle:
    """A goal that a server has accepted. Thread-safe.

    After it is destroyed, with its server or when its result has expired, its state is unknown, and changes
    of the state do nothing.
    """

    def __init__(self, action_server: ActionServer, goal_info: Any, goal_request: Any) -> None:
        self.info = goal_info
        self.result_response: Future[Any] = Future()
        self.done_at: int | None = None
        self._action_server = action_server
        self._goal_request = goal_request
        self._state = GoalState.ACCEPTED
        self._is_executed = False
        self._was_asked = False
        self._host = action_server.node.context.host
        self._accepted_at: int | None = self._host.clock.now()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ServerGoalHandle) and self.goal_id == other.goal_id

    __hash__ = None  # type: ignore[assignment]

    @property
    def request(self) -> Any:
        """The goal as the client sent it."""
        return self._goal_request

    @property
    def goal_id(self) -> Any:
        """The goal's ``unique_identifier_msgs/msg/UUID``."""
        return self.info.goal_id

    @property
    def state(self) -> GoalState:
        """The goal's state."""
        return self._state

    @property
    def status(self) -> int:
        """The goal's state, a number of ``action_msgs/msg/GoalStatus``."""
        self._was_asked = True
        return int(self._state)

    @property
    def is_active(self) -> bool:
        """Whether the goal is accepted and has not ended."""
        return self._state is not GoalState.UNKNOWN and self._state not in TERMINAL

    @property
    def is_cancel_requested(self) -> bool:
        """Whether a cancel request was accepted, and the goal has not ended yet."""
        self._was_asked = True
        return self._state is GoalState.CANCELING

    def execute(self, execute_callback: Callable[[ServerGoalHandle], Any] | None = None) -> None:
        """Let an executor run the given execute callback, by default the server's.

        Raises:
            RCLError: the goal is executing already, or has ended.
        """
        # A goal that is cancelled before its execution is executed as well, so that its callback can
        # report the cancellation.
        if self._state is not GoalState.CANCELING:
            self.change(GoalEvent.EXECUTE)
        self._action_server.notify_execute(self, execute_callback)

    def begin(self) -> None:
        """Note that the execute callback begins."""
        with self._host.lock:
            self._is_executed = True
            self._watch_cancel()

    def publish_feedback(self, feedback: Any) -> None:
        """Send feedback to the clients; TypeError if the feedback does not have the action's type."""
        kind = self._action_server.action_type.Feedback
        if not isinstance(feedback, kind):
            raise TypeError(f"Expected {kind}, got {type(feedback)}")
        if self._accepted_at == self._host.clock.now():
            self._action_server.let_clients_hear()
        self._accepted_at = None
        with self._host.lock:
            if self._state is not GoalState.UNKNOWN:
                self._action_server.send_feedback(self.goal_id, feedback)

    def succeed(self, response: Any = None) -> None:
        """Mark the goal as succeeded; ``response``, if given, is its result instead of the callback's.

        Raises:
            RCLError: the goal is neither executing nor being cancelled.
        """
        self._end(GoalEvent.SUCCEED, response)

    def abort(self, response: Any = None) -> None:
        """Mark the goal as aborted; otherwise as ``succeed``."""
        self._end(GoalEvent.ABORT, response)

    def canceled(self, response: Any = None) -> None:
        """Mark the goal as cancelled; otherwise as ``succeed``."""
        self._end(GoalEvent.CANCELED, response)

    def _end(self, event: GoalEvent, response: Any) -> None:
        self.change(event)
        if response is not None:
            self.set_result(response)

    def change(self, event: GoalEvent) -> None:
        """Apply an event to the goal's state, and publish the status.

        Raises:
            RCLError: the state does not allow the event.
        """
        with self._host.lock:
            if self._state is GoalState.UNKNOWN:
                return
            self._state = next_state(self._state, event)
            self._action_server.publish_status()
            self._watch_cancel()
            if not self.is_active:
                self.done_at = self._host.clock.now()
                self._action_server.notify_goal_done()

    def _watch_cancel(self) -> None:
        """Look later whether the execute callback has asked for its cancel. With the host's lock held."""
        if self._is_executed and self._state is GoalState.CANCELING:
            self._was_asked = False
            self._host.clock.call_at(self._host.clock.now() + PATIENCE * SECOND, self._check_cancel)

    def _check_cancel(self) -> None:
        with self._host.lock:
            if self._state is GoalState.CANCELING and not self._was_asked:
                self._action_server.notify_cancel_ignored(PATIENCE)

    def set_result(self, result: Any) -> None:
        """Set the result, and answer the requests for it; a result that was set before stays.

        Raises:
            AssertionError: it does not have the action's type, as when an execute callback returns nothing.
        """
        get_result = self._action_server.action_type.Impl.GetResultService
        response = get_result.Response(status=int(self._state), result=result)
        with self._host.lock:
            if self.result_response.done():
                return
        self.result_response.set_result(response)

    def destroy(self) -> None:
        """Set the state to unknown."""
        with self._host.lock:
            self._state = GoalState.UNKNOWN
