"""Reading a learner's own .msg and .srv files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim.ros.interfaces import DefinitionError, UnknownInterfaceError
from sim.ros.interfaces.folder import DefinitionFolder
from sim.ros.interfaces.jazzy import JazzyMessages
from sim.ros.interfaces.registry import Registry


class Workspace:
    """A folder with one package, ``robot_msgs``."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def write(self, name: str, text: str) -> None:
        file = self.root / "robot_msgs" / name.rpartition(".")[2] / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def registry(self) -> Registry:
        return Registry(JazzyMessages(), DefinitionFolder(self.root))


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    return Workspace(tmp_path)


def test_a_message_uses_others_of_its_own_and_of_standard_packages(workspace: Workspace) -> None:
    workspace.write("Wheel.msg", "float64 speed  # m/s\n")
    workspace.write("Base.msg", "# two wheels\nHeader header\nWheel[2] wheels\ngeometry_msgs/Pose pose\n")
    base = workspace.registry().message("robot_msgs", "Base")
    assert base.get_fields_and_field_types() == {
        "header": "std_msgs/Header",
        "wheels": "robot_msgs/Wheel[2]",
        "pose": "geometry_msgs/Pose",
    }
    assert [wheel.speed for wheel in base().wheels] == [0.0, 0.0]
    assert base().wheels[0] is not base().wheels[1]


def test_declared_defaults_are_read_in_the_fields_kind(workspace: Workspace) -> None:
    workspace.write(
        "Limits.msg",
        'float64 top 1\nbool on true\nstring name "left wheel"\nstring<=3 side ab\nint8[] gears [1, -2]\n'
        'uint8[2] pins [3, 4]\nbyte mask 7\nstring[] tags ["a", "b"]\nfloat32[<=2] pair [0.5]\n',
    )
    limits = workspace.registry().message("robot_msgs", "Limits")
    fresh = limits()
    assert repr(fresh.top) == "1.0"
    assert (fresh.on, fresh.name, fresh.side, fresh.mask) == (True, "left wheel", "ab", b"\x07")
    assert (fresh.gears.tolist(), fresh.tags, fresh.pair.tolist()) == ([1, -2], ["a", "b"], [0.5])
    assert np.array_equal(fresh.pins, [3, 4])
    assert limits.TOP__DEFAULT == 1.0


def test_a_default_list_is_not_shared(workspace: Workspace) -> None:
    workspace.write("Gears.msg", "int8[] gears [1, 2]\n")
    gears = workspace.registry().message("robot_msgs", "Gears")
    gears().gears.append(3)
    assert gears().gears.tolist() == [1, 2]


def test_constants_are_read(workspace: Workspace) -> None:
    workspace.write(
        "Mode.msg",
        'uint8 IDLE=0\nint32 FAR = -5\nstring NAME="x"\nfloat32 HALF=0.5\nbool YES=true\nuint8 mode\n',
    )
    mode = workspace.registry().message("robot_msgs", "Mode")
    assert (mode.IDLE, mode.FAR, mode.NAME, mode.HALF, mode.YES) == (0, -5, "x", 0.5, True)


def test_wide_strings_are_texts(workspace: Workspace) -> None:
    workspace.write("Wide.msg", "wstring free\nwstring<=2 bound\nwstring[] many\n")
    wide = workspace.registry().message("robot_msgs", "Wide")
    assert list(wide.get_fields_and_field_types().values()) == ["wstring", "wstring<2>", "sequence<wstring>"]
    assert wide(bound="äö").bound == "äö"
    with pytest.raises(AssertionError, match=r"^The 'bound' field must be string value not longer than 2$"):
        wide(bound="abc")


def test_bounded_texts_in_sequences_name_both_limits(workspace: Workspace) -> None:
    workspace.write("Names.msg", "string<=2[<=3] names\n")
    names = workspace.registry().message("robot_msgs", "Names")
    assert names.get_fields_and_field_types() == {"names": "sequence<string<2>, 3>"}
    with pytest.raises(AssertionError) as refused:
        names(names=["abc"])
    assert str(refused.value) == (
        "The 'names' field must be a set or sequence with length <= 3 "
        "and each string value not longer than 2 and each value of type 'str'"
    )


