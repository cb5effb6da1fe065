"""How messages look and compare, and what their classes tell."""

from __future__ import annotations

import copy
import math
from array import array
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.interfaces import Message, field_types, interface_module, message, service, type_name
from sim.interfaces.field_types import (
    Array,
    BasicType,
    BoundedSequence,
    BoundedString,
    NamespacedType,
    UnboundedSequence,
    UnboundedString,
)

Twist = message("geometry_msgs", "Twist")
Vector3 = message("geometry_msgs", "Vector3")
Int32 = message("std_msgs", "Int32")
LaserScan = message("sensor_msgs", "LaserScan")


def test_a_message_shows_package_class_and_fields() -> None:
    assert repr(Twist(linear=Vector3(x=0.5))) == (
        "geometry_msgs.msg.Twist(linear=geometry_msgs.msg.Vector3(x=0.5, y=0.0, z=0.0), "
        "angular=geometry_msgs.msg.Vector3(x=0.0, y=0.0, z=0.0))"
    )


def test_a_sequence_of_numbers_shows_as_a_list_and_a_fixed_one_as_numpy() -> None:
    assert "ranges=[0.5, inf], intensities=[])" in repr(LaserScan(ranges=[0.5, math.inf]))
    assert repr(message("unique_identifier_msgs", "UUID")()).endswith("dtype=uint8))")


def test_the_request_of_a_service_shows_its_own_name() -> None:
    assert repr(service("std_srvs", "SetBool").Request()) == "std_srvs.srv.SetBool_Request(data=False)"


@given(st.floats(allow_nan=False, allow_infinity=False), st.integers(-(2**31), 2**31 - 1), st.text())
def test_what_a_message_shows_makes_it_again(number: float, whole: int, text: str) -> None:
    modules = {"geometry_msgs": _Package("geometry_msgs"), "std_msgs": _Package("std_msgs")}
    for original in (Vector3(y=number), Int32(data=whole), message("std_msgs", "String")(data=text)):
        assert eval(repr(original), modules) == original


class _Package:
    def __init__(self, name: str) -> None:
        self.msg = interface_module(f"{name}.msg")


def test_messages_are_equal_if_their_fields_are() -> None:
    assert Twist(linear=Vector3(x=1.0)) == Twist(linear=Vector3(x=1.0))
    assert Twist(linear=Vector3(x=1.0)) != Twist()
    assert LaserScan(ranges=[1.0]) == LaserScan(ranges=array("f", [1.0]))
    pose = message("geometry_msgs", "PoseWithCovariance")
    assert pose() == pose()
    assert pose(covariance=np.ones(36)) != pose()


def test_messages_of_different_classes_are_never_equal() -> None:
    assert Vector3() != message("geometry_msgs", "Point")()
    assert Int32(data=1) != 1


def test_a_message_with_nan_equals_nothing() -> None:
    vector = Vector3(x=math.nan)
    assert vector != copy.deepcopy(vector)
    assert vector != vector


def test_messages_have_no_hash() -> None:
    with pytest.raises(TypeError, match=r"^unhashable type: 'Twist'$"):
        hash(Twist())


def test_an_unknown_attribute_is_refused() -> None:
    with pytest.raises(AttributeError, match=r"^'Twist' object has no attribute 'foo'"):
        Twist().foo = 1
    with pytest.raises(AttributeError, match=r"^'Twist' object has no attribute 'foo'"):
        print(Twist().foo)


def test_constructors_take_known_keywords_only() -> None:
    with pytest.raises(AssertionError, match=r"^Invalid arguments passed to constructor: foo$"):
        Twist(foo=1)
    with pytest.raises(AssertionError, match=r"^Invalid arguments passed to constructor: bar, foo$"):
        Twist(foo=1, linear=Vector3(), bar=2)
    positional: Any = Int32
    with pytest.raises(TypeError, match=r"^Int32.__init__\(\) takes 1 positional argument but 2 were given$"):
        positional(5)


def test_defaults_are_zero_false_and_empty() -> None:
    scan = LaserScan()
    assert (scan.range_max, scan.header.frame_id, scan.header.stamp.sec) == (0.0, "", 0)
    assert scan.ranges == array("f")
    assert message("std_msgs", "Bool")().data is False
    assert message("std_msgs", "Byte")().data == b"\x00"
    assert message("std_msgs", "Char")().data == 0
    assert message("tf2_msgs", "TFMessage")().transforms == []
    assert message("geometry_msgs", "PoseWithCovariance")().covariance.tolist() == [0.0] * 36


def test_a_quaternion_starts_as_no_rotation() -> None:
    quaternion = message("geometry_msgs", "Quaternion")
    assert (quaternion().w, quaternion().x) == (1.0, 0.0)
    assert message("nav_msgs", "Odometry")().pose.pose.orientation.w == 1.0
    assert quaternion.W__DEFAULT == 1.0


def test_two_messages_share_no_default() -> None:
    one, other = LaserScan(), LaserScan()
    one.ranges.append(1.0)
    one.header.frame_id = "laser"
    assert other == LaserScan()


