"""A goal as its server sees it: its request, its state, and what its execution has to say."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sim.ros.actions.goal_states import TERMINAL, GoalEvent, GoalState, next_state
from sim.ros.scheduling.task import Future

if TYPE_CHECKING:
    from collections.abc import Callable

    from sim.ros.actions.server import ActionServer


class ServerGoalHandle:
    """A goal that a server has accepted. Thread-safe.

    Its state is unknown, and changing it does nothing, once it was destroyed: with its server, or when its
    result has been kept long enough.
    """

    def __init__(self, action_server: ActionServer, goal_info: Any, goal_request: Any) -> None:
        self.info = goal_info
        self.result_response: Future[Any] = Future()
        self.done_at: int | None = None
        self._action_server = action_server
        self._goal_request = goal_request
        self._state = GoalState.ACCEPTED
        self._host = action_server.node.context.host

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ServerGoalHandle) and self.goal_id == other.goal_id

    __hash__ = None  # type: ignore[assignment]

    @property
    def request(self) -> Any:
        """The goal, as it was sent."""
        return self._goal_request

    @property
    def goal_id(self) -> Any:
        """Its ``unique_identifier_msgs/msg/UUID``."""
        return self.info.goal_id

    @property
    def state(self) -> GoalState:
        """Its state."""
        return self._state

    @property
    def status(self) -> int:
        """Its state as a number of ``action_msgs/msg/GoalStatus``."""
        return int(self._state)

    @property
    def is_active(self) -> bool:
        """Whether it has not come to an end."""
        return self._state is not GoalState.UNKNOWN and self._state not in TERMINAL

    @property
    def is_cancel_requested(self) -> bool:
        """Whether a request to stop it was granted, and it has not stopped yet."""
        return self._state is GoalState.CANCELING

    def execute(self, execute_callback: Callable[[ServerGoalHandle], Any] | None = None) -> None:
        """Have an executor run the server's execute callback on it, or the one given.

        Raises:
            RCLError: it is executing already, or has ended.
        """
        # A goal that is asked to stop before it began is executed all the same, so that its callback can
        # say that it is cancelled.
        if not self.is_cancel_requested:
            self.change(GoalEvent.EXECUTE)
        self._action_server.notify_execute(self, execute_callback)

    def publish_feedback(self, feedback: Any) -> None:
        """Send feedback to whoever listens.

        Raises:
            TypeError: it is not of the action's type.
        """
        kind = self._action_server.action_type.Feedback
        if not isinstance(feedback, kind):
            raise TypeError(f"Expected {kind}, got {type(feedback)}")
        # On virtual time a thread runs until it waits. Over a wire a client elsewhere hears that its goal is
        # accepted before the first feedback.
        self._host.clock.sleep(0)
        with self._host.lock:
            if self._state is not GoalState.UNKNOWN:
                self._action_server.send_feedback(self.goal_id, feedback)

    def succeed(self, response: Any = None) -> None:
        """It is reached; with ``response`` that is its result, whatever the execute callback returns.

        Raises:
            RCLError: it is neither executing nor asked to stop.
        """
        self._end(GoalEvent.SUCCEED, response)

    def abort(self, response: Any = None) -> None:
        """It is given up by the server; otherwise as ``succeed``."""
        self._end(GoalEvent.ABORT, response)

    def canceled(self, response: Any = None) -> None:
        """It has stopped because it was asked to; otherwise as ``succeed``."""
        self._end(GoalEvent.CANCELED, response)

    def _end(self, event: GoalEvent, response: Any) -> None:
        self.change(event)
        if response is not None:
            self.set_result(response)

    def change(self, event: GoalEvent) -> None:
        """Let an event happen to it, and have its server tell.

        Raises:
            RCLError: the event cannot happen in its state.
        """
        with self._host.lock:
            if self._state is GoalState.UNKNOWN:
                return
            self._state = next_state(self._state, event)
            self._action_server.publish_status()
            if not self.is_active:
                self.done_at = self._host.clock.now()
                self._action_server.notify_goal_done()

    def set_result(self, result: Any) -> None:
        """Have everybody who asked for the result get it, unless there is one already.

        Raises:
            AssertionError: it is not of the action's type, as when an execute callback returns nothing.
        """
        get_result = self._action_server.action_type.Impl.GetResultService
        response = get_result.Response(status=self.status, result=result)
        with self._host.lock:
            if self.result_response.done():
                return
        self.result_response.set_result(response)

    def destroy(self) -> None:
        """Forget its state."""
        with self._host.lock:
            self._state = GoalState.UNKNOWN
