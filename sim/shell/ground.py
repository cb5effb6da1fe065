"""The interface between lines and the rclpy that carries them out, modelled or real."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

from sim.interfaces import Kind

if TYPE_CHECKING:
    from sim.ros.context.context import Context
    from sim.ros.node.node import Node

TakeOutput = Callable[[str, bool], None]
"""Takes a line of output, and whether it belongs on stderr."""


class LineSignal(Protocol):
    """A one-shot event that a line waits for."""

    def set(self) -> None:
        """Wake the waiting line."""

    def wait(self, deadline: int | None, /) -> object:
        """Wait until it is set; a line gives no deadline."""


class LineProcess(Protocol):
    """One line's presence on the graph."""

    @property
    def context(self) -> Context:
        """The context of its node."""

    def make_node(self, name: str) -> Node:
        """Make its node, hidden and without parameter services."""

    def free_name(self) -> str:
        """The name of a hidden node that no other node has."""

    def start_thread(self, run: Callable[[], None]) -> None:
        """Run the line; does not wait."""

    def on_own_time(self, deed: Callable[[], None]) -> None:
        """Run an action that does not wait; any thread may call this."""

    def leave(self) -> None:
        """Leave the graph."""


class Ground(Protocol):
    """A ROS graph. Queries do not wait; any thread that has the graph's time may call them."""

    def enter(self, take: TakeOutput) -> LineProcess:
        """Let a line join the graph; ``take`` gets the output of its process."""

    def now(self) -> int:
        """Nanoseconds of a steady clock."""

    def signal(self) -> LineSignal:
        """A signal on the ground's time."""

    def want(self, name: str) -> None:
        """Announce that a line uses a topic or service."""

    def interface(self, kind: Kind, package: str, name: str) -> Any:
        """Return the class of a message, service or action; raise UnknownInterfaceError if there is none."""

    def topics(self) -> dict[str, list[str]]:
        """Every topic and its types."""

    def services(self) -> dict[str, list[str]]:
        """Every service and its types."""

    def nodes(self) -> list[str]:
        """The full name of every node."""

    def parameters(self, node: str) -> list[str]:
        """Return the parameters of a node that are known without waiting."""
