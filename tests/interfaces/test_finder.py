"""Importing interfaces the way ROS 2 nodes do."""

from __future__ import annotations

import copy
import importlib
import pickle
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from sim.interfaces import (
    InterfaceFinder,
    add_definitions,
    find_definition_folders,
    interface_module,
    known,
    message,
    packages,
    service,
)
from sim.interfaces.bundles import DefinitionBundle
from sim.interfaces.jazzy import JazzyMessages
from sim.interfaces.registry import Registry

DEFINITIONS = Path(known.__file__).parent / "definitions.interfaces"


@pytest.fixture(autouse=True)
def finder() -> Iterator[None]:
    """Install the finder for one test and leave the interpreter as it was."""
    before, others = sys.meta_path[:], _forget_interfaces()  # such as those of a real ROS 2
    sys.meta_path.insert(0, InterfaceFinder())
    yield
    sys.meta_path[:] = before
    _forget_interfaces()
    sys.modules.update(others)


def _forget_interfaces() -> dict[str, ModuleType]:
    """Remove the modules of interface packages, and return them."""
    names = [name for name in sys.modules if name.partition(".")[0] in packages()]
    return {name: sys.modules.pop(name) for name in names}


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
    del sys.meta_path[0]
    request = service("std_srvs", "SetBool").Request(data=True)
    assert pickle.loads(pickle.dumps(request)) == request


def test_the_first_finder_of_a_process_does_not_ask_itself_without_end() -> None:
    code = (
        "import sys\nfrom sim.interfaces import InterfaceFinder\n"
        "sys.meta_path.insert(0, InterfaceFinder())\nimport wave\nfrom std_msgs.msg import Int32\nInt32()"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_own_packages_win_over_the_bare_folders_python_sees(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    registry = Registry(DefinitionBundle(DEFINITIONS), JazzyMessages())
    monkeypatch.setattr(known, "_registry", lambda: registry)
    folder = tmp_path / "course" / "my_interfaces" / "msg"
    folder.mkdir(parents=True)
    (folder / "Num.msg").write_text("int32 n 3\n")
    (folder / "Bad.msg").write_text("int n\n")
    for found in find_definition_folders(tmp_path / "course" / "node.py"):
        add_definitions(found)
    monkeypatch.syspath_prepend(tmp_path / "course")
    assert run("from my_interfaces.msg import Num")["Num"]().n == 3
    with pytest.raises(ImportError, match=r"Bad\.msg:1: there is no type 'int'; did you mean 'int32'\?"):
        run("from my_interfaces.msg import Bad")
    for name in [name for name in sys.modules if name.partition(".")[0] == "my_interfaces"]:
        del sys.modules[name]
