"""What lines need of the rclpy that they are carried out with, the model's or the real one."""

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
        """Wake whoever waits."""

    def wait(self, deadline: int | None, /) -> object:
        """Wait until it is set; a line gives no deadline."""


class LineProcess(Protocol):
    """One line's stay on the graph."""

    @property
    def context(self) -> Context:
        """The context of its node."""

    def make_node(self, name: str) -> Node:
        """Make its node, hidden and without parameter services."""

    def free_name(self) -> str:
        """The name of a hidden node that no other node has."""

    def start_thread(self, run: Callable[[], None]) -> None:
        """Have the line carried out; does not wait."""

    def on_own_time(self, deed: Callable[[], None]) -> None:
        """Do something that does not wait, from any thread."""

    def leave(self) -> None:
        """Leave the graph."""


class Ground(Protocol):
    """A ROS graph. Its questions take no time and can be asked on any thread that has the graph's time."""

    def enter(self, take: TakeOutput) -> LineProcess:
        """Have a line join; what its process prints goes to ``take``."""

    def now(self) -> int:
        """Nanoseconds of a steady clock."""

    def signal(self) -> LineSignal:
        """A signal on the ground's time."""

    def want(self, name: str) -> None:
        """Tell that a line is about to use a topic or service."""

    def interface(self, kind: Kind, package: str, name: str) -> Any:
        """The class of a message, service or action; raises UnknownInterfaceError if there is none."""

    def topics(self) -> dict[str, list[str]]:
        """Every topic and its types."""

    def services(self) -> dict[str, list[str]]:
        """Every service and its types."""

    def nodes(self) -> list[str]:
        """The full name of every node."""

    def parameters(self, node: str) -> list[str]:
        """The parameters of a node, as far as they are known at once."""
