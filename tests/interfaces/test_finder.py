"""Importing interfaces the way ROS 2 nodes do."""

from __future__ import annotations

import copy
import importlib
import pickle
import sys
from collections.abc import Iterator
from typing import Any

import pytest

from sim.ros.interfaces import InterfaceFinder, interface_module, message, packages, service


@pytest.fixture(autouse=True)
def finder() -> Iterator[None]:
    """Install the finder for one test and leave the interpreter as it was."""
    before, modules = sys.meta_path[:], sys.modules.copy()
    sys.meta_path.append(InterfaceFinder())
    yield
    sys.meta_path[:] = before
    for name in set(sys.modules) - set(modules):
        if name.partition(".")[0] in packages():
            del sys.modules[name]


def run(code: str) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(code, names)
    return names


def test_imports_give_the_classes() -> None:
    found = run(
        "from std_srvs.srv import SetBool\nfrom geometry_msgs.msg import Twist\nimport std_msgs.msg as m"
    )
    assert found["SetBool"] is service("std_srvs", "SetBool")
    assert found["Twist"] is message("geometry_msgs", "Twist")
    assert found["m"].Int32 is message("std_msgs", "Int32")


def test_a_star_import_gives_every_message_of_the_package() -> None:
    assert {"Odometry", "Path", "OccupancyGrid"} <= set(run("from nav_msgs.msg import *"))


def test_dir_lists_names_without_building_them() -> None:
    module = interface_module("std_msgs.msg")
    assert {"Int32", "String", "Header"} <= set(dir(module))
    assert "Int32" not in vars(module)


def test_an_unknown_name_fails_as_in_any_module() -> None:
    with pytest.raises(ImportError, match=r"^cannot import name 'Int33' from 'std_msgs.msg'"):
        run("from std_msgs.msg import Int33")
    with pytest.raises(AttributeError, match=r"^module 'std_msgs.msg' has no attribute 'Int33'$"):
        run("import std_msgs.msg\nstd_msgs.msg.Int33")


@pytest.mark.parametrize(
    "name",
    [
        "std_msgs.foo",
        "std_msgs.msg._int33",
        "std_msgs.msg._int32.deep",
        "std_srvs.msg",
        "no_msgs",
        "std_mgs.msg",
    ],
)
def test_an_unknown_module_is_not_found(name: str) -> None:
    with pytest.raises(ModuleNotFoundError):
        importlib.import_module(name)
    with pytest.raises(ModuleNotFoundError, match=f"^No module named '{name}'$"):
        interface_module(name)


def test_other_modules_are_left_to_other_finders() -> None:
    assert InterfaceFinder().find_spec("json") is None
    assert InterfaceFinder().find_spec("json.decoder") is None


def test_requests_are_reached_through_their_service_as_in_ros() -> None:
    with pytest.raises(ImportError):
        run("from std_srvs.srv import SetBool_Request")
    found = run("from std_srvs.srv._set_bool import SetBool_Request, SetBool")
    assert found["SetBool_Request"] is found["SetBool"].Request


def test_classes_pickle_by_name() -> None:
    set_bool = service("std_srvs", "SetBool")
    for cls in (message("geometry_msgs", "Twist"), set_bool, set_bool.Request):
        assert pickle.loads(pickle.dumps(cls)) is cls


def test_messages_pickle_and_copy() -> None:
    scan = message("sensor_msgs", "LaserScan")(
        ranges=[0.5], header=message("std_msgs", "Header")(frame_id="laser")
    )
    assert pickle.loads(pickle.dumps(scan)) == scan
    deep, shallow = copy.deepcopy(scan), copy.copy(scan)
    assert deep == shallow == scan
    assert deep.header is not scan.header
    assert shallow.header is scan.header


def test_a_deep_copy_keeps_every_digit() -> None:
    assert copy.deepcopy(message("std_msgs", "Float32")(data=0.1)).data == 0.1


def test_messages_pickle_without_the_finder() -> None:
    sys.meta_path.pop()
    request = service("std_srvs", "SetBool").Request(data=True)
    assert pickle.loads(pickle.dumps(request)) == request
