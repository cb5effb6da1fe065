"""The handles of subscriptions, clients and services, with which a program takes and sends data itself.

An executor does not get data that were taken here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sim.interfaces import from_cdr, to_cdr
from sim.ros.entities.message_info import MessageInfo
from sim.ros.handle import Handle
from sim.ros.middleware.delivery import Request

if TYPE_CHECKING:
    from sim.ros.entities.client import Client
    from sim.ros.entities.service import Service
    from sim.ros.entities.subscription import Subscription


@dataclass(frozen=True, slots=True)
class RequestId:
    """The id of a request; a service sends the response to ``request``."""

    sequence_number: int
    request: Request | None = None


@dataclass(frozen=True, slots=True)
class ServiceInfo:
    """The header of a request or a response; the timestamps are nanoseconds since 1970."""

    source_timestamp: int
    received_timestamp: int
    request_id: RequestId


class SubscriptionHandle(Handle):
    """The handle of a subscription."""

    def take_message(self, msg_type: type, raw: bool) -> tuple[Any, MessageInfo] | None:
        """Take the oldest message (``raw``: as bytes) with its info; None without a message."""
        subscription: Subscription = self.owner
        host = subscription.node.context.host
        with self, host.lock:
            now = host.clock.now()
            if not (subscription.still_ready(now) and subscription._queue):
                return None
            delivery = subscription._queue[0]
            taken = subscription.take(now)
            assert taken is not None
            info = subscription._info_of(delivery, now)
        data = taken.data[0] if subscription._with_info else taken.data
        if raw == subscription.raw:
            return data, info
        return (to_cdr(data) if raw else from_cdr(msg_type, data)), info


class ClientHandle(Handle):
    """The handle of a client."""

    def service_server_is_available(self) -> bool:
        """Whether the service is offered."""
        client: Client = self.owner
        return client.service_is_ready()

    def send_request(self, request: Any) -> int:
        """Send a request, and return its sequence number.

        Raises:
            TypeError: the request does not have the service's type.
        """
        client: Client = self.owner
        return client._send(request)[0]

    def take_response(self, response_type: type) -> tuple[ServiceInfo | None, Any]:
        """Take the oldest response: its header, then the response; None for both without a response."""
        client: Client = self.owner
        host = client._host
        with self, host.lock:
            taken = client.take(host.clock.now())
            if taken is None:
                return None, None
            reply = taken.data
            client._pending_requests.pop(reply.call, None)
        arrived = host.clock.epoch + reply.sent
        return ServiceInfo(arrived, arrived, RequestId(reply.call)), reply.data


class ServiceHandle(Handle):
    """The handle of a service."""

    def service_take_request(self, request_type: type) -> tuple[Any, ServiceInfo | None]:
        """Take the oldest request: the request, then its header; None for both without a request."""
        service: Service = self.owner
        host = service.node.context.host
        with self, host.lock:
            taken = service.take(host.clock.now())
        if taken is None:
            return None, None
        request: Request = taken.data
        arrived = host.clock.epoch + request.sent
        return request.data, ServiceInfo(arrived, arrived, RequestId(request.call, request))

    def service_send_response(self, response: Any, header: ServiceInfo | RequestId) -> None:
        """Send a response to the request of a header or request id.

        Raises:
            TypeError: the response does not have the service's type, or the header is not that of a request.
        """
        service: Service = self.owner
        with self:
            service.send_response(response, header)


def answered(header: object) -> Request:
    """The request of a header or request id; TypeError if the object is not the header or id of a request."""
    identity = header.request_id if isinstance(header, ServiceInfo) else header
    if not isinstance(identity, RequestId) or identity.request is None:
        raise TypeError(f"a response needs the header or the id of a request, got {type(header)}")
    return identity.request
