"""Hooks that record service calls: requests, replies, and threads that block in ``call()``."""

from __future__ import annotations

import time
from functools import wraps
from typing import TYPE_CHECKING, Any

from .callbacks import Calls
from .recorder import now
from .states import state_of
from .unseen import UNSEEN

if TYPE_CHECKING:
    from .recorder import Recorder


_LONGEST = 1000
"""The most characters of a request or response that are recorded."""


def _text_of(message: Any) -> str:
    """A message as text; a ``repr`` that raises must not fail the call."""
    try:
        return repr(message)[:_LONGEST]
    except Exception as error:  # noqa: BLE001 - the program must not suffer from being watched
        return f"<{type(message).__name__} that cannot be shown: {error!r}>"


def watch_clients(recorder: Recorder, client_class: Any) -> None:
    """Record the calls of the program's own clients."""
    send, block = client_class.call_async, client_class.call

    @wraps(send)
    def call_async(client: Any, request: Any) -> Any:
        entity = state_of(client)
        if entity is None:
            with UNSEEN:
                return send(client, request)
        here, service = recorder.here, client.service_name
        call, began, before = recorder.new_id(), now(), time.time_ns()
        with UNSEEN:
            is_offered = client_class.service_is_ready(client)
            future = send(client, request)
        after = time.time_ns()
        recorder.put("called", began, call, service, here.entity, _text_of(request), before, after)
        if not is_offered:
            recorder.put("request_lost", now(), call, service)
        if here.blocks:
            here.blocks = call
            recorder.put("blocked", now(), call, recorder.thread(), here.entity, service)
        calls = Calls(recorder, entity)
        take = calls.traced(future.set_result, lambda here, _response: calls.begin(here, call))

        def set_result(response: Any) -> None:
            recorder.put("service_reply", now(), call, service, _text_of(response))
            take(response)

        future.set_result = set_result
        return future

    @wraps(block)
    def call(client: Any, *args: Any, **kwargs: Any) -> Any:
        if state_of(client) is None:
            with UNSEEN:
                return block(client, *args, **kwargs)
        here = recorder.here
        outer, here.blocks = here.blocks, -1
        try:
            with UNSEEN:
                return block(client, *args, **kwargs)
        finally:
            if here.blocks > 0:
                recorder.put("unblocked", now(), here.blocks, recorder.thread())
            here.blocks = outer

    client_class.call_async = call_async
    client_class.call = call


def watch_services(recorder: Recorder, service_class: Any, rclpy_implementation: Any) -> None:
    """Record the replies of the program's own services.

    The thread that takes a request also learns when that was sent.
    """
    take = rclpy_implementation.Service.service_take_request

    def take_known(service: Any, request_class: Any) -> Any:
        taken = take(service, request_class)
        header = taken[1]
        recorder.here.sent = 0 if header is None else header.source_timestamp
        return taken

    reply = service_class.send_response

    @wraps(reply)
    def send_response(service: Any, response: Any, header: Any) -> None:
        began = now()
        with UNSEEN:
            reply(service, response, header)
        entity, sent = state_of(service), getattr(header, "source_timestamp", 0)
        if entity is not None and sent:
            recorder.put("replied", began, entity.number, sent, _text_of(response))

    rclpy_implementation.Service.service_take_request = take_known
    service_class.send_response = send_response
