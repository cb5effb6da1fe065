"""A parameter by itself: types, messages, YAML."""

from array import array
from pathlib import Path
from typing import Any

import pytest

from sim.interfaces import rcl_interfaces as rcl
from sim.ros.parameters.parameter import (
    Parameter,
    get_parameter_value,
    parameter_dict_from_yaml_file,
    parameter_value_to_python,
)
from sim.ros.parameters.yaml_files import ParameterYamlError, PlainValue, read_file, read_value

Type = Parameter.Type


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (None, Type.NOT_SET),
        (True, Type.BOOL),
        (5, Type.INTEGER),
        (5.0, Type.DOUBLE),
        ("5", Type.STRING),
        ([], Type.BYTE_ARRAY),
        ([b"a", b"b"], Type.BYTE_ARRAY),
        ((True, False), Type.BOOL_ARRAY),
        (array("q", [1, 2]), Type.INTEGER_ARRAY),
        (array("d", [1.0]), Type.DOUBLE_ARRAY),
        (["a"], Type.STRING_ARRAY),
    ],
)
def test_a_parameter_survives_the_way_through_a_message(value: Any, expected: Parameter.Type) -> None:
    parameter = Parameter("p", value=value)
    assert parameter.type_ is expected
    back = Parameter.from_parameter_msg(parameter.to_parameter_msg())
    assert (back.name, back.type_) == ("p", expected)
    plain = parameter_value_to_python(parameter.get_parameter_value())
    assert plain == (list(value) if isinstance(value, tuple | array) else value)


def test_type_and_value_must_agree() -> None:
    with pytest.raises(ValueError, match=r"^Type 'Type\.INTEGER' and value 'x' do not agree$"):
        Parameter("p", Type.INTEGER, "x")
    with pytest.raises(ValueError, match="do not agree"):
        Parameter("p", Type.BYTE_ARRAY, [b"too long"])
    with pytest.raises(TypeError, match=r"^type must be an instance of"):
        Parameter("p", "INTEGER", 1)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="not a list of one of the allowed types"):
        Parameter("p", value=[1, "a"])
    with pytest.raises(TypeError, match="not one of the allowed types"):
        Parameter("p", value={"a": 1})


def test_types_are_the_numbers_of_the_message_and_print_as_names() -> None:
    assert Type.DOUBLE.value == rcl.ParameterType.PARAMETER_DOUBLE
    assert f"{Type.DOUBLE} {Type.DOUBLE!r}" == "Type.DOUBLE <Type.DOUBLE: 3>"


def test_a_message_of_an_unknown_type_has_no_value() -> None:
    with pytest.raises(RuntimeError, match=r"^unexpected parameter type 42$"):
        parameter_value_to_python(rcl.ParameterValue(type=42))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("true", True),
        ("on", True),
        ("N", False),
        ("'true'", "true"),
        ("12", 12),
        ("-0x1F", -31),
        ("010", 8),
        ("08", 8.0),
        ("1e3", 1000.0),
        (".5", 0.5),
        ("9223372036854775808", 9223372036854775808.0),
        ("-.inf", float("-inf")),
        ("1_000", "1_000"),
        ("12 apples", "12 apples"),
        ("!!str 12", "12"),
        ('"a: b"', "a: b"),
        ("null", "null"),
        ("[1, 2]", [1, 2]),
        ("[1.0, 2.5]", [1.0, 2.5]),
        ("[a, 'b c']", ["a", "b c"]),
        ("[yes, off]", [True, False]),
        ("[]", None),
    ],
)
def test_yaml_values_get_the_types_that_ros_gives_them(text: str, value: PlainValue) -> None:
    found = read_value(text)
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[1, 2.5]", "Sequence should be of same type. Value type 'double' do not belong at line 1"),
        ("{a: 1}", "a value or a list of values is wanted at line 1"),
        ("[[1]]", "a list may hold values only, not lists or mappings, at line 1"),
        ("", "there is no value"),
        ("a: b: c", "mapping values are not allowed in this context at line 1"),
        ("[&a 1, *a]", "the alias *a is not supported at line 1"),
        ("[" * 5000, "exceeded maximum nesting depth at line 1"),
        ("[1", "at line 1"),
    ],
)
def test_yaml_that_is_no_value_is_refused_with_its_line(text: str, complaint: str) -> None:
    with pytest.raises(ParameterYamlError) as error:
        read_value(text)
    assert complaint in str(error.value)


def test_a_value_from_the_command_line_is_a_text_if_it_is_nothing_else() -> None:
    assert get_parameter_value("2").integer_value == 2
    assert get_parameter_value("[1, two]").string_value == "[1, two]"
    assert get_parameter_value("{a").string_value == "{a"
    assert get_parameter_value("[]").type == Type.BOOL_ARRAY.value


_FILE = """\
/**:
  ros__parameters:
    speed: 1.0
    shared: all
/arm:
  left:
    ros__parameters:
      speed: 2.0
      joints:
        elbow: {limit: 90, names: [a, b]}
lonely:
  ros__parameters:
    speed: 3.0
"""


def test_a_parameter_file_holds_values_by_node_and_dotted_name(tmp_path: Path) -> None:
    path = tmp_path / "params.yaml"
    path.write_text(_FILE)
    assert read_file(str(path)) == {
        "/**": {"speed": 1.0, "shared": "all"},
        "/arm/left": {"speed": 2.0, "joints.elbow.limit": 90, "joints.elbow.names": ["a", "b"]},
        "lonely": {"speed": 3.0},
    }


def test_messages_are_made_of_a_file_for_chosen_nodes(tmp_path: Path) -> None:
    path = tmp_path / "params.yaml"
    path.write_text(_FILE)
    of_node = parameter_dict_from_yaml_file(str(path), target_nodes=["lonely"], namespace="x.")
    assert {name: each.value.double_value for name, each in of_node.items()} == {"x.speed": 3.0}
    with_wildcard = parameter_dict_from_yaml_file(str(path), True, ["lonely"])
    assert with_wildcard["speed"].value.double_value == 3.0
    assert with_wildcard["shared"].value.string_value == "all"
    assert "shared" not in parameter_dict_from_yaml_file(str(path))
    with pytest.raises(RuntimeError, match=r"^Param file does not contain parameters for nobody"):
        parameter_dict_from_yaml_file(str(path), target_nodes=["nobody"])


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("a: 1", "Cannot have a value before ros__parameters at line 1"),
        ("ros__parameters:\n  a: 1", "without a node's name above it"),
        ("n:\n  ros__parameters: 5", "parameters is wanted as 'name: …' at line 2"),
        ("- a", "a node's name is wanted as 'name: …' at line 1"),
        ("n:\n  ros__parameters:\n    a: [1, x]", "Value type 'string' do not belong at line 3"),
        ("n:\n\tros__parameters:", "at line 2"),
    ],
)
def test_a_broken_parameter_file_is_refused_with_its_line(tmp_path: Path, text: str, complaint: str) -> None:
    path = tmp_path / "params.yaml"
    path.write_text(text)
    with pytest.raises(ParameterYamlError) as error:
        read_file(str(path))
    assert complaint in str(error.value)


def test_a_parameter_file_that_is_not_there_is_named_so(tmp_path: Path) -> None:
    with pytest.raises(ParameterYamlError, match=r"^Error opening YAML file"):
        read_file(str(tmp_path / "nowhere.yaml"))
