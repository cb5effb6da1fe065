"""Lines as such: help, mistakes, interrupts, and that two runs print the same."""

import threading

import pytest

from sim.clock import PacedClock
from sim.probes.probe import SilentProbe
from sim.ros.middleware.host import Host
from sim.ros.node.node import Node
from sim.shell import ShellLine, command_names, commands
from sim.shell.model_ground import ModelGround
from tests.shell.lines import FakeTools, carry_out
from tests.support.simulation import Simulation, simulate


def test_help_is_printed_and_ends_well() -> None:
    result = carry_out("ros2 topic pub -h")
    assert result.out.startswith("usage: ros2 topic pub [-h] [-r N] [-p N] [-1 | -t TIMES]")
    assert (result.err, result.status) == ("", 0)


@pytest.mark.parametrize(
    ("line", "start"), [("ros2", "usage: ros2 [-h]"), ("topic", "usage: ros2 topic [-h]")]
)
def test_a_command_without_its_verb_prints_help(line: str, start: str) -> None:
    result = carry_out(line)
    assert result.out.startswith(start)
    assert result.status == 0


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("ros2 topc list", "ros2: error: invalid choice: 'topc'; did you mean topic? (see ros2 -h)"),
        (
            "topic li",
            "ros2 topic: error: invalid choice: 'li'; did you mean list? (see ros2 topic -h)",
        ),
        ("topic echo", "ros2 topic echo: error: the following arguments are required: topic_name"),
        ("topic list --nope", "ros2: error: unrecognized arguments: --nope"),
        ("topic xyz", "ros2 topic: error: invalid choice: 'xyz' (choose from bw, "),
        ("topic echo /t --qos-profile good", "argument --qos-profile: invalid choice: 'good' (choose from "),
    ],
)
def test_a_line_that_is_none_is_refused_in_one_line_with_the_nearest_word(line: str, complaint: str) -> None:
    result = carry_out(line)
    assert complaint in result.err
    assert (result.err.count("\n"), result.out, result.status) == (1, "", 2)


@pytest.mark.parametrize("command", ["bag record", "doctor", "daemon stop"])
def test_commands_of_a_ros_2_machine_are_named_with_what_there_is(command: str) -> None:
    result = carry_out(f"ros2 {command}")
    assert result.err == (
        f"ros2 {command.split(maxsplit=1)[0]} is not carried out here; action, interface, launch, lifecycle, node, param, pkg, run, "  # noqa: E501
        "service and topic are\n"
    )
    assert result.status == 1


def test_other_commands_are_not_found() -> None:
    result = carry_out("cd ~/ros2_ws")
    assert result.status == 127
    assert carry_out("").status == 0


def test_an_unclosed_quote_is_one_sentence() -> None:
    result = carry_out('topic pub /t std_msgs/msg/String "data: x')
    assert (result.err.count("\n"), result.status) == (1, 2)


def test_a_line_leaves_nothing_on_the_network() -> None:
    def program(simulation: Simulation) -> None:
        tools = FakeTools(simulation.clock)
        ShellLine(ModelGround(simulation.host), "topic list", tools, tools.say, tools.ended).start()
        simulation.sleep(1.0)
        assert tools.statuses == [0]
        assert Node("looker").get_node_names() == ["looker"]

    simulate(program)


def test_lines_at_the_same_time_have_nodes_of_their_own() -> None:
    def program(simulation: Simulation) -> None:
        tools = FakeTools(simulation.clock)
        lines = [
            ShellLine(
                ModelGround(simulation.host),
                f"topic pub /t{i} std_msgs/msg/Int32",
                tools,
                tools.say,
                tools.ended,
            )
            for i in range(3)
        ]
        for line in lines:
            line.start()
        simulation.sleep(0.5)
        assert Node("looker").get_node_names() == ["_ros2cli_1", "_ros2cli_2", "_ros2cli_3", "looker"]
        for line in lines:
            line.interrupt()
            simulation.sleep(0.1)
            assert tools.statuses.pop() == 2

    simulate(program)


def test_a_line_can_be_interrupted_before_it_begins() -> None:
    def program(simulation: Simulation) -> None:
        tools = FakeTools(simulation.clock)
        line = ShellLine(
            ModelGround(simulation.host), "topic pub /t std_msgs/msg/Int32", tools, tools.say, tools.ended
        )
        line.interrupt()
        line.start()
        simulation.sleep(0.0)
        assert (tools.said, tools.statuses) == ([], [2])

    simulate(program)


def test_a_thread_outside_the_run_can_interrupt() -> None:
    def program(simulation: Simulation) -> None:
        tools = FakeTools(simulation.clock)
        line = ShellLine(
            ModelGround(simulation.host), "topic echo /t std_msgs/msg/Int32", tools, tools.say, tools.ended
        )
        line.start()
        simulation.sleep(0.1)
        outside = threading.Thread(target=line.interrupt)
        outside.start()
        outside.join()
        simulation.sleep(0.1)
        assert tools.statuses == [2]

    simulate(program)


def test_two_runs_of_a_line_are_alike() -> None:
    def setup(simulation: Simulation) -> None:
        simulation.publisher_at_rate("count", 0.1)

    first, second = (carry_out("topic hz /count", setup, interrupt_at=5.0) for _ in range(2))
    assert first.said == second.said
    assert first.trace.events == second.trace.events


def test_the_end_of_the_run_ends_a_line_without_a_status() -> None:
    result = carry_out("topic pub /t std_msgs/msg/Int32", until=2.5)
    assert (result.status, result.out.count("publishing")) == (None, 3)


def test_looking_for_a_topic_brings_up_what_waits_for_its_use() -> None:
    def when_used(simulation: Simulation) -> None:
        once = iter([lambda: simulation.publisher_at_rate("scan", 0.1, offset=0.5)])
        simulation.host.network.at_use(["/scan"], lambda *_: next(once, lambda: None)())

    assert carry_out("topic echo --once /scan", when_used).out == "data: 0\n---\n"
    assert carry_out("topic list", when_used).out.count("/scan") == 0


def test_lines_run_on_the_real_clock_too() -> None:
    clock = PacedClock()
    tools, ended = FakeTools(clock), threading.Event()
    tools.statuses = _Telling(ended)
    line = ShellLine(
        ModelGround(Host(clock, SilentProbe(clock))),
        "topic pub /t std_msgs/msg/Int32",
        tools,
        tools.say,
        tools.ended,
    )
    line.start()
    while not any("publishing #1" in each.text for each in tools.said):
        clock.sleep(1_000_000)
    line.interrupt()
    assert ended.wait(60.0)
    assert tools.statuses == [2]


class _Telling(list[int]):
    """A list that tells when something was put into it."""

    def __init__(self, filled: threading.Event) -> None:
        super().__init__()
        self._filled = filled

    def append(self, item: int) -> None:
        super().append(item)
        self._filled.set()


def test_every_command_that_is_named_is_there() -> None:
    assert sorted(command_names.COMMANDS) == [each.name for each in commands.COMMANDS]
