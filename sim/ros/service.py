"""Services: a queue of requests, and a callback that answers one at a time."""

from __future__ import annotations

import inspect
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from sim.ros.entity import Entity, Taken
from sim.ros.interfaces import copy_message
from sim.ros.network import Request
from sim.ros.qos import QoSProfile
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.callback_groups import CallbackGroup
    from sim.ros.node import Node


class Service(Entity):
    """Answers calls of one service. A callback that raises sends no reply."""

    kind = EntityKind.SERVICE
    rank = 4

    def __init__(
        self,
        node: Node,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
    ) -> None:
        super().__init__(node, srv_name, callback_group)
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.callback = callback
        self.qos_profile = qos_profile
        self.depth = qos_profile.queue_length or 0
        self._probe = node.context.probe
        self._queue: deque[Request] = deque()

    def deliver(self, request: Request) -> None:
        """A request arrived; a full queue loses its oldest. With the host's lock held."""
        if self.depth and len(self._queue) >= self.depth:
            lost = self._queue.popleft()
            self._probe.dropped(self, len(self._queue), lost.call)
        self._queue.append(request)
        self._probe.ready(self, len(self._queue), request.call)
        self.become_ready(request.sent)

    def shown_callback(self) -> Callable[..., Any]:
        """The callback."""
        return self.callback

    def take(self, now: int) -> Taken | None:
        """Take the oldest request."""
        if not self._queue:
            return None
        request = self._queue.popleft()
        if self._queue:
            self.ready_since = now
        else:
            self.nothing_left()
        return Taken(request, request.call, now - request.sent, len(self._queue))

    def invoke(self, taken: Taken) -> Any:
        """Run the callback and send what it returns."""
        request: Request = taken.data
        outcome = self.callback(request.data, self.srv_type.Response())
        if inspect.iscoroutine(outcome):
            return self._answer_later(request, outcome)
        self._answer(request, outcome)
        return None

    async def _answer_later(self, request: Request, outcome: Any) -> None:
        self._answer(request, await outcome)

    def _answer(self, request: Request, response: Any) -> None:
        if not isinstance(response, self.srv_type.Response):
            raise TypeError(f"Expected {self.srv_type.Response}, got {type(response)}")
        copy = copy_message(response)
        with self.node.context.host.lock:
            self._probe.service_replied(request.call, self.name, copy)
            request.answer(copy)

    def destroy(self) -> None:
        """Take it off the network."""
        self.node.destroy_service(self)
