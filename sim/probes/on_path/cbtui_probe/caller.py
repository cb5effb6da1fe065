"""Calls services on a ROS graph for the person at the console: ``python -m cbtui_probe.caller``.

Each line of standard input is a service call: the service's type, candidate names (the first service of that
type is called), and the request's fields. Standard output has the calls in the probe's format.
"""

from __future__ import annotations

import importlib
import json
import sys
import threading
import time
from typing import Any

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

from .recorder import Recorder, now

_TO_APPEAR = 5.0
"""Seconds for which a call waits until its service is there: Fast DDS repeats a lost announcement after 3."""


class _Caller:
    """Calls services, with one client each."""

    def __init__(self) -> None:
        self._node = rclpy.create_node("_cbtui", enable_rosout=False, start_parameter_services=False)
        self._clients: dict[tuple[str, str], Any] = {}
        self._ids = Recorder()
        executor = SingleThreadedExecutor()
        executor.add_node(self._node)
        self._spinning = threading.Thread(target=self._spin, args=(executor,), daemon=True)
        self._spinning.start()

    def _spin(self, executor: Any) -> None:
        try:
            executor.spin()
        except (KeyboardInterrupt, ExternalShutdownException):
            return

    def end(self) -> None:
        """Leave the graph, and with it Fast DDS's shared memory."""
        rclpy.try_shutdown()
        self._spinning.join()

    def call(self, service_type: str, names: list[str], fields: dict[str, Any]) -> None:
        """Make one call, and report it and its reply."""
        name = self._offered(service_type, names)
        package, _, class_name = service_type.split("/")
        service = getattr(importlib.import_module(f"{package}.srv"), class_name)
        key = (service_type, name)
        if key not in self._clients:
            self._clients[key] = self._node.create_client(service, name)
        client = self._clients[key]
        request, call = service.Request(**fields), self._ids.new_id()
        there = client.wait_for_service(timeout_sec=_TO_APPEAR)
        began, before = now(), time.time_ns()
        future = client.call_async(request) if there else None
        _tell("called", began, call, name, 0, repr(request), before, time.time_ns())
        if future is None:
            _tell("request_lost", now(), call, name)
            _tell("notice", now(), "WARN", f"nobody offers {name} yet, so the call is lost")
        else:
            future.add_done_callback(
                lambda done: _tell("service_reply", now(), call, name, repr(done.result()))
            )

    def _offered(self, service_type: str, names: list[str]) -> str:
        """The first name that discovery knows as a service of that type, else the first name."""
        types = dict(self._node.get_service_names_and_types())
        return next((name for name in names if service_type in types.get(name, ())), names[0])


def _tell(*event: Any) -> None:
    sys.stdout.write(json.dumps([event]) + "\n")
    sys.stdout.flush()


def main() -> None:
    """Make the calls that standard input asks for, until it ends."""
    rclpy.init()
    caller = _Caller()
    for line in sys.stdin:
        caller.call(*json.loads(line))
    caller.end()


if __name__ == "__main__":
    main()
