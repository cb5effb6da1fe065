"""The helpers of rosidl_runtime_py."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import pytest
import yaml

from sim.interfaces import InterfaceFinder, action, message, service
from sim.interfaces import rosidl_runtime_py as runtime
from sim.interfaces.rosidl_runtime_py import utilities

String, Scan = message("std_msgs", "String"), message("sensor_msgs", "LaserScan")
Stamped, Time = message("geometry_msgs", "TwistStamped"), message("builtin_interfaces", "Time")


@pytest.fixture
def _finder() -> Iterator[None]:
    finder = InterfaceFinder()
    sys.meta_path.insert(0, finder)
    yield
    sys.meta_path.remove(finder)


@pytest.mark.usefixtures("_finder")
def test_classes_are_found_by_full_name() -> None:
    assert utilities.get_message("std_msgs/msg/String") is String
    assert utilities.get_service("std_srvs/srv/SetBool") is service("std_srvs", "SetBool")
    assert utilities.get_action("test_msgs/action/Fibonacci") is action("test_msgs", "Fibonacci")
    with pytest.raises(ValueError, match=r"^Expected 'std_srvs/srv/SetBool' to be a message$"):
        utilities.get_message("std_srvs/srv/SetBool")
    with pytest.raises(ValueError, match="Expected three parts"):
        utilities.get_interface("std_msgs/String")


def test_fields_are_set_from_a_dictionary_with_conversion() -> None:
    twist = Stamped()
    assert runtime.set_message_fields(twist, {"twist": {"linear": {"x": 1}}, "header": {"frame_id": 5}}) == []
    assert (twist.twist.linear.x, twist.header.frame_id) == (1.0, "5")
    path = message("nav_msgs", "Path")()
    runtime.set_message_fields(path, {"poses": [{"pose": {"position": {"y": 2}}}]})
    assert path.poses[0].pose.position.y == 2.0
    arrays = message("test_msgs", "Arrays")()
    runtime.set_message_fields(arrays, {"int8_values": [1, 2, 3], "string_values": ["a", "b", "c"]})
    assert arrays.int8_values.tolist() == [1, 2, 3]


def test_words_for_the_time_are_set_when_it_is_known() -> None:
    twist, goal = Stamped(), message("std_msgs", "Header")()
    stamps = runtime.set_message_fields(twist, {"header": "auto"}, expand_header_auto=True)
    stamps += runtime.set_message_fields(goal, {"stamp": "now"}, expand_time_now=True)
    for stamp in stamps:
        stamp(Time(sec=7))
    assert twist.header.stamp.sec == goal.stamp.sec == 7


def test_what_is_no_dictionary_or_no_field_is_refused() -> None:
    with pytest.raises(TypeError, match=r"^Value '3' is expected to be a dictionary but is a int$"):
        runtime.set_message_fields(Stamped(), {"twist": 3})
    with pytest.raises(AttributeError):
        runtime.set_message_fields(Stamped(), {"twst": {}})


@pytest.mark.parametrize(
    "text", ["yes", "y", "012", "12:30", "true", "a: b", "0.5", "", "ö", "a\nb", "null", "1e3"]
)
def test_texts_stay_texts_in_yaml(text: str) -> None:
    written = runtime.message_to_yaml(String(data=text))
    assert yaml.safe_load(written) == {"data": text}


def test_yaml_is_written_as_ros_2_does() -> None:
    vector = message("geometry_msgs", "Vector3")(x=1e17, z=float("inf"))
    assert runtime.message_to_yaml(vector) == "x: 1.0e+17\ny: 0.0\nz: .inf\n"
    assert runtime.message_to_yaml(vector, flow_style=True) == "{x: 1.0e+17, y: 0.0, z: .inf}\n"
    assert runtime.message_to_yaml(message("std_msgs", "Empty")()) == "{}\n"
    assert runtime.message_to_yaml(String(data="yes")) == "data: 'yes'\n"


def test_long_values_are_cut_or_described() -> None:
    scan = Scan(ranges=[1.0, 2.0, 3.0])
    assert runtime.message_to_ordereddict(scan, truncate_length=2)["ranges"] == [1.0, 2.0, "..."]
    assert runtime.message_to_ordereddict(scan, no_arr=True)["ranges"] == "<sequence type: float, length: 3>"
    assert runtime.message_to_ordereddict(String(data="abc"), no_str=True)["data"] == "<string length: <3>>"
    assert runtime.message_to_csv(String(data="abc"), truncate_length=2) == "ab..."
    assert runtime.message_to_csv(scan).endswith("0.0,1.0,2.0,3.0,")


def test_interfaces_are_listed_by_package() -> None:
    assert runtime.get_service_interfaces(["std_srvs"]) == {"std_srvs": ["Empty", "SetBool", "Trigger"]}
    assert "action/Fibonacci" in runtime.get_interfaces(["example_interfaces"])["example_interfaces"]
    assert "std_srvs" not in runtime.get_message_interfaces()
    with pytest.raises(NotImplementedError, match="get_interface_path"):
        runtime.get_interface_path("std_msgs/msg/String")
