"""Reading a learner's own .msg and .srv files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim import interfaces
from sim.interfaces import DefinitionError
from sim.interfaces.bundles import DefinitionBundle
from sim.interfaces.folder import DefinitionFolder
from sim.interfaces.jazzy import JazzyMessages
from sim.interfaces.registry import Registry

DEFINITIONS = Path(interfaces.__file__).parent / "definitions.interfaces"


class Workspace:
    """A folder with one package, ``robot_msgs``."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def write(self, name: str, text: str) -> None:
        file = self.root / "robot_msgs" / name.rpartition(".")[2] / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def registry(self) -> Registry:
        return Registry(JazzyMessages(), DefinitionBundle(DEFINITIONS), DefinitionFolder(self.root))


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    return Workspace(tmp_path)


def test_a_message_uses_others_of_its_own_and_of_standard_packages(workspace: Workspace) -> None:
    workspace.write("Wheel.msg", "float64 speed  # m/s\n")
    workspace.write(
        "Base.msg", "# two wheels\nstd_msgs/Header header\nWheel[2] wheels\ngeometry_msgs/Pose pose\n"
    )
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
    with pytest.raises(DefinitionError, match=r"Turn\.srv: a service needs one line '---' between"):
        workspace.registry().service("robot_msgs", "Turn")


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("Bad.msg", "int32 a\nint32\n", r"Bad\.msg:2: 'int32' is neither a field, a constant nor a comment"),
        ("Bad.srv", "int32 a\n---\nint32 = 5\n", r"Bad\.srv:3: 'int32 = 5' is neither"),
        ("Bad.msg", "int32 Speed\n", r"Bad\.msg:1: the field name 'Speed' must be lower case"),
        ("Bad.msg", "int32 class\n", r"Bad\.msg:1: the field name 'class' is a keyword of Python"),
        ("Bad.msg", "int32 a\nint8 a\n",
         r"Bad\.msg:2: the field 'a' is defined twice; first at .*Bad\.msg:1"),
        ("Bad.msg", "int8 A=1\nint8 A=2\n", r"Bad\.msg:2: the constant 'A' is defined twice"),
        ("Bad.msg", "int8 low=1\n", r"Bad\.msg:1: the constant name 'low' must be capitals"),
        ("Bad.msg", "int8 LOW=\n", r"Bad\.msg:1: the constant 'LOW' has no value"),
        ("Bad.msg", "int8[] LOW=1\n", r"Bad\.msg:1: the constant 'LOW' is of type 'int8\[\]'"),
        ("Bad.msg", "int8 a 300\n",
         r"Bad\.msg:1: the default of 'a', 300, cannot be used: int8 takes integers"),
        ("Bad.msg", "uint8 A=-1\n",
         r"Bad\.msg:1: the constant 'A', -1, cannot be used: uint8 takes integers"),
        ("Bad.msg", "int8 a x\n", r"Bad\.msg:1: the default of 'a', x, cannot be used: it is not an integer"),
        ("Bad.msg", "float32 a x\n",
         r"Bad\.msg:1: the default of 'a', x, cannot be used: it is not a number"),
        ("Bad.msg", "bool a 2\n",
         r"Bad\.msg:1: the default of 'a', 2, cannot be used: a bool is true or false"),
        ("Bad.msg", "int8[] a 1\n", r"Bad\.msg:1: the default of 'a', 1, .* written as \[value, …\]"),
        ("Bad.msg", "int8[] a [1,,2]\n", r"Bad\.msg:1: the default of 'a', \[1,,2\], .* single commas"),
        ("Bad.msg", "int8[2] a [1]\n", r"Bad\.msg:1: \[1\] cannot be used: The 'a' field"),
        ("Bad.msg", "int8[<=1] a [1, 2]\n", r"Bad\.msg:1: \[1, 2\] cannot be used: The 'a' field"),
        ("Bad.msg", "string<=2 a abc\n", r"Bad\.msg:1: 'abc' cannot be used: The 'a' field"),
        ("Bad.msg", "int8[0] a\n", r"Bad\.msg:1: the size '0' in 'int8\[0\]' must be a positive integer"),
        ("Bad.msg", "int8[<=x] a\n", r"Bad\.msg:1: the bound 'x' in 'int8\[<=x\]' must be"),
        ("Bad.msg", "string<=0 a\n", r"Bad\.msg:1: the bound '0' in 'string<=0' must be"),
        ("Bad.msg", "int8<=3 a\n", r"Bad\.msg:1: 'int8<=3': only string and wstring take a bound"),
        ("Bad.msg", "int8[2 a\n", r"Bad\.msg:1: 'int8\[2' is not a type"),
        ("Bad.msg", "# speed\nint a\n", r"Bad\.msg:2: there is no type 'int'; did you mean 'int32'\?"),
        ("Bad.msg", "int23 a\n", r"Bad\.msg:1: there is no type 'int23'; did you mean 'int\d+'\?"),
        ("Bad.msg", "time stamp\n", r"Bad\.msg:1: there is no type 'time'; .* 'builtin_interfaces/Time'\?"),
        ("Bad.msg", "Header h\n", r"Bad\.msg:1: the field 'h': robot_msgs has no .* 'std_msgs/Header'\?"),
        ("Bad.msg", "std_mgs/Header h\n",
         r"Bad\.msg:1: the field 'h': there is no package 'std_mgs'; .* 'std_msgs'"),
        ("Bad.msg", "geometry_msgs/Pose pose 1\n", r"Bad\.msg:1: the field 'pose' is a message and takes no"),
        ("Bad.msg", "int8 a\nBad again\n",
         r"Bad\.msg:2: the field 'again': robot_msgs/msg/Bad contains itself"),
        ("Bad.msg", "a/b/c/Deep deep\n",
         r"Bad\.msg:1: there is no type 'a/b/c/Deep'; a message is written as"),
        ("Bad.action", "int8 a\n---\nint8 b\n", r"Bad\.action: an action needs two lines '---'"),
        ("Bad.action", "int8 a\n---\nint8 b\n---\nint8\n", r"Bad\.action:5: 'int8' is neither a field"),
    ],
)  # fmt: skip
def test_a_mistake_is_named_with_its_place(workspace: Workspace, name: str, text: str, reason: str) -> None:
    workspace.write(name, text)
    registry = workspace.registry()
    finds = {"msg": registry.message, "srv": registry.service, "action": registry.action}
    with pytest.raises(DefinitionError, match=reason):
        finds[name.partition(".")[2]]("robot_msgs", "Bad")


