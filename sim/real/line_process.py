"""Runs ``ros2`` lines on real rclpy: ``python -m sim.real.line_process [FOLDER…]``.

Each line of standard input is a request (``sim.real.wire.LineRequest``). Standard output has, in the probe's
format, what the ``ros2`` lines print and send, and how they end. The folders are searched for packages. All
lines share one context, so that discovery is over when a line needs the graph.
"""

import importlib
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter_client import AsyncParameterClient

from sim.engine import commands
from sim.interfaces import Kind, UnknownInterfaceError
from sim.packages import Packages, find_packages, use_packages
from sim.real import stand_in, telling
from sim.real.wire import Interrupted, NodesKnown, ProgramEnded, ProgramWanted, decode_request
from sim.trace.events import LineCompleted, LineEnded, LineSaid

stand_in.install()

from sim.shell import OnExit, ShellLine, complete, word_start  # noqa: E402 -- with rclpy's modules

_TO_DISCOVER = 1.0
"""Seconds after its start for which lines wait, so that discovery finds the graph."""
_TO_FIND = 5.0
"""Seconds for which a line waits at most until discovery has found the nodes that the run knows."""
_LOOK = 0.02
_TO_TELL = 0.5
"""Seconds that a node has to list its parameters for completion."""

now = time.monotonic_ns


class _Signal:
    """A signal for a thread to wait for."""

    def __init__(self) -> None:
        self._event = threading.Event()
        self.set = self._event.set

    def wait(self, _deadline: int | None) -> object:
        """Wait until it is set."""
        return self._event.wait()


class _RosLineNode(Node):  # type: ignore[misc] # rclpy's classes are not typed
    """The node of a line, which reports the messages and requests that it sends."""

    def create_publisher(self, *args: Any, **kwargs: Any) -> Any:
        """Make a publisher that reports what it publishes."""
        publisher = super().create_publisher(*args, **kwargs)
        if publisher.topic_name != "/parameter_events":
            publisher.publish = partial(_publish, publisher, publisher.publish)
        return publisher

    def create_client(self, *args: Any, **kwargs: Any) -> Any:
        """Make a client that reports its calls."""
        client = super().create_client(*args, **kwargs)
        client.call_async = partial(telling.call, client, client.call_async)
        return client


def _publish(publisher: Any, send: Callable[[Any], None], message: Any) -> None:
    telling.tell(telling.publish(publisher, send, message)[1])


class _Process:
    """A line as a process on the graph; it runs on a thread."""

    def __init__(self, ground: "RealGround") -> None:
        self._ground = ground
        self.context = ground.context

    def make_node(self, name: str) -> Any:
        """Make the line's node."""
        options = {"start_parameter_services": False, "enable_rosout": False, "use_global_arguments": False}
        return _RosLineNode(name, context=self.context, **options)

    def free_name(self) -> str:
        """The name of a hidden node that no other has."""
        return f"_ros2cli_{os.getpid()}_{next(self._ground.numbers)}"

    def start_thread(self, run: Callable[[], None]) -> None:
        """Run the line on a thread, once discovery has found the graph."""

        def begin() -> None:
            self._ground.discover()
            run()

        threading.Thread(target=begin, daemon=True).start()

    def on_own_time(self, deed: Callable[[], None]) -> None:
        """Run it at once."""
        deed()

    def leave(self) -> None:
        """Do nothing: the node is destroyed already, and all lines share the context."""


class RealGround:
    """The graph of the environment's ROS domain."""

    def __init__(self) -> None:
        self.context = rclpy.get_default_context()
        self.numbers = count(1)
        self._known_at = time.monotonic() + _TO_DISCOVER
        options = {"start_parameter_services": False, "enable_rosout": False}
        self._node = rclpy.create_node("_cbtui_lines", **options)
        self.unfound: set[str] = set()
        """The nodes that the run knows and discovery has not found yet."""
        self.now = now
        self.signal = _Signal

    def discover(self) -> None:
        """Wait until discovery has had its time, and has found the nodes that the run knows."""
        time.sleep(max(0.0, self._known_at - time.monotonic()))
        given_up_at = time.monotonic() + _TO_FIND
        wanted = self.unfound.copy()
        while wanted.difference(self.nodes()) and time.monotonic() < given_up_at:
            time.sleep(_LOOK)
        self.unfound -= wanted

    def enter(self, _take: object) -> _Process:
        """Add a line to the graph."""
        return _Process(self)

    def want(self, name: str) -> None:
        """Do nothing: all nodes run already."""

    def interface(self, kind: Kind, package: str, name: str) -> Any:
        """The class, as a program would import it; raises UnknownInterfaceError if there is none."""
        try:
            return getattr(importlib.import_module(f"{package}.{kind}"), name)
        except ModuleNotFoundError:
            raise UnknownInterfaceError(f"there is no {package}.{kind} for cbtui's own Python") from None
        except AttributeError:
            raise UnknownInterfaceError(f"{package} has no {kind} {name}") from None

    def topics(self) -> dict[str, list[str]]:
        """Every topic and its types."""
        return dict(self._node.get_topic_names_and_types())

    def services(self) -> dict[str, list[str]]:
        """Every service and its types."""
        return dict(self._node.get_service_names_and_types())

    def nodes(self) -> list[str]:
        """The full name of every node."""
        return list(self._node.get_fully_qualified_node_names())

    def parameters(self, node: str) -> list[str]:
        """The parameters of a node; empty if it does not reply soon."""
        client = AsyncParameterClient(self._node, node)
        if not client.services_are_ready():
            return []
        executor = SingleThreadedExecutor()
        executor.add_node(self._node)
        future = client.list_parameters()
        executor.spin_until_future_complete(future, _TO_TELL)
        executor.remove_node(self._node)
        return list(future.result().result.names) if future.done() else []


