"""Clients: they call a service; an executor takes the replies."""

import math
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import msgspec

from sim.interfaces import copy_message
from sim.quantities.nanoseconds import wait_ns
from sim.ros.context.context import NODE_ENDED, Context
from sim.ros.entities.client_or_service import ClientOrService
from sim.ros.entities.entity_handles import ClientHandle
from sim.ros.middleware.delivery import Request
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.entity import Entity, OwnerNode, TakenData
from sim.ros.scheduling.task import Future
from sim.trace.events import EntityKind

SrvType = TypeVar("SrvType")
SrvTypeRequest = TypeVar("SrvTypeRequest")
SrvTypeResponse = TypeVar("SrvTypeResponse")
"""Type variables that programs import for their type hints."""

_FOREIGN = None
"""Stands for a reply to another client."""
_POLL = 0.25
"""Seconds between two polls for a service, as in rclpy."""


def wait_until_ready(ready: Callable[[], bool], context: Context, timeout_sec: float | None) -> bool:
    """Poll ``ready`` four times a second until it holds, the context has ended or the timeout is over."""
    left = math.inf if timeout_sec is None else timeout_sec
    while context.ok() and not ready() and left > 0:
        context.host.clock.sleep(wait_ns(_POLL))
        left -= _POLL
    return ready()


class Reply(msgspec.Struct, frozen=True):
    """A reply that arrived at ``sent`` nanoseconds."""

    call: int
    data: Any
    sent: int