def test_an_unknown_type_is_named_with_the_message_that_uses_it(workspace: Workspace) -> None:
    workspace.write("Bad.msg", "geometry_msgs/Pont point\n")
    reason = r"Bad\.msg:1: the field 'point': geometry_msgs has no message 'Pont'; did you mean 'Point'\?$"
    with pytest.raises(DefinitionError, match=reason):
        workspace.registry().message("robot_msgs", "Bad")


@pytest.mark.parametrize(
    "file", ["Robot_msgs/msg/Good.msg", "robot_msgs/msg/bad.msg", "robot_msgs/msg/B_d.msg"]
)
def test_names_ros_does_not_take_are_refused_when_asked_for(tmp_path: Path, file: str) -> None:
    path = tmp_path / file
    path.parent.mkdir(parents=True)
    path.write_text("")
    registry = Registry(JazzyMessages(), DefinitionFolder(tmp_path))
    with pytest.raises(DefinitionError, match=rf"^{path}: the .*name '\w+' must be"):
        registry.message(path.parts[-3], path.stem)


def test_a_package_may_be_given_itself_and_is_named_by_its_manifest(workspace: Workspace) -> None:
    workspace.write("Wheel.msg", "float64 speed\n")
    package = workspace.root / "robot_msgs"
    assert DefinitionFolder(package).packages() == {"robot_msgs"}
    (package / "package.xml").write_text("<package><name>my_robot_msgs</name></package>")
    assert DefinitionFolder(package).packages() == {"my_robot_msgs"}
    assert DefinitionFolder(workspace.root).names("my_robot_msgs", "msg") == ("Wheel",)


