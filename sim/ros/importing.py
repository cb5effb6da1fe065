"""Makes ``import rclpy`` and ``from std_srvs.srv import SetBool`` import this model, in this process.

Programs import modules of the model by their ROS names. Each module is
loaded once, under whichever of its two names it is imported.
"""

import importlib
import pkgutil
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from itertools import accumulate
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

from sim.interfaces.finder import InterfaceFinder

if TYPE_CHECKING:
    from importlib.abc import Loader


def _folders(package: str) -> list[str]:
    """The names of the modules in a package."""
    spec = find_spec(package)
    return [
        each.name for each in pkgutil.iter_modules(None if spec is None else spec.submodule_search_locations)
    ]


HOMES = {
    "rclpy": "sim.ros",
    "rosidl_runtime_py": "sim.interfaces",
    "sensor_msgs_py": "sim.interfaces",
    "test_msgs.message_fixtures": "sim.interfaces",
    **dict.fromkeys(_folders("sim.ros_packages"), "sim.ros_packages"),
}
"""The package of the model that contains each package or module of ROS."""


def install() -> None:
    """Make ``rclpy`` and the interface packages importable. A second call has no effect."""
    for name in [each for each in sys.modules if _home_of(each) is not None]:
        del sys.modules[name]
    parser: Any = ModuleType("rosidl_parser", "The types that the slots of messages are made of.")
    parser.definition = importlib.import_module("sim.interfaces.field_types")
    sys.modules["rosidl_parser"] = parser
    sys.modules["rosidl_parser.definition"] = parser.definition
    if not any(isinstance(finder, InterfaceFinder) for finder in sys.meta_path):
        sys.meta_path[:0] = (_ModelFinder(), InterfaceFinder())
    import_all_of("rclpy")  # before a program's time starts


def import_all_of(package: str) -> None:
    """Import rclpy by either of its names with all its modules except deprecated ones, which warn."""
    face = importlib.import_module(package)
    folders = [folder for folder in face.__path__ if not folder.endswith("_deprecated")]
    for each in pkgutil.walk_packages(folders, f"{package}."):
        importlib.import_module(each.name)


def _home_of(name: str) -> str | None:
    """The model's name of a module that a program imports; None for other modules."""
    prefixes = accumulate(name.split("."), "{}.{}".format)
    root = next((each for each in prefixes if each in HOMES), None)
    return None if root is None else f"{HOMES[root]}.{name}"


class _ModelFinder:
    """Finds the modules of ROS's Python packages in the model."""

    def find_spec(
        self, fullname: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of a module of the model, ``None`` for any other name."""
        home = _home_of(fullname)
        found = None if home is None else find_spec(home)
        if found is None:
            return None
        is_package = found.submodule_search_locations is not None
        return ModuleSpec(fullname, cast("Loader", self), is_package=is_package)

    def create_module(self, _spec: ModuleSpec) -> None:
        """None: ``exec_module`` replaces the module that Python creates."""

    def exec_module(self, module: ModuleType) -> None:
        """Replace the module with the model's module."""
        sys.modules[module.__name__] = importlib.import_module(str(_home_of(module.__name__)))
