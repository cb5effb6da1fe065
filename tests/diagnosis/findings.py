"""What the rules find in a simulation, in a form that tests compare; and parts of programs."""

from collections.abc import Callable
from typing import Any

from sim.diagnosis import Explanation, Finding, Weight, diagnose
from sim.interfaces import message, service
from sim.ros.node.node import Node
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from sim.trace.events import RunEnded
from tests.support.simulation import Program, Simulation, Trace, simulate

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")
ONCE = 10**12
"""Nanoseconds of a period that sets in after a timer's first call."""


class Diagnosed:
    """A finished simulation and what was found in it."""

    def __init__(self, trace: Trace) -> None:
        self.trace = trace
        self.timeline = trace.timeline()
        self.findings = diagnose(self.timeline)

    def told(self) -> set[tuple[str, str]]:
        """Each finding as its rule and the callback it is about (a client: its service)."""
        names = {**self.trace.names, 0: ""}
        return {(each.rule.id, names[each.subject]) for each in self.findings}

    def problems(self) -> set[tuple[str, str]]:
        """As ``told``, without remarks."""
        names = {**self.trace.names, 0: ""}
        return {
            (each.rule.id, names[each.subject])
            for each in self.findings
            if each.weight_in(self.timeline) is Weight.PROBLEM
        }

    def one(self, rule: str) -> Finding:
        """The one finding of a rule."""
        (found,) = (each for each in self.findings if each.rule.id == rule)
        return found

    def explained(self, rule: str) -> Explanation:
        """The one finding of a rule, in words."""
        found = self.one(rule)
        return found.explained(self.timeline)


def diagnosed(program: Program, until: float = 10.0) -> Diagnosed:
    """Run a program on virtual time and look what the rules find."""
    over: list[RunEnded] = []

    def to_its_end(simulation: Simulation) -> None:
        try:
            program(simulation)
        finally:
            over.append(RunEnded(simulation.clock.now(), "the program is over", failed=False))

    trace = simulate(to_its_end, until=until)
    return Diagnosed(Trace([*trace.events, *over]))


def executor_of(threads: int | None) -> Executor:
    """A SingleThreadedExecutor for None, else a MultiThreadedExecutor with so many threads."""
    return SingleThreadedExecutor() if threads is None else MultiThreadedExecutor(threads)


def spin(node: Node, threads: int | None) -> None:
    """Spin a node alone with so many threads."""
    executor = executor_of(threads)
    executor.add_node(node)
    executor.spin()


def once(node: Node, at: float, callback: Callable[[], object], group: Any = None) -> None:
    """Have a timer call back once, at that time."""
    node.create_timer(at, callback, group).timer_period_ns = ONCE


def serve_outside(simulation: Simulation, name: str = "/outside", seconds: float = 0.0) -> None:
    """Offer a SetBool service in another process."""
    node = simulation.outside_node("server")

    def serve(_: object, response: object) -> object:
        simulation.sleep(seconds)
        return response

    node.create_service(SetBool, name, serve)
    simulation.spin_outside(node)