def test_a_file_that_is_not_utf_8_is_named_with_its_line(workspace: Workspace) -> None:
    workspace.write("Bad.msg", "")
    (workspace.root / "robot_msgs" / "msg" / "Bad.msg").write_bytes(b"int8 a\n# \xe4\n")
    with pytest.raises(DefinitionError, match=r"Bad\.msg:2: the byte 0xe4 is not UTF-8"):
        workspace.registry().message("robot_msgs", "Bad")


def test_an_error_in_a_file_nobody_uses_hurts_nobody(workspace: Workspace) -> None:
    workspace.write("Bad.msg", "?\n")
    workspace.write("Good.msg", "int8 a\n")
    assert workspace.registry().message("robot_msgs", "Good")().a == 0


def test_a_definition_error_is_an_import_error() -> None:
    assert issubclass(DefinitionError, ImportError)
    assert issubclass(DefinitionError, ValueError)


def test_comments_and_blank_lines_say_nothing(workspace: Workspace) -> None:
    workspace.write("Base.msg", "\ufeff# speed\n\n  \t\nint8\ta\t# trailing\nint8 b 3# default\n#int8 c\n")
    base = workspace.registry().message("robot_msgs", "Base")
    assert base() == base(a=0, b=3)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("string s 'it\\'s'", "it's"),
        ('string s "it\'s"', "it's"),
        ("string s two words ", "two words"),
        ('string s "  kept  "', "  kept  "),
        ("string<=3 s abc", "abc"),
        ("wstring s ö", "ö"),
        ("int8 s 0x1F", 31),
        ("float64 s 1e3", 1000.0),
        ("byte s 255", b"\xff"),
        ("bool s True", True),
        ('string[<=3] s ["a, b", c]', ["a, b", "c"]),
        ("string[] s []", []),
        ("wstring[2] s ['a', 'b']", ["a", "b"]),
        ("bool[] s [true, 0]", [True, False]),
        ("byte[] s [1, 2]", [b"\x01", b"\x02"]),
    ],
)
def test_a_default_means_what_rosidl_reads(workspace: Workspace, text: str, value: object) -> None:
    workspace.write("Base.msg", text + "\n")
    assert workspace.registry().message("robot_msgs", "Base")().s == value


def test_an_action_has_three_parts_of_own_and_standard_messages(workspace: Workspace) -> None:
    workspace.write("Wheel.msg", "float64 speed\n")
    workspace.write("Drive.action", "Wheel wheel\nint8 FAST=1\n---\n---\ngeometry_msgs/Point at\n")
    drive = workspace.registry().action("robot_msgs", "Drive")
    assert drive.Goal().wheel.speed == 0.0
    assert drive.Goal.FAST == 1
    assert drive.Result.get_fields_and_field_types() == {}
    assert drive.Feedback.get_fields_and_field_types() == {"at": "geometry_msgs/Point"}


def test_constants_belong_to_the_class_and_are_seen_on_messages(workspace: Workspace) -> None:
    workspace.write("Mode.msg", "uint8 IDLE=0\nuint8 mode 1\n")
    mode = workspace.registry().message("robot_msgs", "Mode")
    assert mode.IDLE == mode().IDLE == 0
    for target in (mode, mode()):
        with pytest.raises(AttributeError):
            target.IDLE = 1


def test_a_missing_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(DefinitionError, match="nowhere: there is no such folder"):
        DefinitionFolder(tmp_path / "nowhere")