def test_a_service_has_two_halves(workspace: Workspace) -> None:
    workspace.write("Turn.srv", "float64 angle\n---\nint8 FAILED=1\nstd_msgs/Header header\nint8 result\n")
    turn = workspace.registry().service("robot_msgs", "Turn")
    assert turn.Request.get_fields_and_field_types() == {"angle": "double"}
    assert turn.Response.FAILED == 1
    assert list(turn.Response.get_fields_and_field_types()) == ["header", "result"]


def test_windows_line_ends_are_read(workspace: Workspace) -> None:
    workspace.write("Turn.srv", "float64 angle\r\n---\r\nbool done\r\n")
    assert workspace.registry().service("robot_msgs", "Turn").Response().done is False


@pytest.mark.parametrize("text", ["float64 angle\n", "int8 a\n---\nint8 b\n---\nint8 c\n"])
def test_a_service_needs_exactly_one_division(workspace: Workspace, text: str) -> None:
    workspace.write("Turn.srv", text)
    with pytest.raises(DefinitionError, match=r"Turn\.srv: a service needs one line '---'"):
        workspace.registry().service("robot_msgs", "Turn")


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("Bad.msg", "int32 a\nint32\n", r"Bad\.msg:2: 'int32' is neither a field, a constant nor a comment"),
        ("Bad.srv", "int32 a\n---\nint32 = 5\n", r"Bad\.srv:3: 'int32 = 5' is neither"),
        ("Bad.msg", "int32 Speed\n", r"Bad\.msg: the field name 'Speed' must be lower case"),
        ("Bad.msg", "int32 class\n", r"Bad\.msg: the field name 'class' is a keyword of Python"),
        ("Bad.msg", "int32 a\nint8 a\n", r"Bad\.msg: the field 'a' is defined twice"),
        ("Bad.msg", "int8 a 300\n", r"robot_msgs/msg/Bad: 300 cannot be used: The 'a' field"),
        ("Bad.msg", "uint8 A=-1\n", r"robot_msgs/msg/Bad: -1 cannot be used: The 'A' field"),
        ("Bad.msg", "int8[2] a [1]\n", r"robot_msgs/msg/Bad: \[1\] cannot be used: The 'a' field"),
        ("Bad.msg", "Bad again\n", r"robot_msgs/msg/Bad contains itself"),
        ("Bad.msg", "a/b/c/Deep deep\n", r"Bad\.msg: the type of 'deep', .*, is not of the form"),
    ],
)  # fmt: skip
def test_a_mistake_is_named_with_its_place(workspace: Workspace, name: str, text: str, reason: str) -> None:
    workspace.write(name, text)
    registry = workspace.registry()
    find = registry.message if name.endswith("msg") else registry.service
    with pytest.raises(DefinitionError, match=reason):
        find("robot_msgs", "Bad")


def test_an_unknown_type_is_named_with_the_message_that_uses_it(workspace: Workspace) -> None:
    workspace.write("Bad.msg", "geometry_msgs/Pont point\n")
    reason = r"^robot_msgs/msg/Bad: geometry_msgs has no message 'Pont'; did you mean 'Point'\?$"
    with pytest.raises(UnknownInterfaceError, match=reason):
        workspace.registry().message("robot_msgs", "Bad")


@pytest.mark.parametrize(
    "file", ["Robot_msgs/msg/Good.msg", "robot_msgs/msg/bad.msg", "robot_msgs/srv/Bad-Name.srv"]
)
def test_names_ros_does_not_take_are_refused(tmp_path: Path, file: str) -> None:
    path = tmp_path / file
    path.parent.mkdir(parents=True)
    path.write_text("")
    with pytest.raises(DefinitionError, match="name"):
        DefinitionFolder(tmp_path)


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(DefinitionError, match="nowhere: there is no such folder"):
        DefinitionFolder(tmp_path / "nowhere")
