"""Reports what cbtui's own processes send on a ROS graph: on standard output, in the probe's format."""

import sys
import time
from collections.abc import Callable
from typing import Any

import msgspec

from sim.probes.on_path.cbtui_probe.recorder import Recorder
from sim.real.wire import Called, ProbeLine, Sent, finite
from sim.trace.events import ServiceReplied, TraceEvent

_ids = Recorder()


def tell(line: ProbeLine) -> None:
    """Write one event. Thread-safe."""
    told = finite(line) if isinstance(line, TraceEvent) else line
    sys.stdout.buffer.write(msgspec.json.encode([told]) + b"\n")
    sys.stdout.buffer.flush()


def publish(publisher: Any, send: Callable[[Any], None], message: Any) -> tuple[int, Sent]:
    """Publish a message with ``send``; returns its id on the trace, and the event to report."""
    number, t, before = _ids.new_id(), time.monotonic_ns(), time.time_ns()
    send(message)
    return number, Sent(t, number, publisher.topic_name, 0, 0, before, time.time_ns())


def call(client: Any, send: Callable[[Any], Any], request: Any) -> Any:
    """Make a service call with ``send``, and report it and its reply; returns the future."""
    number, t, before = _ids.new_id(), time.monotonic_ns(), time.time_ns()
    future, service = send(request), client.service_name
    tell(Called(t, number, service, 0, repr(request), before, time.time_ns()))
    take = future.set_result

    def replied(response: Any) -> None:
        tell(ServiceReplied(time.monotonic_ns(), number, service, repr(response)))
        take(response)

    future.set_result = replied
    return future
