"""ROS arguments: remapping, parameters and log levels from a command line."""

from pathlib import Path
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.ros.context.arguments import ArgumentsError, parameters_for, parse_arguments
from sim.ros.context.context import Context
from sim.ros.context.utilities import remove_ros_args
from sim.ros.exceptions import (
    InvalidNamespaceException,
    RCLError,
    RCLInvalidROSArgsError,
    UnknownROSArgsError,
)
from sim.ros.logging.logger import LoggingSeverity, get_logger
from sim.ros.node.node import Node
from sim.ros.scheduling.executors import SingleThreadedExecutor
from sim.trace.events import Notice
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")


def context_with(*arguments: str) -> Context:
    """A context of a program that was given these ROS arguments."""
    context = Context()
    context.init(["program.py", "--ros-args", *arguments])
    return context


def in_a_program(check: Any) -> None:
    simulate(lambda _: check())


def test_a_node_gets_another_name_and_namespace() -> None:
    def check() -> None:
        context = context_with("-r", "__node:=new", "-r", "__ns:=/robot/arm")
        node = Node("old", context=context)
        assert node.get_fully_qualified_name() == "/robot/arm/new"
        assert node.get_logger().name == "robot.arm.new"
        assert node.resolve_topic_name("~/x") == "/robot/arm/new/x"
        assert Node("old", context=context, use_global_arguments=False).get_name() == "old"

    in_a_program(check)


def test_rules_for_one_node_leave_the_others_alone() -> None:
    def check() -> None:
        context = context_with("-r", "a:__node:=b", "-r", "b:__ns:=/x", "-r", "b:t:=u")
        renamed, other = Node("a", context=context), Node("c", context=context)
        assert renamed.get_fully_qualified_name() == "/x/b"
        assert renamed.resolve_topic_name("t") == "/x/u"
        assert (other.get_fully_qualified_name(), other.resolve_topic_name("t")) == ("/c", "/t")

    in_a_program(check)


def test_topics_and_services_are_remapped_by_their_full_names() -> None:
    def check() -> None:
        context = context_with(
            "-r", "scan:=/lidar/scan", "--remap", "/ns/odom:=odometry", "-r", "~/private:=~/secret",
            "-r", "rostopic://both:=topic_only", "-r", "rosservice://power:=motor",
        )  # fmt: skip
        node = Node("n", namespace="ns", context=context)
        assert node.resolve_topic_name("scan") == "/lidar/scan"
        assert node.resolve_topic_name("/ns/scan") == "/lidar/scan"
        assert node.resolve_topic_name("/scan") == "/scan"
        assert node.resolve_topic_name("odom") == "/ns/odometry"
        assert node.resolve_topic_name("odom", only_expand=True) == "/ns/odom"
        assert node.resolve_topic_name("~/private") == "/ns/n/secret"
        assert (node.resolve_topic_name("both"), node.resolve_service_name("both")) == (
            "/ns/topic_only",
            "/ns/both",
        )
        assert (node.resolve_topic_name("power"), node.resolve_service_name("power")) == (
            "/ns/power",
            "/ns/motor",
        )

    in_a_program(check)


def test_the_first_rule_that_fits_counts_and_the_nodes_own_come_first() -> None:
    def check() -> None:
        context = context_with("-r", "t:=a", "-r", "t:=b", "-r", "a:=c")
        assert Node("n", context=context).resolve_topic_name("t") == "/a"
        own = Node("n", context=context, cli_args=["--ros-args", "-r", "t:=own"])
        assert own.resolve_topic_name("t") == "/own"

    in_a_program(check)


def test_what_is_remapped_meets_on_the_new_name() -> None:
    heard: list[int] = []

    def program(_: Simulation) -> None:
        context = context_with("-r", "chatter:=gossip")
        speaker, listener = Node("speaker", context=context), Node("listener")
        publisher = speaker.create_publisher(Int32, "chatter", 10)
        assert publisher.topic_name == "/gossip"
        listener.create_subscription(Int32, "gossip", lambda each: heard.append(each.data), 10)
        publisher.publish(Int32(data=7))
        rclpy.spin_once(listener, timeout_sec=1.0)
        server = speaker.create_service(SetBool, "chatter", lambda _, response: response)
        assert server.service_name == "/gossip"
        assert listener.create_client(SetBool, "/gossip").service_is_ready()

    simulate(program)
    assert heard == [7]


