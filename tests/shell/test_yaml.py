"""Messages written as YAML, and YAML read into messages."""

import math

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from sim.files.plain_yaml import YamlError, dump, load
from sim.interfaces import Message, message
from sim.interfaces.rosidl_runtime_py import message_to_csv, message_to_yaml
from sim.shell.messages import Outgoing
from sim.shell.session import CommandFailed
from tests.interfaces.strategies import messages

_TYPES = (
    ("geometry_msgs", "Twist"),
    ("std_msgs", "String"),
    ("geometry_msgs", "PolygonStamped"),
    ("std_msgs", "Int64MultiArray"),
    ("sensor_msgs", "LaserScan"),
    ("nav_msgs", "Odometry"),
    ("std_msgs", "Empty"),
    ("rcl_interfaces", "SetParametersResult"),
)
_RARE_LINE_ENDS = frozenset("\x85\u2028\u2029")
"""PyYAML writes them as they are, and reads them as blanks."""


def _has_no_rare_line_end(sent: Message) -> bool:
    return _RARE_LINE_ENDS.isdisjoint(message_to_csv(sent))


_ANY = st.one_of(*(messages(message(*name)) for name in _TYPES)).filter(_has_no_rare_line_end)
_CALM = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


@_CALM
@given(_ANY)
def test_what_echo_prints_is_read_back_as_the_same_message(sent: Message) -> None:
    assert Outgoing(type(sent), load(message_to_yaml(sent))).message == sent


@_CALM
@given(_ANY)
def test_flow_style_is_one_line_and_read_back_as_the_same_message(sent: Message) -> None:
    text = message_to_yaml(sent, flow_style=True)
    assert text.count("\n") == 1 or "\\n" not in text
    assert Outgoing(type(sent), load(text)).message == sent


@given(st.text())
@example("[" * 5000)
@example("a: &x [*x]")
@example("{a: 1, a: 2}")
@example("{[1]: 2}")
def test_reading_raises_nothing_but_its_own_error(text: str) -> None:
    try:
        load(text)
    except YamlError as error:
        assert "\n" not in str(error)  # noqa: PT017 -- either way is right


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a: 1\n!!python/object/apply:os.getpid []", "(line 2)"),
        ("a: 1\nb: !!python/name:os.system", "could not determine a constructor"),
        ("a: &a [1]\nb: [*a, *a]", "the alias *a is not supported (line 2)"),
        ("&a [*a]", "the alias *a is not supported (line 1)"),
        ("[" * 101 + "]" * 101, "exceeded maximum nesting depth (line 1)"),
        ("[" * 200_000, "exceeded maximum nesting depth (line 1)"),
        (
            "a:\n" + "".join(f"{' ' * depth}-\n" for depth in range(200)),
            "exceeded maximum nesting depth (line 101)",
        ),
        ("a: 1\n--- b", "but found another document (line 2)"),
        ("a: 1\nb: \x01", "control characters are not allowed (line 2)"),
        ("a: 1\nb: [", "(line 2)"),
        ("2020-13-41", "a value does not fit its type"),
        ("!!int ''", "a value does not fit its type"),
    ],
    ids=lambda value: value[:30],
)
def test_what_is_no_plain_value_is_refused_in_one_sentence(text: str, sentence: str) -> None:
    with pytest.raises(YamlError) as raised:
        load(text)
    assert sentence in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_hundred_lists_in_each_other_are_read() -> None:
    value = load("[" * 100 + "]" * 100)
    assert str(value) == "[" * 100 + "]" * 100


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("yes", True),
        ("y", "y"),
        ("010", 8),
        ("1e3", "1e3"),
        ("1.0e+3", 1000.0),
        ("12:30", 750),
        ("1_000", 1000),
        ("~", None),
        ("", None),
        ("{a: 1, a: 2}", {"a": 2}),
    ],
)
def test_values_have_the_types_of_yaml_1_1(text: str, value: object) -> None:
    assert repr(load(text)) == repr(value)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("", "data: ''\n"),
        ("base_link", "data: base_link\n"),
        ("a, b", "data: a, b\n"),
        ("true", "data: 'true'\n"),
        ("5", "data: '5'\n"),
        ("a: b", "data: 'a: b'\n"),
        ("it's", "data: it's\n"),
        ("a\nb", "data: 'a\n\n  b'\n"),
        ("tab\t", 'data: "tab\\t"\n'),
    ],
)
def test_texts_are_quoted_where_yaml_wants_it(text: str, shown: str) -> None:
    assert dump({"data": text}) == shown


def test_numbers_are_written_as_pyyaml_writes_them() -> None:
    values = {"a": 1e-05, "b": math.inf, "c": -math.inf, "d": math.nan, "e": 1e16, "f": True, "g": 3}
    assert dump(values) == "a: 1.0e-05\nb: .inf\nc: -.inf\nd: .nan\ne: 1.0e+16\nf: true\ng: 3\n"


def test_lists_stand_below_their_name_without_a_margin() -> None:
    tree = message("diagnostic_msgs", "DiagnosticStatus")(
        values=[message("diagnostic_msgs", "KeyValue")(key="a", value="1")]
    )
    assert message_to_yaml(tree) == (
        "level: \"\\0\"\nname: ''\nmessage: ''\nhardware_id: ''\nvalues:\n- key: a\n  value: '1'\n"
    )


def test_now_and_auto_stand_for_the_time_of_sending() -> None:
    cls = message("geometry_msgs", "PoseStamped")
    outgoing = Outgoing(cls, {"header": "auto"})
    outgoing.stamp(message("builtin_interfaces", "Time")(sec=5))
    assert outgoing.message.header.stamp.sec == 5
    outgoing = Outgoing(cls, {"header": {"stamp": "now", "frame_id": "map"}})
    outgoing.stamp(message("builtin_interfaces", "Time")(sec=6))
    assert (outgoing.message.header.stamp.sec, outgoing.message.header.frame_id) == (6, "map")


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ("data:false", "Value 'data:false' is expected to be a dictionary but is a str"),
        ("{lineal: {x: 1}}", "'Twist' object has no attribute 'lineal'"),
        ("{linear: {x: fast}}", "could not convert string to float: 'fast'"),
    ],
)
def test_a_value_that_does_not_fit_is_said_as_ros2_says_it(values: str, sentence: str) -> None:
    with pytest.raises(CommandFailed, match="Failed to populate field: ") as raised:
        Outgoing(message("geometry_msgs", "Twist"), load(values))
    assert sentence in str(raised.value)
