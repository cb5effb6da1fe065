"""Finding classes by name, and building no more than asked for."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from rosbags.typesys import Stores, get_typestore

from sim import interfaces
from sim.interfaces import (
    Kind,
    UnknownInterfaceError,
    action,
    from_cdr,
    message,
    message_of_type,
    names,
    packages,
    service,
    to_cdr,
)
from sim.interfaces.bundles import DefinitionBundle
from sim.interfaces.folder import DefinitionFolder
from sim.interfaces.interface_definition import FILLER_FIELD, Definition
from sim.interfaces.jazzy import JazzyMessages, jazzy_tables
from sim.interfaces.registry import Registry

DEFINITIONS = Path(interfaces.__file__).parent / "definitions.interfaces"


class Recording(JazzyMessages):
    """The Jazzy messages, with a list of those asked for."""

    def __init__(self) -> None:
        super().__init__()
        self.asked: list[str] = []

    def parts(self, package: str, kind: Kind, name: str) -> tuple[Definition]:
        self.asked.append(name)
        return super().parts(package, kind, name)


def every(kind: Kind) -> list[tuple[str, str]]:
    return [(package, name) for package in sorted(packages()) for name in names(package, kind)]


def test_a_class_is_built_once_with_what_it_contains_and_nothing_else() -> None:
    source = Recording()
    registry = Registry(source)
    assert source.asked == []
    twist = registry.message("geometry_msgs", "Twist")
    assert registry.message("geometry_msgs", "Twist") is twist
    assert source.asked == ["Twist", "Vector3"]


def test_threads_asking_at_once_get_one_class() -> None:
    registry = Registry(JazzyMessages())
    found: list[object] = []
    start = threading.Barrier(8)

    def ask() -> None:
        start.wait()
        found.append(registry.message("nav_msgs", "Odometry"))

    threads = [threading.Thread(target=ask) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8
    assert len(set(map(id, found))) == 1


def test_the_tables_are_those_of_rosbags_jazzy_store() -> None:
    assert jazzy_tables() == get_typestore(Stores.ROS2_JAZZY).fielddefs


def test_reading_the_tables_leaves_the_classes_of_rosbags_whole() -> None:
    jazzy_tables.cache_clear()
    jazzy_tables()
    assert all(dataclasses.is_dataclass(cls) for cls in get_typestore(Stores.ROS2_JAZZY).types.values())


def test_files_of_messages_rosbags_knows_say_the_same() -> None:
    files, jazzy = DefinitionBundle(DEFINITIONS), JazzyMessages()
    both = [
        (package, name)
        for package in files.packages() & jazzy.packages()
        for name in set(files.names(package, "msg")) & set(jazzy.names(package, "msg"))
    ]
    assert ("geometry_msgs", "Twist") in both
    for package, name in both:
        (ours,), (theirs,) = files.parts(package, "msg", name), jazzy.parts(package, "msg", name)
        assert (ours.constants, ours.fields) == (theirs.constants, theirs.fields)
        assert ours.defaults == theirs.defaults


def test_every_jazzy_message_is_there() -> None:
    assert {f"{package}/msg/{name}" for package, name in every("msg")} >= set(jazzy_tables())


@pytest.mark.parametrize(("package", "name"), every("msg"))
def test_every_message_can_be_made(package: str, name: str) -> None:
    cls = message(package, name)
    assert cls() == cls()
    assert FILLER_FIELD not in repr(cls())


@pytest.mark.parametrize(("package", "name"), every("srv"))
def test_every_service_has_request_and_response(package: str, name: str) -> None:
    found = service(package, name)
    assert repr(found.Request()).startswith(f"{package}.srv.{name}_Request(")
    assert repr(found.Response()).startswith(f"{package}.srv.{name}_Response(")


def test_the_services_of_the_lessons_and_of_parameters_are_there() -> None:
    assert names("std_srvs", "srv") == ("Empty", "SetBool", "Trigger")
    assert names("example_interfaces", "srv") == ("AddTwoInts", "SetBool", "Trigger")
    assert len(names("rcl_interfaces", "srv")) == 8


def test_a_service_class_cannot_be_instantiated() -> None:
    set_bool = service("std_srvs", "SetBool")
    with pytest.raises(NotImplementedError):
        set_bool()
    assert set_bool.__name__ == "SetBool"
    assert set_bool.__module__ == "std_srvs.srv._set_bool"


def test_constants_and_defaults_of_services_are_kept() -> None:
    assert service("nav_msgs", "LoadMap").Response.RESULT_UNDEFINED_FAILURE == 255
    assert service("type_description_interfaces", "GetTypeDescription").Request().include_type_sources is True


def test_full_names_lead_to_the_same_classes() -> None:
    assert message_of_type("std_msgs/msg/Int32") is message("std_msgs", "Int32")
    assert message_of_type("std_srvs/srv/SetBool_Request") is service("std_srvs", "SetBool").Request
    assert message_of_type("std_srvs/srv/SetBool_Response") is service("std_srvs", "SetBool").Response


@pytest.mark.parametrize("name", ["Int32", "std_msgs/Int32", "std_msgs/action/Int32", "std_srvs/srv/SetBool"])
def test_a_name_of_another_form_is_refused(name: str) -> None:
    with pytest.raises(UnknownInterfaceError, match=f"^{name!r} is not the full name of a message"):
        message_of_type(name)


@pytest.mark.parametrize(
    ("find", "package", "name", "text"),
    [
        (message, "std_mgs", "Int32", "there is no package 'std_mgs'; did you mean 'std_msgs'?"),
        (message, "std_msgs", "Int33", "std_msgs has no message 'Int33'; did you mean 'Int32'?"),
        (
            message,
            "std_msgs",
            "Twist",
            "std_msgs has no message 'Twist'; did you mean 'geometry_msgs/Twist'?",
        ),
        (action, "std_srvs", "SetBool", "std_srvs has 'SetBool' as a service, not as an action"),
        (service, "std_srvs", "SetBol", "std_srvs has no service 'SetBol'; did you mean 'SetBool'?"),
        (message, "qqq", "Int32", "there is no package 'qqq'"),
        (message, "std_srvs", "SetBool", "std_srvs has 'SetBool' as a service, not as a message"),
    ],
)
def test_unknown_names_lead_to_the_nearest(
    find: Callable[[str, str], object], package: str, name: str, text: str
) -> None:
    with pytest.raises(UnknownInterfaceError) as unknown:
        find(package, name)
    assert str(unknown.value) == text


def overlay(root: Path, text: str) -> DefinitionFolder:
    file = root / "geometry_msgs" / "msg" / "Vector3.msg"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    return DefinitionFolder(root)


def test_a_folder_overlays_what_is_known_and_leaves_the_rest_of_its_package(tmp_path: Path) -> None:
    registry = Registry(JazzyMessages())
    before = registry.message("geometry_msgs", "Twist")
    point = registry.message("geometry_msgs", "Point")
    registry.add(overlay(tmp_path, "float64 length\n"))
    after = registry.message("geometry_msgs", "Twist")
    assert after().linear.length == 0.0
    assert before().linear.x == 0.0
    assert registry.message("geometry_msgs", "Point") is point


def test_a_replaced_message_is_replaced_in_services_and_actions_too(tmp_path: Path) -> None:
    registry = Registry(JazzyMessages(), DefinitionBundle(DEFINITIONS))
    action, service = (
        registry.action("nav2_msgs", "NavigateToPose"),
        registry.service("gazebo_msgs", "SpawnEntity"),
    )
    fibonacci = registry.action("example_interfaces", "Fibonacci")
    file = tmp_path / "geometry_msgs" / "msg" / "Pose.msg"
    file.parent.mkdir(parents=True)
    file.write_text("float64 x\n")
    registry.add(DefinitionFolder(tmp_path))
    assert registry.action("nav2_msgs", "NavigateToPose") is not action
    assert registry.service("gazebo_msgs", "SpawnEntity") is not service
    assert registry.service("gazebo_msgs", "SpawnEntity").Request().initial_pose.x == 0.0
    assert registry.action("example_interfaces", "Fibonacci") is fibonacci


def test_adding_an_unchanged_folder_again_keeps_its_classes(tmp_path: Path) -> None:
    registry = Registry(JazzyMessages())
    registry.add(overlay(tmp_path, "float64 length\n"))
    vector = registry.message("geometry_msgs", "Vector3")
    registry.add(DefinitionFolder(tmp_path))
    assert registry.message("geometry_msgs", "Vector3") is vector
    registry.add(overlay(tmp_path, "float64 length\nfloat64 width\n"))
    assert registry.message("geometry_msgs", "Vector3")().width == 0.0


def test_a_replaced_class_and_its_replacement_both_go_over_the_wire(tmp_path: Path) -> None:
    registry = Registry(JazzyMessages())
    old = registry.message("geometry_msgs", "Twist")
    registry.add(overlay(tmp_path, "string name\n"))
    new = registry.message("geometry_msgs", "Twist")
    for twist in (old(), new()):
        assert from_cdr(type(twist), to_cdr(twist)) == twist


@pytest.mark.parametrize("package", sorted(packages()))
def test_every_interface_of_every_package_can_be_built(package: str) -> None:
    builders: dict[Kind, Callable[[str, str], object]] = {"msg": message, "srv": service, "action": action}
    for kind, build in builders.items():
        for name in names(package, kind):
            assert build(package, name)
