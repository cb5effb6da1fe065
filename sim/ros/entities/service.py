"""Services: a queue of requests, and a callback that answers them one at a time."""

import inspect
from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from sim.interfaces import copy_message
from sim.interpreter.function_marks import sends_responses
from sim.ros.entities.client_or_service import ClientOrService
from sim.ros.entities.entity_handles import RequestId, ServiceHandle, ServiceInfo, answered
from sim.ros.middleware.delivery import Request
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import Entity, OwnerNode, TakenData
from sim.trace.events import EntityKind

SrvType = TypeVar("SrvType")
SrvTypeRequest = TypeVar("SrvTypeRequest")
SrvTypeResponse = TypeVar("SrvTypeResponse")
"""Type variables that programs import for their type hints."""


class Service(ClientOrService, Entity):
    """Answers calls of one service. If the callback raises, no reply is sent."""

    kind = EntityKind.SERVICE
    rank = 4

    def __init__(
        self,
        node: OwnerNode,
        srv_type: Any,
        service_name: str,
        callback: Callable[[Any, Any], Any],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
        *,
        srv_name: str | None = None,
    ) -> None:
        super().__init__(node, service_name, callback_group)
        self._set_service(srv_type, srv_name, qos_profile)
        self.callback = callback

    @property
    def handle(self) -> ServiceHandle:
        """A handle that keeps the service alive while it is used, and takes requests."""
        return ServiceHandle(self)

    @property
    def is_shown(self) -> bool:
        """Whether the service belongs to a program that the trace shows."""
        return self._probe.visible

    def deliver(self, request: Request) -> None:
        """Queue a request; a full queue drops its oldest one. Called with the host's lock held."""
        if self.depth and len(self._queue) >= self.depth:
            lost = self._queue.popleft()
            self._probe.dropped(self, len(self._queue), lost.call)
        self._queue.append(request)
        self._probe.ready(self, len(self._queue), request.call)
        self.become_ready(request.sent)

    def take(self, now: int) -> TakenData | None:
        """Take the oldest request."""
        if not self._queue:
            return None
        request: Request = self._take_oldest(now)
        if self._introspection is not None:
            self._introspection.publish_step(
                "REQUEST_RECEIVED", request.client, request.call, request=request.data
            )
        return TakenData(request, request.call, now - request.sent, len(self._queue))

    def invoke(self, taken: TakenData) -> Any:
        """Run the callback, and send the response that it returns."""
        request: Request = taken.data
        outcome = self.callback(request.data, self.srv_type.Response())
        if inspect.iscoroutine(outcome):
            return self._answer_later(request, outcome)
        self.send_response(outcome, request)
        return None

    async def _answer_later(self, request: Request, outcome: Any) -> None:
        response = await outcome
        executor = self.node.executor
        if executor is not None and executor.replies_in_tasks:
            executor.create_task(self.send_response, response, request)
        else:
            self.send_response(response, request)

    @sends_responses
    def send_response(self, response: Any, header: Request | ServiceInfo | RequestId) -> None:
        """Send a response to the request of a header or request id.

        Raises:
            TypeError: the response does not have the service's type, or the header is not that of a request.
            InvalidHandle: the service was destroyed, for example by its own callback.
        """
        request = header if isinstance(header, Request) else answered(header)
        if not isinstance(response, self.srv_type.Response):
            raise TypeError(f"Expected {self.srv_type.Response}, got {type(response)}")
        self.require_alive()
        copy = copy_message(response)
        with self.node.context.host.lock:
            self._probe.service_replied(request.call, self.name, copy)
            if self._introspection is not None:
                self._introspection.publish_step("RESPONSE_SENT", request.client, request.call, response=copy)
            self.node.context.network.send_reply(
                self.name, self.srv_type, request.client, partial(request.answer, copy)
            )

    def removed(self) -> None:
        """Leave the network: the service was removed from its node."""
        self.node.context.network.leave_service(self)
        self.stop_introspection()