class _Program:
    """Programs that the run started for a line."""

    def __init__(self, line: int, on_exit: OnExit) -> None:
        self._line = line
        self.on_exit = on_exit

    def interrupt(self) -> None:
        """Ask the run to end them as Ctrl-C would."""
        telling.tell(Interrupted(now(), self._line))


@dataclass
class _RealStarter:
    """Reports to the run what one line prints, and which programs it starts."""

    line: int
    lines: "_Lines"

    def say(self, text: str, error: bool) -> None:
        """Report a line of output."""
        telling.tell(LineSaid(now(), self.line, text, error))

    def ended(self, status: int) -> None:
        """Report the exit status."""
        self.lines.running.pop(self.line, None)
        telling.tell(LineEnded(now(), self.line, status))

    def packages(self) -> Packages:
        """The packages that were found."""
        return self.lines.packages

    def start_executable(
        self, package: str, executable: str, arguments: Sequence[str], on_exit: OnExit
    ) -> _Program:
        """Ask the run to start a program of a package."""
        return self._start((package, executable), arguments, on_exit, is_launch=False)

    def launch(
        self, package: str | None, launch_file: str, arguments: Sequence[str], on_exit: OnExit
    ) -> _Program:
        """Ask the run to start a launch file."""
        return self._start((package or "", launch_file), arguments, on_exit, is_launch=True)

    def _start(
        self, what: tuple[str, str], arguments: Sequence[str], on_exit: OnExit, *, is_launch: bool
    ) -> _Program:
        program = self.lines.programs[self.line] = _Program(self.line, on_exit)
        telling.tell(ProgramWanted(now(), self.line, *what, tuple(arguments), is_launch))
        return program

    def describe_launch(self, package: str | None, launch_file: str) -> str:
        """What ``ros2 launch --show-args`` prints of a launch file."""
        from sim.launch import describe_arguments

        known = self.packages()
        return describe_arguments(
            Path(launch_file) if package is None else known.package(package).launch_file(launch_file)
        )


class _Lines:
    """The lines that run."""

    def __init__(self, folders: Sequence[str]) -> None:
        self._ground = RealGround()
        self.packages = find_packages(map(Path, folders))
        use_packages(self.packages)
        self.running: dict[int, ShellLine] = {}
        self.programs: dict[int, _Program] = {}

    def _line(self, number: int, text: str) -> ShellLine:
        starter = _RealStarter(number, self)
        return ShellLine(self._ground, text, starter, starter.say, starter.ended)

    def obey(self, request: object) -> None:
        """Carry out a request of the run."""
        match request:
            case commands.RunLine(line=number, text=text):
                line = self.running[number] = self._line(number, text)
                line.start()
            case commands.InterruptLine(line=number) if number in self.running:
                self.running[number].interrupt()
            case commands.CompleteLine(line=number, text=text, cursor=cursor):
                words = complete(self._ground, self.packages, text, cursor)
                telling.tell(LineCompleted(now(), number, word_start(text, cursor), tuple(words)))
            case NodesKnown(names=names):
                self._ground.unfound.update(names)
            case ProgramEnded(line=number, status=status) if number in self.programs:
                self.programs.pop(number).on_exit(status)
            case _:
                pass


def main() -> None:
    """Run lines until standard input ends."""
    rclpy.init()
    lines = _Lines(sys.argv[1:])
    for request in sys.stdin.buffer:
        lines.obey(decode_request(request))


if __name__ == "__main__":
    main()