@pytest.mark.parametrize(
    ("package", "name", "constant", "value"),
    [
        ("sensor_msgs", "PointField", "FLOAT32", 7),
        ("action_msgs", "GoalStatus", "STATUS_ABORTED", 6),
        ("diagnostic_msgs", "DiagnosticStatus", "ERROR", b"\x02"),
        ("sensor_msgs", "NavSatStatus", "STATUS_UNKNOWN", -2),
        ("lifecycle_msgs", "State", "PRIMARY_STATE_ACTIVE", 3),
    ],
)
def test_constants_are_on_class_and_message(package: str, name: str, constant: str, value: object) -> None:
    cls = message(package, name)
    assert getattr(cls, constant) == value
    assert getattr(cls(), constant) == value


def test_a_byte_constant_fits_its_field() -> None:
    status = message("diagnostic_msgs", "DiagnosticStatus")
    assert status(level=status.WARN).level == b"\x01"


def test_classes_tell_their_fields_as_rosidl_does() -> None:
    assert LaserScan.get_fields_and_field_types()["ranges"] == "sequence<float>"
    assert Twist.get_fields_and_field_types() == {
        "linear": "geometry_msgs/Vector3",
        "angular": "geometry_msgs/Vector3",
    }
    fields = {
        **message("geometry_msgs", "PoseWithCovariance").get_fields_and_field_types(),
        **message("shape_msgs", "SolidPrimitive").get_fields_and_field_types(),
        **message("rmw_dds_common", "NodeEntitiesInfo").get_fields_and_field_types(),
        **message("std_msgs", "Bool").get_fields_and_field_types(),
    }
    assert fields["covariance"] == "double[36]"
    assert fields["dimensions"] == "sequence<double, 3>"
    assert fields["node_name"] == "string<256>"
    assert fields["data"] == "boolean"


def test_slot_types_describe_the_slots_in_order() -> None:
    assert LaserScan.__slots__[0] == "_header"
    assert LaserScan.SLOT_TYPES[0] == NamespacedType(("std_msgs", "msg"), "Header")
    assert LaserScan.SLOT_TYPES[-1] == UnboundedSequence(BasicType("float"))
    assert message("geometry_msgs", "PoseWithCovariance").SLOT_TYPES[1] == Array(BasicType("double"), 36)
    assert message("shape_msgs", "SolidPrimitive").SLOT_TYPES[1] == BoundedSequence(BasicType("double"), 3)
    assert message("rmw_dds_common", "NodeEntitiesInfo").SLOT_TYPES[0] == BoundedString(256)
    assert (UnboundedString(),) == message("std_msgs", "String").SLOT_TYPES


def test_every_slot_can_be_read_by_its_name() -> None:
    twist = Twist(linear=Vector3(x=1.0))
    assert [getattr(twist, slot) for slot in Twist.__slots__] == [Vector3(x=1.0), Vector3()]


@pytest.mark.parametrize(
    ("package", "name", "module"),
    [
        ("geometry_msgs", "Twist", "geometry_msgs.msg._twist"),
        ("geometry_msgs", "Pose2D", "geometry_msgs.msg._pose2_d"),
        ("std_msgs", "ColorRGBA", "std_msgs.msg._color_rgba"),
        ("std_msgs", "UInt8MultiArray", "std_msgs.msg._u_int8_multi_array"),
        ("tf2_msgs", "TFMessage", "tf2_msgs.msg._tf_message"),
    ],
)
def test_a_class_lives_in_the_module_rosidl_gives_it(package: str, name: str, module: str) -> None:
    cls = message(package, name)
    assert (cls.__module__, cls.__name__) == (module, name)


def test_type_names_are_package_kind_and_name() -> None:
    set_bool = service("std_srvs", "SetBool")
    assert type_name(Int32) == "std_msgs/msg/Int32"
    assert type_name(set_bool) == "std_srvs/srv/SetBool"
    assert type_name(set_bool.Request) == "std_srvs/srv/SetBool_Request"


def test_an_empty_message_has_no_fields() -> None:
    empty = message("std_msgs", "Empty")
    assert repr(empty()) == "std_msgs.msg.Empty()"
    assert empty.get_fields_and_field_types() == {}
    assert isinstance(empty(), Message)
    assert empty() == empty()


def test_field_types_are_instances_of_the_bases_that_rosidls_are_instances_of() -> None:
    package = PathFinder.find_spec("rosidl_parser")
    if package is None:
        pytest.skip("real ROS 2 is not installed")
    spec = PathFinder.find_spec("definition", package.submodule_search_locations)
    assert spec is not None
    assert spec.loader is not None
    real: Any = module_from_spec(spec)
    spec.loader.exec_module(real)
    ours = {
        name: cls for name, cls in vars(field_types).items() if name.endswith(("Type", "String", "Sequence"))
    }
    classes = {name: cls for name, cls in ours.items() if isinstance(cls, type)} | {"Array": Array}
    assert len(classes) > 12
    for base, cls in classes.items():
        theirs = {name for name in classes if issubclass(getattr(real, name), getattr(real, base))}
        assert {name for name in classes if issubclass(classes[name], cls)} == theirs
