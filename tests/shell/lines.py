"""Carries out lines on virtual time, and keeps what they print."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from sim.clock import RunClock
from sim.packages import Packages
from sim.ros.node.node import Node
from sim.ros.scheduling.executors import SingleThreadedExecutor
from sim.shell import OnExit, Running, ShellLine
from sim.shell.model_ground import ModelGround
from tests.support.simulation import Simulation, Trace, simulate


class Said(NamedTuple):
    """A line of output: when (seconds), where, and what."""

    at: float
    error: bool
    text: str


@dataclass
class FakeProgram:
    """A program that ends with ``status`` when it is told to, or with 130 when it is interrupted."""

    on_exit: OnExit
    interrupted: int = 0

    def interrupt(self) -> None:
        self.interrupted += 1
        self.on_exit(130)


@dataclass
class FakeTools:
    """Keeps what a line says and starts."""

    clock: RunClock
    said: list[Said] = field(default_factory=list)
    statuses: list[int] = field(default_factory=list)
    started: list[tuple[object, ...]] = field(default_factory=list)
    programs: list[FakeProgram] = field(default_factory=list)
    exit_status: int | None = 0
    """What a program ends with at once; None: it goes on."""
    known: Packages = field(default_factory=Packages)

    def say(self, text: str, error: bool) -> None:
        assert not self.statuses
        self.said.append(Said(self.clock.now() / 1e9, error, text))

    def ended(self, status: int) -> None:
        self.statuses.append(status)

    def packages(self) -> Packages:
        return self.known

    def start_executable(
        self, package: str, executable: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Running:
        return self._start((package, executable, list(arguments)), on_exit)

    def launch(
        self, package: str | None, launch_file: str, arguments: Sequence[str], on_exit: OnExit
    ) -> Running:
        return self._start((package, launch_file, list(arguments)), on_exit)

    def describe_launch(self, package: str | None, launch_file: str) -> str:
        return f"Arguments of {launch_file} of {package}:\n\n    'speed':"

    def _start(self, what: tuple[object, ...], on_exit: OnExit) -> Running:
        self.started.append(what)
        program = FakeProgram(on_exit)
        self.programs.append(program)
        if self.exit_status is not None:
            on_exit(self.exit_status)
        return program

    @property
    def out(self) -> str:
        """What stands on stdout."""
        return "".join(f"{each.text}\n" for each in self.said if not each.error)

    @property
    def err(self) -> str:
        """What stands on stderr."""
        return "".join(f"{each.text}\n" for each in self.said if each.error)


class Result(NamedTuple):
    """What a line left: its output, its exit status (None: it was still running), and the trace."""

    out: str
    err: str
    status: int | None
    said: list[Said]
    tools: FakeTools
    trace: Trace


Setup = Callable[[Simulation], object]


def carry_out(
    text: str,
    setup: Setup = lambda _: None,
    *,
    at: float = 0.0,
    interrupt_at: float | None = None,
    until: float = 60.0,
    exit_status: int | None = 0,
    packages: Packages | None = None,
) -> Result:
    """Carry out one line among the nodes that ``setup`` makes, for at most ``until`` seconds."""
    kept: list[FakeTools] = []

    def program(simulation: Simulation) -> None:
        tools = FakeTools(simulation.clock, exit_status=exit_status, known=packages or Packages())
        kept.append(tools)
        setup(simulation)
        simulation.sleep(at)
        line = ShellLine(ModelGround(simulation.host), text, tools, tools.say, tools.ended)
        line.start()
        if interrupt_at is not None:
            simulation.at(interrupt_at, line.interrupt)
        while not tools.statuses:
            simulation.sleep(0.01)

    trace = simulate(program, until)
    (tools,) = kept
    status = tools.statuses[0] if tools.statuses else None
    return Result(tools.out, tools.err, status, tools.said, tools, trace)


def spin(simulation: Simulation, *nodes: Node) -> None:
    """Spin nodes of the program on a thread of their own."""
    executor = SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    simulation.start(executor.spin, "MainThread")


def hear(node: Node, message_type: Any, topic: str, heard: list[Any]) -> None:
    """Keep what a node hears."""
    node.create_subscription(message_type, topic, heard.append, 100)


_BROUGHT_BY_EVERY_NODE = ("/parameter_events", "/rosout", "use_sim_time", "start_type_description_service")


def own(out: str) -> str:
    """The lines of output that are not about what every node brings."""
    lines = out.splitlines(keepends=True)
    return "".join(line for line in lines if not any(each in line for each in _BROUGHT_BY_EVERY_NODE))
