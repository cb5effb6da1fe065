"""Rules that rclpy's own tests hold it to, where none of the other files here has them."""

from array import array
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.interfaces.field_types import NamespacedType
from sim.interfaces.test_msgs.message_fixtures import get_test_msg
from sim.ros.clocks.clock import Clock, JumpThreshold
from sim.ros.context.context import Context
from sim.ros.entities.client import SrvTypeRequest
from sim.ros.entities.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from sim.ros.entities.publisher import MsgType
from sim.ros.entities.serialization import deserialize_message, serialize_message
from sim.ros.entities.type_support import NoTypeSupportImportedException, check_for_type_support
from sim.ros.exceptions import InvalidHandle
from sim.ros.lifecycle import LifecycleNode
from sim.ros.node.node import Node
from sim.ros.node.parameter_event_handler import ParameterEventHandler
from sim.ros.parameters.parameter import Parameter, parameter_dict_from_yaml_file
from sim.ros.qos.qos import QoSProfile, ReliabilityPolicy
from sim.ros.rclpy import executors
from sim.ros.rclpy._qos import qos_overriding_options
from sim.ros.rclpy.constants import S_TO_NS
from sim.ros.rclpy.impl.rcutils_logger import (
    Once,
    SkipFirst,
    Throttle,
    get_filters_from_kwargs,
    supported_filters,
)

Int32 = message("std_msgs", "Int32")
String = message("std_msgs", "String")
SetBool = service("std_srvs", "SetBool")


@pytest.fixture
def context() -> Iterator[Context]:
    made = Context()
    rclpy.init(args=[], context=made)
    yield made
    made.try_shutdown()


@contextmanager
def node_in(context: Context) -> Iterator[Node]:
    node = Node("n", context=context)
    yield node
    node.destroy_node()


@pytest.mark.parametrize(
    "ask",
    [
        Node.get_name,
        Node.get_namespace,
        Node.get_fully_qualified_name,
        Node.get_node_names,
        Node.get_topic_names_and_types,
        lambda node: node.count_publishers("t"),
    ],
)
def test_a_destroyed_node_answers_no_questions(context: Context, ask: Callable[[Node], object]) -> None:
    with node_in(context) as node:
        ask(node)
    with pytest.raises(InvalidHandle):
        ask(node)
    assert "/n" in repr(node)


def test_the_nodes_of_a_context_that_has_ended_are_off_the_graph(context: Context) -> None:
    other = Context()
    rclpy.init(args=[], context=other)
    Node("left_behind", context=other)
    node = Node("n", context=context)
    assert "left_behind" in node.get_node_names()
    other.shutdown()
    assert "left_behind" not in node.get_node_names()
    node.destroy_node()


def test_a_client_knows_its_context(context: Context) -> None:
    with node_in(context) as node:
        assert node.create_client(SetBool, "s").context is context


def test_type_variables_are_where_programs_import_them_from() -> None:
    assert (MsgType.__name__, SrvTypeRequest.__name__) == ("MsgType", "SrvTypeRequest")
    assert S_TO_NS == 10**9
    verdict = qos_overriding_options.QosCallbackResult  # type: ignore[attr-defined]
    assert verdict is message("rcl_interfaces", "SetParametersResult")


def test_what_nobody_handles_has_handlers_that_warn(context: Context) -> None:
    with node_in(context) as node:
        publisher = node.create_publisher(Int32, "t", 10)
        subscription = node.create_subscription(Int32, "t", lambda _: None, 10)
        assert len(publisher.event_handlers) == len(subscription.event_handlers) == 2
        told = PublisherEventCallbacks(
            incompatible_qos=lambda _: None, matched=lambda _: None, use_default_callbacks=False
        )
        assert len(node.create_publisher(Int32, "t", 10, event_callbacks=told).event_handlers) == 2
        silent = SubscriptionEventCallbacks(use_default_callbacks=False)
        quiet = node.create_subscription(Int32, "t", lambda _: None, 10, event_callbacks=silent)
        assert not quiet.event_handlers


def test_types_and_policies_that_do_not_match_are_warned_of_while_spinning(
    context: Context, capsys: pytest.CaptureFixture[str]
) -> None:
    executor = executors.SingleThreadedExecutor(context=context)
    with node_in(context) as node:
        executor.add_node(node)
        node.create_publisher(Int32, "numbers", 10)
        node.create_subscription(String, "numbers", lambda _: None, 10)
        best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        node.create_publisher(Int32, "letters", best_effort)
        node.create_subscription(Int32, "letters", lambda _: None, 10)
        assert not capsys.readouterr().err
        for _ in range(8):
            executor.spin_once(timeout_sec=0)
        warned = capsys.readouterr().err
    for text in (
        "Incompatible type on topic 'numbers', no messages will be sent to it.",
        "Incompatible type on topic 'numbers', no messages will be received from it.",
        "New publisher discovered on topic 'letters', offering incompatible QoS. No messages will be "
        "received from it. Last incompatible policy: RELIABILITY",
    ):
        assert warned.count(text) == 1
    executor.shutdown()