class Client(ClientOrService, Entity):
    """Calls one service. An executor takes the reply, as a callback of the client's group."""

    kind = EntityKind.CLIENT
    rank = 3

    def __init__(
        self,
        node: OwnerNode,
        srv_type: Any,
        service_name: str,
        qos_profile: QoSProfile,
        callback_group: CallbackGroup,
        *,
        srv_name: str | None = None,
    ) -> None:
        super().__init__(node, service_name, callback_group)
        self._set_service(srv_type, srv_name, qos_profile)
        self._host = node.context.host
        self.gid = self._host.new_gid()
        self._pending_requests: dict[int, Future[Any]] = {}
        node.context.network.join_client(self)

    @property
    def handle(self) -> ClientHandle:
        """A handle that keeps the client alive while it is used, and takes replies."""
        return ClientHandle(self)

    @property
    def context(self) -> Context:
        """The context of the client's node."""
        return self.node.context

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Call the service, and wait on this thread for the reply, which another thread has to take.

        Inside a callback it waits for ever, unless the executor has another thread and the client's group
        admits the reply. After ``timeout_sec`` seconds without a reply it returns None, in releases that do
        not raise.

        Raises:
            TimeoutError: the timeout is over.
            TypeError: the request does not have the service's type, or the release has no ``timeout_sec``.
            InvalidHandle: the client was destroyed.
        """
        profile = self._host.profile
        if timeout_sec is not None and not profile.call_takes_timeout:
            raise TypeError("Client.call() got an unexpected keyword argument 'timeout_sec'")
        arrived = self._host.clock.auto_reset_event()
        call, future = self._send(request)
        future.add_done_callback(lambda _: arrived.set())
        deadline = None if timeout_sec is None else self._host.clock.now() + wait_ns(timeout_sec)
        self._probe.call_blocked(call, self.name)
        try:
            # A reply that was taken is in time, even if no thread has run the done-callback yet.
            if not (future._settled() or arrived.wait(deadline) or future._settled()):
                self.remove_pending_request(future)
                if profile.call_raises_timeout:
                    raise TimeoutError
                return None
        finally:
            self._probe.call_unblocked(call)
        return future.result()

    def call_async(self, request: Any) -> Future[Any]:
        """Send a request; the future gets the reply once an executor has taken it.

        Raises:
            TypeError: the request does not have the service's type.
            InvalidHandle: the client was destroyed.
        """
        return self._send(request)[1]

    def _send(self, request: Any) -> tuple[int, Future[Any]]:
        if not isinstance(request, self.srv_type.Request):
            raise TypeError(f"Expected {self.srv_type.Request}, got {type(request)}")
        self.require_alive()
        future: Future[Any] = Future()
        future._early_check = self._probe.usage.result_check()
        copy = copy_message(request)
        with self._host.lock:
            call = self._probe.call_id()
            self._pending_requests[call] = future
            future.add_done_callback(self.remove_pending_request)
            self._probe.service_called(call, self.name, copy)
            outgoing = Request(
                copy, call, self._host.clock.now(), lambda response: self._arrive(call, response), self.gid
            )
            if self._introspection is not None:
                self._introspection.publish_step("REQUEST_SENT", self.gid, call, request=copy)
            if not self.node.context.network.send_request(self.name, self.srv_type, outgoing):
                self._probe.request_lost(call, self.name)
        return call, future

    def remove_pending_request(self, future: Future[Any]) -> None:
        """Drop a request; a reply to it is ignored."""
        with self._host.lock:
            for call, pending in tuple(self._pending_requests.items()):
                if pending is future:
                    del self._pending_requests[call]

    def service_is_ready(self) -> bool:
        """Whether the service is offered; InvalidHandle or RCLError after the client's or context's end."""
        self.require_alive()
        self.node.context.require_ok("failed to check service availability", NODE_ENDED)
        with self._host.lock:
            return self.node.context.network.has_service(self.name, self.srv_type)

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Wait until the service is offered; False after ``timeout_sec`` seconds.

        It polls four times a second, and so may return a little after the timeout.
        """
        return wait_until_ready(self.service_is_ready, self.node.context, timeout_sec)

    def _arrive(self, call: int, response: Any) -> None:
        if self.destroyed:
            return
        now = self._host.clock.now()
        self._enqueue(Reply(call, response, now))
        self._probe.ready(self, self.queued, call)
        self.become_ready(now)

    def overhear(self) -> None:
        """A reply to another client arrived, for DDS sends it to all of the service; a take finds none.

        Until that take the client is ready, and its own replies come behind it.
        """
        self._enqueue(_FOREIGN)
        self.become_ready(self._host.clock.now())

    def _enqueue(self, reply: Reply | None) -> None:
        """Queue a reply; a full queue drops its oldest one, and the future of that call stays pending."""
        if self.depth and len(self._queue) >= self.depth:
            lost: Reply | None = self._queue.popleft()
            if lost is not _FOREIGN:
                self._probe.dropped(self, self.queued, lost.call)
        self._queue.append(reply)

    @property
    def queued(self) -> int:
        """How many replies to this client there are to take."""
        return len(self._queue) - self._queue.count(_FOREIGN)

    def arrivals(self) -> Sequence[Entity | None]:
        """For all that there is to take, foreign replies too, what it arrived at."""
        return [None] * len(self._queue)

    def take(self, now: int) -> TakenData | None:
        """Take the oldest reply; None if it is to another client."""
        reply: Reply | None = self._take_oldest(now) if self._queue else _FOREIGN
        if reply is _FOREIGN:
            return None
        if self._introspection is not None:
            self._introspection.publish_step("RESPONSE_RECEIVED", self.gid, reply.call, response=reply.data)
        return TakenData(reply, reply.call, now - reply.sent, self.queued)

    def invoke(self, taken: TakenData) -> Any:
        """Set the result of the future that waits for the reply."""
        reply: Reply = taken.data
        future = self._pending_requests.get(reply.call)
        if future is not None:
            self._settle(future, reply.data)

    def _settle(self, future: Future[Any], result: Any) -> None:
        """Set a future's result; its done-callbacks run as tasks of the node's executor."""
        executor = self.node.executor
        if executor is not None:
            future._set_executor(executor)
        future.set_result(result)

    def removed(self) -> None:
        """Leave the network: the client was removed from its node."""
        self.node.context.network.leave_client(self)
        self.stop_introspection()
