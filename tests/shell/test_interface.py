"""``ros2 interface``: what types are made of."""

import pytest

from tests.shell.lines import carry_out


def test_show_prints_the_definition_with_nested_fields_below() -> None:
    out = carry_out("interface show geometry_msgs/msg/Twist --no-comments").out
    assert [line.split() for line in out.splitlines()] == [
        ["Vector3", "linear"],
        *[["float64", axis] for axis in "xyz"],
        ["Vector3", "angular"],
        *[["float64", axis] for axis in "xyz"],
    ]
    assert "\tfloat64 x\n" in out


def test_show_parts_request_and_response() -> None:
    lines = carry_out("ros2 interface show std_srvs/srv/SetBool").out.splitlines()
    assert "---" in lines
    assert lines[0].startswith("bool data")


def test_proto_is_yaml_in_quotes() -> None:
    assert carry_out("interface proto std_srvs/srv/SetBool").out == '"data: false\n"\n'
    assert carry_out("interface proto std_msgs/msg/Int32 --no-quotes").out == "data: 0\n\n"


def test_interfaces_are_listed_by_kind() -> None:
    out = carry_out("interface list -s").out
    assert out.startswith("Services:\n    ")
    assert "    std_srvs/srv/SetBool\n" in out
    assert "Messages:" not in out
    assert carry_out("interface package std_srvs").out == (
        "std_srvs/srv/Empty\nstd_srvs/srv/SetBool\nstd_srvs/srv/Trigger\n"
    )
    assert "std_srvs\n" in carry_out("interface packages -s").out
    assert "std_srvs\n" not in carry_out("interface packages -m").out


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ("interface show std_msgs/msg/Strin", "Unknown interface 'std_msgs/msg/Strin': "),
        ("interface show std_msgs", "Unknown interface 'std_msgs': "),
        ("interface proto std_msgs/srv/No", "Unknown interface 'std_msgs/srv/No': "),
        ("interface package nope", "Unknown package 'nope'"),
    ],
)
def test_an_unknown_interface_is_named(line: str, complaint: str) -> None:
    result = carry_out(line)
    assert result.err.startswith(complaint)
    assert result.status == 1
