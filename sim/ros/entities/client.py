"""Clients: calls of a service, and the replies that an executor has to bring in."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec

from sim.interfaces import copy_message
from sim.quantities.nanoseconds import wait_ns
from sim.ros.context.context import NODE_ENDED
from sim.ros.entities.client_or_service import ClientOrService
from sim.ros.entities.entity_handles import ClientHandle
from sim.ros.middleware.delivery import Request
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.entity import Entity, OwnerNode, Taken
from sim.ros.scheduling.task import Future
from sim.trace.events import EntityKind

if TYPE_CHECKING:
    from sim.ros.context.context import Context
    from sim.ros.scheduling.callback_groups import CallbackGroup

SrvType = TypeVar("SrvType")
SrvTypeRequest = TypeVar("SrvTypeRequest")
SrvTypeResponse = TypeVar("SrvTypeResponse")
"""For the type hints of programs, which import these from here as from rclpy."""

_POLL = 0.25
"""Seconds between two looks for a service, as in rclpy."""


def wait_until_ready(ready: Callable[[], bool], context: Context, timeout_sec: float | None) -> bool:
    """Ask ``ready`` four times a second until it holds, the context has ended or the timeout is over."""
    left = math.inf if timeout_sec is None else timeout_sec
    while context.ok() and not ready() and left > 0:
        context.host.clock.sleep(wait_ns(_POLL))
        left -= _POLL
    return ready()


class Reply(msgspec.Struct, frozen=True):
    """An answer that came in."""

    call: int
    data: Any
    sent: int


class Client(ClientOrService, Entity):
    """Calls one service. The reply is taken by the executor, as a callback of the client's group."""

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
        self._queue: deque[Reply] = deque()

    @property
    def handle(self) -> ClientHandle:
        """What keeps it alive while it is used, and takes from it."""
        return ClientHandle(self)

    @property
    def context(self) -> Context:
        """The context that its node lives in."""
        return self.node.context

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """Call and wait on this thread for the reply, which another thread has to take.

        Called inside a callback it waits for ever unless the executor has a thread left and the client's
        group lets the reply in. After ``timeout_sec`` seconds without a reply it gives None, in releases that
        do not raise.

        Raises:
            TimeoutError: time ran out.
            TypeError: the request is not of the service's type, or the release knows no ``timeout_sec``.
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
            # In time is also a reply that was taken, though nobody has run what tells this thread.
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
            TypeError: the request is not of the service's type.
            InvalidHandle: the client was destroyed.
        """
        return self._send(request)[1]

    def _send(self, request: Any) -> tuple[int, Future[Any]]:
        if not isinstance(request, self.srv_type.Request):
            raise TypeError(f"Expected {self.srv_type.Request}, got {type(request)}")
        self.require_alive()
        future: Future[Any] = Future()
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
                self._introspection.tell("REQUEST_SENT", self.gid, call, request=copy)
            if not self.node.context.network.send_request(self.name, self.srv_type, outgoing):
                self._probe.request_lost(call, self.name)
        return call, future

    def remove_pending_request(self, future: Future[Any]) -> None:
        """Forget a request; a reply to it is thrown away."""
        with self._host.lock:
            for call, pending in tuple(self._pending_requests.items()):
                if pending is future:
                    del self._pending_requests[call]

    def service_is_ready(self) -> bool:
        """Whether somebody offers the service; InvalidHandle or RCLError once it or its context has ended."""
        self.require_alive()
        self.node.context.require_ok("failed to check service availability", NODE_ENDED)
        with self._host.lock:
            return self.node.context.network.has_service(self.name, self.srv_type)

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Wait until somebody offers the service; False when ``timeout_sec`` seconds were not enough.

        It looks four times a second, and so may come back a little after the timeout.
        """
        return wait_until_ready(self.service_is_ready, self.node.context, timeout_sec)

    def _arrive(self, call: int, response: Any) -> None:
        if self.destroyed:
            return
        now = self._host.clock.now()
        self._queue.append(Reply(call, response, now))
        self._probe.ready(self, len(self._queue), call)
        self.become_ready(now)

    def shown_callback(self) -> Callable[..., Any] | None:
        """None: the reply goes to a future."""
        return None

    @property
    def queued(self) -> int:
        """How much waits in its queue."""
        return len(self._queue)

    def take(self, now: int) -> Taken | None:
        """Take the oldest reply."""
        if not self._queue:
            return None
        reply = self._queue.popleft()
        if self._queue:
            self.ready_since = now
        else:
            self.nothing_left()
        if self._introspection is not None:
            self._introspection.tell("RESPONSE_RECEIVED", self.gid, reply.call, response=reply.data)
        return Taken(reply, reply.call, now - reply.sent, len(self._queue))

    def invoke(self, taken: Taken) -> Any:
        """Give the reply to the future that waits for it."""
        reply: Reply = taken.data
        future = self._pending_requests.get(reply.call)
        if future is not None:
            self._settle(future, reply.data)

    def _settle(self, future: Future[Any], result: Any) -> None:
        """Give a future its result; its done-callbacks run as tasks of the executor that serves the node."""
        executor = self.node.executor
        if executor is not None:
            future._set_executor(executor)
        future.set_result(result)

    def removed(self) -> None:
        """Its node has let it go."""
        self.stop_introspection()
