"""What cbtui's own processes on a ROS graph tell on standard output: what they send, as a probe would."""

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
    """Tell one thing. Thread-safe."""
    told = finite(line) if isinstance(line, TraceEvent) else line
    sys.stdout.buffer.write(msgspec.json.encode([told]) + b"\n")
    sys.stdout.buffer.flush()


def publish(publisher: Any, send: Callable[[Any], None], message: Any) -> tuple[int, Sent]:
    """Have ``send`` publish a message; returns its id on the trace, and what is to be told of it."""
    number, t, before = _ids.new_id(), time.monotonic_ns(), time.time_ns()
    send(message)
    return number, Sent(t, number, publisher.topic_name, 0, 0, before, time.time_ns())


def call(client: Any, send: Callable[[Any], Any], request: Any) -> Any:
    """Have ``send`` make a call, and tell of it and of its reply; returns the future."""
    number, t, before = _ids.new_id(), time.monotonic_ns(), time.time_ns()
    future, service = send(request), client.service_name
    tell(Called(t, number, service, 0, repr(request), before, time.time_ns()))
    take = future.set_result

    def replied(response: Any) -> None:
        tell(ServiceReplied(time.monotonic_ns(), number, service, repr(response)))
        take(response)

    future.set_result = replied
    return future