def test_parameters_come_from_the_command_line() -> None:
    def check() -> None:
        context = context_with("-p", "a:=5", "--param", "n:b:='yes'", "-p", "m:c:=1", "-p", "d.e:=[1.5, 2.5]")
        node = Node("n", context=context)
        assert node.declare_parameter("a", 1).value == 5
        assert node.declare_parameter("b", "").value == "yes"
        assert node.declare_parameter("c", 0).value == 0
        assert node.declare_parameter("d.e", [0.0]).value == [1.5, 2.5]
        own = Node("n", context=context, cli_args=["--ros-args", "-p", "a:=6"])
        assert own.declare_parameter("a", 1).value == 6

    in_a_program(check)


def test_parameter_files_reach_the_nodes_they_name(tmp_path: Path) -> None:
    path = tmp_path / "params.yaml"
    path.write_text(
        "/**:\n  ros__parameters: {a: 1, b: 1, c: 1}\n"
        "/*/n:\n  ros__parameters: {b: 2, c: 2}\n"
        "/x/n:\n  ros__parameters: {c: 3}\n"
        "n:\n  ros__parameters: {d: 4}\n"
    )

    def check() -> None:
        context = context_with("--params-file", str(path), "-p", "a:=9")
        node = Node("n", namespace="x", context=context, automatically_declare_parameters_from_overrides=True)
        given = {name: each.value for name, each in node.get_parameters_by_prefix("").items()}
        assert {name: given[name] for name in "abc"} == {"a": 9, "b": 2, "c": 3}
        assert "d" not in given
        root = Node("n", context=context, automatically_declare_parameters_from_overrides=True)
        assert root.get_parameter("d").value == 4
        assert root.get_parameter("b").value == 1

    in_a_program(check)