def test_only_a_value_that_was_there_is_told_as_deleted(context: Context) -> None:
    dynamic = message("rcl_interfaces", "ParameterDescriptor")(dynamic_typing=True)
    executor = executors.SingleThreadedExecutor(context=context)
    events: list[Any] = []
    with node_in(context) as node:
        executor.add_node(node)
        node.declare_parameters("", [("full", 1, dynamic), ("empty", None, dynamic)])
        ParameterEventHandler(node).add_parameter_event_callback(events.append)
        node.set_parameters_atomically([Parameter("full"), Parameter("empty")])
        executor.spin_once(timeout_sec=0)
        assert [each.name for each in events[-1].deleted_parameters] == ["full"]
        assert not node.has_parameter("empty")
    executor.shutdown()


@pytest.mark.parametrize(
    ("values", "kept"),
    [(array("i", [1, 2]), "integer_array_value"), (array("f", [1, 2]), "double_array_value")],
)
def test_arrays_of_any_width_become_parameters(values: Any, kept: str) -> None:
    parameter = Parameter("p", value=values)
    assert parameter.value == values
    assert list(getattr(parameter.get_parameter_value(), kept)) == [1, 2]


def test_a_parameter_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"none\.yaml"):
        parameter_dict_from_yaml_file(str(tmp_path / "none.yaml"))


def test_a_threshold_for_no_jump_is_refused() -> None:
    with pytest.raises(ValueError, match="At least one jump threshold must be enabled"):
        JumpThreshold(min_forward=None, min_backward=None, on_clock_change=False)


def test_the_filters_of_log_lines_can_be_used_by_themselves() -> None:
    assert list(supported_filters) == ["throttle", "skip_first", "once"]
    assert get_filters_from_kwargs(once=True, throttle_duration_sec=1.0) == ["throttle", "once"]
    context: dict[str, Any] = {}
    Once.initialize_context(context, once=True)
    SkipFirst.initialize_context(context, skip_first=True)
    Throttle.initialize_context(context, throttle_duration_sec=1e6, throttle_time_source_type=Clock())
    for each, passed in ((Once, [True, False]), (SkipFirst, [False, True]), (Throttle, [True, False])):
        assert [each.should_log(context), each.should_log(context)] == passed
    with pytest.raises(TypeError, match='required parameter "throttle_duration_sec"'):
        Throttle.initialize_context({}, throttle_time_source_type=Clock())


class _WithoutSupport(type):
    _TYPE_SUPPORT: object = None
    support: object = None

    @classmethod
    def __import_type_support__(cls) -> None:
        cls._TYPE_SUPPORT = cls.support


def test_a_foreign_type_needs_its_support() -> None:
    foreign = _WithoutSupport("Foreign", (), {})
    with pytest.raises(NoTypeSupportImportedException):
        check_for_type_support(foreign)
    _WithoutSupport.support = object()
    check_for_type_support(foreign)


def test_messages_take_the_wish_to_be_checked_and_no_other() -> None:
    assert Int32(data=3, check_fields=True) == Int32(data=3)
    with pytest.raises(AssertionError, match="data"):
        Int32(data="3", check_fields=True)
    with pytest.raises(NotImplementedError, match="check_fields"):
        Int32(check_fields=False)
    with pytest.raises(AssertionError, match=r"constructor: other$"):
        Int32(other=1, check_fields=True)


def test_types_of_fields_can_be_changed_by_nobody() -> None:
    Int32.get_fields_and_field_types()["data"] = "x"
    assert Int32._fields_and_field_types == {"data": "int32"}
    assert NamespacedType(["std_msgs", "msg"], "Int32") == NamespacedType(("std_msgs", "msg"), "Int32")


@pytest.mark.parametrize(
    "name", ["Arrays", "BasicTypes", "BoundedSequences", "MultiNested", "WStrings", "Empty"]
)
def test_messages_to_test_with_survive_the_wire(name: str) -> None:
    for each in get_test_msg(name):
        assert deserialize_message(serialize_message(each), type(each)) == each


def test_a_life_cycle_has_a_state_machine_from_the_first(context: Context) -> None:
    node = LifecycleNode("n", context=context)
    assert node._state_machine.initialized
    node.destroy_node()
    with pytest.raises(TypeError, match="enable_communication_interface"):
        LifecycleNode("n", context=context, enable_communication_interface="yes")  # type: ignore[arg-type]
