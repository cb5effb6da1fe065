"""Service calls from outside the program, as ``ros2 service call`` would send them."""

from collections.abc import Callable
from typing import Any

from sim.interfaces import service
from sim.ros.middleware.delivery import Request
from sim.ros.middleware.host import Host
from sim.trace.events import AnyEvent, CommandGiven, CommandKind, Notice, Severity


class Requests:
    """Sends requests to services. Call it on threads that have the run's time (see ``Clock.call_at``)."""

    def __init__(self, host: Host, record: Callable[[AnyEvent], None]) -> None:
        self._host = host
        self._record = record

    def set_bool(self, name: str | None, data: bool) -> None:
        """Call a SetBool service, the program's first for None; if nobody offers it, a notice says so."""
        srv_type = service("std_srvs", "SetBool")
        if name is None:
            name = self._first_offered(srv_type)
        if name is None:
            text = "the program offers no SetBool service yet, so the call is lost"
            self._record(Notice(self._host.clock.now(), Severity.WARN, text))
            return
        self._send(name, srv_type, srv_type.Request(data=data), f"call {name} {str(data).lower()}")

    def _first_offered(self, srv_type: Any) -> str | None:
        with self._host.lock:
            offered = self._host.network.services(srv_type)
        return next((each.name for each in offered if each.is_shown), None)

    def reset_world(self) -> None:
        """Call ``/reset_world``."""
        srv_type = service("std_srvs", "Empty")
        self._send("/reset_world", srv_type, srv_type.Request(), "reset the world")

    def _send(self, name: str, srv_type: Any, data: Any, text: str) -> None:
        host = self._host
        with host.lock:
            now = host.clock.now()
            self._record(CommandGiven(now, text, CommandKind.CALL))
            call = host.probe.call_id()
            host.probe.service_called(call, name, data)
            request = Request(data, call, now, lambda _response: None)
            if not host.network.send_request(name, srv_type, request):
                host.probe.request_lost(call, name)
                self._record(Notice(now, Severity.WARN, f"nobody offers {name} yet, so the call is lost"))