@pytest.mark.parametrize(
    ("file", "arguments", "told"),
    [
        ("other: {ros__parameters: {a: 1}}", [], ["no node is called /other so far; there is /n"]),
        ("", ["-p", "/other:a:=1"], ["-p /other:a:=1 sets nothing: no node is called /other so far"]),
        ("n: {ros__parameters: {a: 1}}\nother: {ros__parameters: {a: 1}}", ["-p", "a:=1"], []),
        ("/**: {ros__parameters: {a: 1}}", ["-p", "n:a:=1"], []),
    ],
)
def test_parameters_for_no_node_of_the_program_are_told_once_it_spins(
    file: str, arguments: list[str], told: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "p.yaml"
    path.write_text(file)

    def check(simulation: Simulation) -> None:
        node = Node("n", context=context_with("--params-file", str(path), *arguments))
        simulation.outside_node("other")
        for _ in range(2):
            rclpy.spin_once(node, executor=SingleThreadedExecutor(context=node.context), timeout_sec=0.1)

    notices = [each.text for each in simulate(check).events if isinstance(each, Notice)]
    assert len(notices) == len(told)
    assert all(sentence in notice for sentence, notice in zip(told, notices, strict=True))


def test_patterns_stand_for_one_or_any_number_of_names() -> None:
    def fits(pattern: str, name: str) -> bool:
        return bool(parameters_for(name, [parse_arguments(["--ros-args", "-p", f"{pattern}:a:=1"])]))

    assert fits("/**", "/n")
    assert fits("/**", "/a/b/n")
    assert fits("/*", "/n")
    assert not fits("/*", "/a/n")
    assert fits("/**/n", "/a/b/n")
    assert fits("/**/n", "/n")
    assert fits("/a/*/n", "/a/b/n")
    assert not fits("/a/*/n", "/a/n")
    assert fits("n", "/n")
    assert not fits("n", "/a/n")


def test_log_levels_are_set_for_all_loggers_or_for_one() -> None:
    def check() -> None:
        context_with("--log-level", "WARN", "--log-level", "arm.left:=debug")
        assert get_logger("any").get_effective_level() == LoggingSeverity.WARN
        assert get_logger("arm.left.child").get_effective_level() == LoggingSeverity.DEBUG

    in_a_program(check)


def test_ros_arguments_end_at_two_dashes_and_others_are_left_alone() -> None:
    line = ["p", "--fast", "--ros-args", "-p", "a:=1", "--", "-r", "x", "--ros-args", "-r", "t:=u"]
    found = parse_arguments(line)
    assert found.parameters == {"/**": {"a": 1}}
    assert [rule.match for rule in found.remap_rules] == ["t"]
    assert found.unknown == []
    assert remove_ros_args(line) == ["p", "--fast", "-r", "x"]
    assert remove_ros_args(["p", "__node:=other", "a=b"]) == ["p", "a=b"]


def test_switches_and_enclaves_are_accepted() -> None:
    line = ["--ros-args", "--disable-rosout-logs", "--enable-stdout-logs", "-e", "/x", "--ros-args"]
    assert parse_arguments(line).unknown == []


def test_what_is_not_supported_names_itself() -> None:
    with pytest.raises(NotImplementedError, match="--log-config-file is not supported"):
        parse_arguments(["--ros-args", "--log-config-file", "x"])


def test_old_remapping_rules_work_with_a_warning() -> None:
    def program(_: Simulation) -> None:
        context = Context()
        context.init(["p", "t:=u", "http://x:=y", "-D:=1"])
        assert Node("n", context=context).resolve_topic_name("t") == "/u"

    assert simulate(program).said() == [
        "Found remap rule 't:=u'. This syntax is deprecated. Use '--ros-args --remap t:=u' instead."
    ]


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["-r", "x"], "Couldn't parse remap rule: '-r x'. Error: a rule is written as from:=to"),
        (
            ["-r", "/a//b:=c"],
            "Couldn't parse remap rule: '-r /a//b:=c'. Error: the name of a topic or service",
        ),
        (["-r", "__node:=a/b"], "a node's name is wanted instead of 'a/b'"),
        (["-r", "__ns:=x"], "a namespace that begins with '/' is wanted instead of 'x'"),
        (["-r", "*:=x"], "Wildcard '*' is not implemented"),
        (["-r"], "Couldn't parse trailing -r flag. No remap rule found."),
        (["-p", "a=1"], "Couldn't parse parameter override rule: '-p a=1'. Error: a parameter is written as"),
        (["-p", "a:=[1, b]"], "'-p a:=[1, b]'. Error: Sequence should be of same type"),
        (["--param"], "Couldn't parse trailing --param flag. No parameter override rule found."),
        (
            ["--params-file", "/nowhere.yaml"],
            "Couldn't parse params file: '--params-file /nowhere.yaml'. Error: Error opening YAML file",
        ),
        (["--params-file"], "Couldn't parse trailing --params-file flag. No file path provided."),
        (
            ["--log-level", "loud"],
            "Couldn't parse log level: '--log-level loud'. Error: a level is one of unset",
        ),
        (["--log-level"], "Couldn't parse trailing log level flag: '--log-level'. No log level found."),
    ],
)
def test_arguments_that_cannot_be_read_say_which_and_why(arguments: list[str], complaint: str) -> None:
    with pytest.raises(ArgumentsError) as error:
        parse_arguments(["--ros-args", *arguments])
    assert complaint in str(error.value)

    def check() -> None:
        with pytest.raises(RCLError) as of_program:
            context_with(*arguments)
        assert str(of_program.value) == f"failed to initialize rcl: {error.value}"
        with pytest.raises(RCLInvalidROSArgsError) as of_node:
            Node("n", cli_args=["--ros-args", *arguments])
        assert str(of_node.value) == f"Failed to parse ROS arguments: {error.value}"

    in_a_program(check)


def test_unknown_ros_arguments_are_named() -> None:
    def check() -> None:
        with pytest.raises(UnknownROSArgsError, match=r"^Found unknown ROS arguments: \['--what', 'x'\]$"):
            context_with("--what", "x")
        with pytest.raises(UnknownROSArgsError):
            rclpy.create_node("n", cli_args=["--ros-args", "--what"])

    in_a_program(check)


def test_a_context_that_refused_its_arguments_can_begin_with_better_ones() -> None:
    def check() -> None:
        context = Context()
        with pytest.raises(RCLError):
            context.init(["p", "--ros-args", "-r"])
        assert not context.ok()
        context.init(["p"])
        assert context.ok()

    in_a_program(check)


def test_without_arguments_the_programs_own_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["p", "--ros-args", "-r", "__node:=other"])

    def check() -> None:
        context = Context()
        rclpy.init(context=context)
        assert Node("n", context=context).get_name() == "other"
        rclpy.init(args=[], context=(fresh := Context()))
        assert Node("n", context=fresh).get_name() == "n"

    in_a_program(check)


def test_a_namespace_that_ends_with_a_slash_is_refused() -> None:
    def check() -> None:
        assert Node("n", namespace="a/b").get_namespace() == "/a/b"
        assert Node("n", namespace="").get_namespace() == "/"
        with pytest.raises(InvalidNamespaceException):
            Node("n", namespace="a/")

    in_a_program(check)
