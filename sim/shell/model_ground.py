"""Lines on the model of rclpy: each in a context of its own, on the run's time."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from itertools import chain
from typing import Any

from sim import interfaces
from sim.clock import AutoResetEvent, VirtualClock
from sim.interfaces import Kind, type_name
from sim.probes.probe import PublishingProbe
from sim.ros.context.context import Context
from sim.ros.middleware.host import Host
from sim.ros.node.graph import nodes_on
from sim.ros.node.node import Node
from sim.ros.parameters.store import ParameterChange
from sim.shell.ground import TakeOutput

_HIDDEN_NODE_PREFIX = "_ros2cli_"

_FIND: dict[Kind, Callable[[str, str], Any]] = {
    "msg": interfaces.message,
    "srv": interfaces.service,
    "action": interfaces.action,
}


class _LineNode(Node):
    """A line's node: its parameters are set before any other program discovers it."""

    def _publish_parameter_change(self, change: ParameterChange) -> None:
        pass


class _ModelProcess:
    """One line's context, on a thread of its own."""

    def __init__(self, host: Host, take: TakeOutput) -> None:
        self._host = host
        self.context = Context(host=host, probe=PublishingProbe(host.clock, host.probe, with_calls=True))
        self.context.init([])
        self.context.process.output_sink = take

    def make_node(self, name: str) -> Node:
        return _LineNode(name, context=self.context, start_parameter_services=False, enable_rosout=False)

    def free_name(self) -> str:
        with self._host.lock:
            taken = {node.get_name() for node in self.context.network.nodes()}
        number = 1
        while f"{_HIDDEN_NODE_PREFIX}{number}" in taken:
            number += 1
        return f"{_HIDDEN_NODE_PREFIX}{number}"

    def start_thread(self, run: Callable[[], None]) -> None:
        """Start; call it on a thread that has the run's time (see ``Clock.call_at``)."""
        self.context.process.start_thread(run, "ros2")

    def on_own_time(self, deed: Callable[[], None]) -> None:
        clock = self._host.clock
        if isinstance(clock, VirtualClock) and not clock.owns_current_thread():
            clock.time.inject(deed)
        else:
            deed()

    def leave(self) -> None:
        self.context.try_shutdown()


class ModelGround:
    """The graph of a run (see `Ground`). On virtual time, use it on threads of the run."""

    def __init__(self, host: Host) -> None:
        self._host = host

    def enter(self, take: TakeOutput) -> _ModelProcess:
        return _ModelProcess(self._host, take)

    def now(self) -> int:
        return self._host.clock.now()

    def signal(self) -> AutoResetEvent:
        return self._host.clock.auto_reset_event()

    def want(self, name: str) -> None:
        with self._host.lock:
            self._host.network.announce_use(name)

    def interface(self, kind: Kind, package: str, name: str) -> Any:
        return _FIND[kind](package, name)

    def topics(self) -> dict[str, list[str]]:
        def ends(node: Node) -> list[tuple[str, Any]]:
            heard = [(each.topic_name, each.msg_type) for each in node.subscriptions]
            return heard + [(each.topic_name, each.msg_type) for each in node.publishers]

        return self._ends(ends)

    def services(self) -> dict[str, list[str]]:
        return self._ends(lambda node: [(each.name, each.srv_type) for each in node.services])

    def nodes(self) -> list[str]:
        with self._host.lock:
            return [node.get_fully_qualified_name() for node in nodes_on(self._host.network)]

    def parameters(self, node: str) -> list[str]:
        """Return the parameters of a node, also of one that does not spin."""
        with self._host.lock:
            for each in nodes_on(self._host.network):
                if each.get_fully_qualified_name() == node:
                    return list(each.list_parameters([], 0).names)
        return []

    def _ends(self, of: Callable[[Node], Iterable[tuple[str, Any]]]) -> dict[str, list[str]]:
        found: defaultdict[str, set[str]] = defaultdict(set)
        with self._host.lock:
            for name, kind in chain.from_iterable(map(of, nodes_on(self._host.network))):
                found[name].add(type_name(kind))
        return {name: sorted(types) for name, types in found.items()}
