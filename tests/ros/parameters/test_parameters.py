"""Parameters of a node: declared, typed, limited, overridden, set through callbacks, described."""

from collections.abc import Callable
from typing import Any

import pytest

from sim.interfaces import rcl_interfaces as rcl
from sim.ros.exceptions import (
    InvalidParameterException,
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from sim.ros.node.node import Node
from sim.ros.parameters.parameter import Parameter
from tests.support.simulation import simulate

Type = Parameter.Type


def with_node(check: Callable[[Node], object], **settings: Any) -> None:
    """Run ``check`` on a node of a simulated program."""
    simulate(lambda _: check(Node("n", **settings)))


def refused(reason: str) -> Any:
    return rcl.SetParametersResult(successful=False, reason=reason)


def test_a_declared_parameter_has_the_type_of_its_default_value() -> None:
    def check(node: Node) -> None:
        for value, expected in (
            (True, Type.BOOL),
            (1, Type.INTEGER),
            (1.5, Type.DOUBLE),
            ("a", Type.STRING),
            ([b"x"], Type.BYTE_ARRAY),
            ([True], Type.BOOL_ARRAY),
            ([1, 2], Type.INTEGER_ARRAY),
            ([1.0], Type.DOUBLE_ARRAY),
            (["a"], Type.STRING_ARRAY),
        ):
            name = expected.name.lower()
            declared = node.declare_parameter(name, value)
            assert (declared.name, declared.type_, declared.value) == (name, expected, value)
            assert node.get_parameter(name) is declared
            assert node.describe_parameter(name).type == expected.value

    with_node(check)


def test_every_node_has_the_parameters_that_rclpy_gives_it() -> None:
    def check(node: Node) -> None:
        assert node.list_parameters([], 0).names == ["use_sim_time", "start_type_description_service"]
        assert node.get_parameter("use_sim_time").value is False
        (result,) = node.set_parameters([Parameter("start_type_description_service", value=False)])
        assert result == refused("Trying to set a read-only parameter: start_type_description_service.")

    with_node(check)


def test_use_sim_time_takes_truth_values_only() -> None:
    def check(node: Node) -> None:
        assert node.set_parameters([Parameter("use_sim_time", value=True)])[0].successful
        with pytest.raises(
            InvalidParameterTypeException, match=r"^Trying to set parameter 'use_sim_time' to '1'"
        ):
            Node("m", cli_args=["--ros-args", "-p", "use_sim_time:=1"])

    with_node(check)


def test_a_parameter_is_declared_once_with_a_name() -> None:
    def check(node: Node) -> None:
        node.declare_parameter("a", 1)
        with pytest.raises(ParameterAlreadyDeclaredException) as twice:
            node.declare_parameter("a", 2)
        assert str(twice.value) == "Parameter(s) already declared: ['a']"
        with pytest.raises(InvalidParameterException):
            node.declare_parameter("", 1)

    with_node(check)


def test_declarations_share_a_namespace_and_are_checked_for_their_form() -> None:
    def check(node: Node) -> None:
        unit = rcl.ParameterDescriptor(description="in metres")
        declared = node.declare_parameters(
            "arm", [("length", 2.0, unit), ("name", "left"), ("load", Type.DOUBLE)]
        )
        assert [each.name for each in declared] == ["arm.length", "arm.name", "arm.load"]
        assert node.describe_parameter("arm.length").description == "in metres"
        by_prefix = node.get_parameters_by_prefix("arm")
        assert {name: each.value for name, each in by_prefix.items()} == {
            "length": 2.0,
            "name": "left",
            "load": None,
        }
        with pytest.raises(TypeError, match=r"^First element 5 at index 0 in parameters list is not a str"):
            node.declare_parameters("", [(5,)])
        with pytest.raises(TypeError, match="is not a ParameterDescriptor"):
            node.declare_parameters("", [("x", 1, "text")])
        with pytest.raises(TypeError, match="expecting length between 1 and 3"):
            node.declare_parameters("", [()])
        with pytest.raises(ValueError, match="statically typed of type NOT_SET"):
            node.declare_parameter("x", Type.NOT_SET)

    with_node(check)


def test_a_parameter_declared_by_its_name_alone_is_dynamically_typed_and_deprecated() -> None:
    def check(node: Node) -> None:
        with pytest.warns(UserWarning, match="declaring a parameter only providing its name is deprecated"):
            node.declare_parameter("a")
        assert node.get_parameter("a").type_ is Type.NOT_SET
        assert node.set_parameters([Parameter("a", value=1)])[0].successful
        assert node.set_parameters([Parameter("a", value="one")])[0].successful
        assert node.get_parameter_type("a") is Type.STRING

    with_node(check)


def test_a_parameter_with_a_type_but_no_value_cannot_be_read() -> None:
    def check(node: Node) -> None:
        node.declare_parameter("a", Type.INTEGER)
        with pytest.raises(
            ParameterUninitializedException, match=r"^The parameter 'a' is not initialized: a$"
        ):
            node.get_parameter("a")
        assert node.get_parameter_or("a", Parameter("a", value=7)).value == 7
        assert node.get_parameter_or("nowhere").type_ is Type.NOT_SET
        node.set_parameters([Parameter("a", value=3)])
        assert node.get_parameter("a").value == 3

    with_node(check)


def test_what_is_not_declared_cannot_be_read_set_described_or_removed() -> None:
    def check(node: Node) -> None:
        node.declare_parameter("known", 1)
        for attempt in (
            lambda: node.get_parameter("x"),
            lambda: node.get_parameters(["known", "x"]),
            lambda: node.get_parameter_type("x"),
            lambda: node.get_parameter_types(["x"]),
            lambda: node.describe_parameter("x"),
            lambda: node.describe_parameters(["x"]),
            lambda: node.undeclare_parameter("x"),
            lambda: node.set_parameters([Parameter("known", value=2), Parameter("x", value=1)]),
            lambda: node.set_parameters_atomically([Parameter("x", value=1)]),
            lambda: node.set_descriptor("x", rcl.ParameterDescriptor()),
        ):
            with pytest.raises(ParameterNotDeclaredException, match="Invalid access to undeclared parameter"):
                attempt()
        assert node.get_parameter("known").value == 1
        with pytest.raises(ParameterNotDeclaredException) as missing:
            node.get_parameter("x")
        assert str(missing.value) == "Invalid access to undeclared parameter(s): x"

    with_node(check)


def test_a_node_may_allow_undeclared_parameters() -> None:
    def check(node: Node) -> None:
        assert node.get_parameter("x").type_ is Type.NOT_SET
        assert node.get_parameter_type("x") is Type.NOT_SET
        assert node.set_parameters([Parameter("x", value=1)])[0].successful
        assert node.set_parameters([Parameter("x", value="now a text")])[0].successful
        assert node.describe_parameter("x").dynamic_typing
        assert node.set_parameters([Parameter("x")])[0].successful
        assert not node.has_parameter("x")

    with_node(check, allow_undeclared_parameters=True)


def test_a_static_type_stays() -> None:
    def check(node: Node) -> None:
        node.declare_parameter("a", 1.0)
        (result,) = node.set_parameters([Parameter("a", value=1)])
        assert result == refused("Wrong parameter type, expected 'Type.DOUBLE' got 'Type.INTEGER'")
        (result,) = node.set_parameters([Parameter("a")])
        assert result == refused("Static parameter cannot be undeclared")
        assert node.get_parameter("a").value == 1.0

    with_node(check)


def test_read_only_parameters_are_neither_set_nor_removed() -> None:
    def check(node: Node) -> None:
        node.declare_parameter("a", 1, rcl.ParameterDescriptor(read_only=True))
        node.declare_parameter("b", 1)
        assert not node.set_parameters([Parameter("a", value=2)])[0].successful
        with pytest.raises(
            ParameterImmutableException, match=r"^Attempted to modify read-only parameter: a$"
        ):
            node.undeclare_parameter("a")
        with pytest.raises(ParameterImmutableException):
            node.set_descriptor("a", rcl.ParameterDescriptor())
        node.undeclare_parameter("b")
        assert not node.has_parameter("b")
        node.declare_parameter("b", "another type")

    with_node(check)


def test_integers_keep_within_their_range_and_on_its_steps() -> None:
    def check(node: Node) -> None:
        limits = rcl.IntegerRange(from_value=0, to_value=10, step=4)
        node.declare_parameter("a", 4, rcl.ParameterDescriptor(integer_range=[limits]))
        results = {
            value: node.set_parameters([Parameter("a", value=value)])[0] for value in (0, 8, 10, 5, 11, -1)
        }
        assert [value for value, result in results.items() if result.successful] == [0, 8, 10]
        assert results[11].reason == "Parameter a out of range. Min: 0, Max: 10, value: 11"
        assert results[5].reason == (
            "The parameter value for a is not a valid step. Min: 0, max: 10, value: 5, step: 4"
        )
        with pytest.raises(InvalidParameterValueException, match="Reason: Parameter b out of range"):
            node.declare_parameter("b", 12, rcl.ParameterDescriptor(integer_range=[limits]))
        assert not node.has_parameter("b")

    with_node(check)


def test_floats_keep_within_their_range_but_for_rounding() -> None:
    def check(node: Node) -> None:
        limits = rcl.FloatingPointRange(from_value=1.0, to_value=0.0, step=0.1)
        node.declare_parameter("a", 0.5, rcl.ParameterDescriptor(floating_point_range=[limits]))
        results = {
            value: node.set_parameters([Parameter("a", value=value)])[0]
            for value in (0.1 + 0.2, 1.0 + 1e-9, 0.55, 1.1)
        }
        assert [value for value, result in results.items() if result.successful] == [0.1 + 0.2, 1.0 + 1e-9]
        assert results[1.1].reason == "Parameter a out of range Min: 0.0, Max: 1.0, value: 1.1"
        assert "is not close enough to a valid step" in results[0.55].reason

    with_node(check)


def test_setting_atomically_sets_all_or_nothing() -> None:
    def check(node: Node) -> None:
        node.declare_parameters("", [("a", 1), ("b", 1)])
        assert not node.set_parameters_atomically(
            [Parameter("a", value=2), Parameter("b", value="wrong")]
        ).successful
        assert node.get_parameter("a").value == 1
        first, second = node.set_parameters([Parameter("a", value=2), Parameter("b", value="wrong")])
        assert (first.successful, second.successful) == (True, False)
        assert node.get_parameter("a").value == 2
        with pytest.raises(TypeError, match="must be instance of type"):
            node.set_parameters([("a", 5)])  # type: ignore[list-item]

    with_node(check)


def test_the_newest_callback_is_asked_first_and_the_first_refusal_counts() -> None:
    def check(node: Node) -> None:
        asked: list[str] = []

        def older(parameters: list[Parameter[Any]]) -> Any:
            asked.append("older")
            return rcl.SetParametersResult(successful=True)

        def newer(parameters: list[Parameter[Any]]) -> Any:
            asked.append("newer")
            (parameter,) = parameters
            return refused("too big") if parameter.value > 5 else rcl.SetParametersResult(successful=True)

        node.add_on_set_parameters_callback(older)
        node.add_on_set_parameters_callback(newer)
        node.declare_parameter("a", 1)
        assert asked == ["newer", "older"]
        assert node.set_parameters([Parameter("a", value=9)]) == [refused("too big")]
        assert asked == ["newer", "older", "newer"]
        with pytest.raises(InvalidParameterValueException) as error:
            node.declare_parameter("b", 9)
        assert str(error.value) == "Invalid parameter value (9) for parameter. Reason: too big: b"
        node.remove_on_set_parameters_callback(newer)
        assert node.set_parameters([Parameter("a", value=9)])[0].successful
        with pytest.raises(ValueError, match="not in list"):
            node.remove_on_set_parameters_callback(newer)

    with_node(check)


def test_a_callback_that_forgets_its_result_refuses() -> None:
    def check(node: Node) -> None:
        node.declare_parameter("a", 1)
        node.add_on_set_parameters_callback(lambda _: None)
        with pytest.warns(UserWarning, match="Callback returned an invalid type, it should return Set"):
            told = node.set_parameters([Parameter("a", value=2)])
        assert told == [refused("Callback returned an invalid type")]
        assert node.get_parameter("a").value == 1

    with_node(check)


def test_pre_set_callbacks_change_what_is_set_and_post_set_callbacks_hear_of_it() -> None:
    def check(node: Node) -> None:
        node.declare_parameters("", [("a", 1), ("b", 1)])
        heard: list[list[tuple[str, int]]] = []
        values_then: list[int] = []

        def both(parameters: list[Parameter[Any]]) -> list[Parameter[Any]]:
            return [*parameters, Parameter("b", value=parameters[0].value * 10)]

        def hear(parameters: list[Parameter[Any]]) -> None:
            heard.append([(each.name, each.value) for each in parameters])
            values_then.append(node.get_parameter("b").value)

        node.add_pre_set_parameters_callback(both)
        node.add_post_set_parameters_callback(hear)
        assert node.set_parameters([Parameter("a", value=3)])[0].successful
        assert heard == [[("a", 3), ("b", 30)]]
        assert values_then == [30]
        node.remove_pre_set_parameters_callback(both)
        node.add_pre_set_parameters_callback(lambda _: [])
        (result,) = node.set_parameters([Parameter("a", value=4)])
        assert result.reason.startswith("parameter list cannot be empty")
        node.remove_post_set_parameters_callback(hear)
        assert len(heard) == 1

    with_node(check)


def test_a_new_descriptor_keeps_the_value_if_it_can() -> None:
    def check(node: Node) -> None:
        node.declare_parameter("a", 5)
        small = rcl.ParameterDescriptor(integer_range=[rcl.IntegerRange(from_value=0, to_value=3)])
        with pytest.raises(InvalidParameterValueException):
            node.set_descriptor("a", small)
        assert node.describe_parameter("a").integer_range == []
        value = node.set_descriptor("a", small, Parameter("a", value=2).get_parameter_value())
        assert value.integer_value == 2
        assert node.get_parameter("a").value == 2
        assert node.describe_parameter("a") == small
        assert node.set_descriptor("a", rcl.ParameterDescriptor(description="free")).integer_value == 2

    with_node(check)


def test_overrides_count_before_defaults_unless_they_are_ignored() -> None:
    def check(node: Node) -> None:
        assert node.declare_parameter("a", 1).value == 5
        assert node.declare_parameter("b", 1, ignore_override=True).value == 1
        with pytest.raises(InvalidParameterTypeException) as error:
            node.declare_parameter("c", 1.0)
        assert str(error.value) == (
            "Trying to set parameter 'c' to '5' of type 'INTEGER', expecting type 'DOUBLE': c"
        )
        assert node.declare_parameters("d", [("e", "")])[0].value == "nested"
        assert not node.has_parameter("never_declared")

    overrides = {"a": 5, "b": 5, "c": 5, "d.e": "nested", "never_declared": 1}
    with_node(check, parameter_overrides=[Parameter(name, value=each) for name, each in overrides.items()])


def test_overrides_can_declare_themselves() -> None:
    def check(node: Node) -> None:
        assert node.get_parameter("a").value == 5
        assert node.get_parameter("use_sim_time").value is True

    with_node(
        check,
        parameter_overrides=[Parameter("a", value=5), Parameter("use_sim_time", value=True)],
        automatically_declare_parameters_from_overrides=True,
    )


def test_parameters_are_listed_by_prefix_and_depth() -> None:
    def check(node: Node) -> None:
        for name in ("top", "arm.left", "arm.hand.left", "army"):
            node.declare_parameter(name, 1)

        def listed(prefixes: list[str], depth: int) -> tuple[list[str], list[str]]:
            result = node.list_parameters(prefixes, depth)
            own = [name for name in result.names if name not in {"use_sim_time", _STARTS_SERVICE}]
            return own, list(result.prefixes)

        assert listed([], 0) == (["top", "arm.left", "arm.hand.left", "army"], ["arm", "arm.hand"])
        assert listed([], 1) == (["top", "army"], [])
        assert listed(["arm"], 0) == (["arm.left", "arm.hand.left"], ["arm", "arm.hand"])
        assert listed(["arm"], 1) == (["arm.left"], ["arm"])
        assert listed(["army"], 1) == (["army"], [])
        with pytest.raises(ValueError, match="greater than or equal to zero"):
            node.list_parameters([], -1)
        with pytest.raises(TypeError):
            node.list_parameters("arm", 0)  # type: ignore[arg-type]

    with_node(check)


_STARTS_SERVICE = "start_type_description_service"
