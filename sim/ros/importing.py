"""Makes ``import rclpy`` and ``from std_srvs.srv import SetBool`` mean this model, in this process.

The folders below hold what programs find, in modules that bear the names that ROS gives them. Each module is
loaded once, whichever of its two names it is imported by.
"""

import importlib
import pkgutil
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import TYPE_CHECKING, Any, cast

from sim.interfaces.finder import InterfaceFinder

if TYPE_CHECKING:
    from importlib.abc import Loader


def _folders(package: str) -> list[str]:
    """The packages in a package, by name."""
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
"""Packages and modules as programs name them, and the package of the model that has them."""


def install() -> None:
    """Put the model in rclpy's place and make the interface packages importable; twice does no harm."""
    for name in [each for each in sys.modules if _home_of(each) is not None]:
        del sys.modules[name]
    parser: Any = ModuleType("rosidl_parser", "The types that the slots of messages are made of.")
    parser.definition = importlib.import_module("sim.interfaces.field_types")
    sys.modules["rosidl_parser"] = parser
    sys.modules["rosidl_parser.definition"] = parser.definition
    if not any(isinstance(finder, InterfaceFinder) for finder in sys.meta_path):
        sys.meta_path[:0] = (_ModelFinder(), InterfaceFinder())
    _load_face()


def _load_face() -> None:
    """Import all of rclpy before a program's time begins to run; what is deprecated warns, so not that."""
    face = importlib.import_module("rclpy")
    folders = [folder for folder in face.__path__ if not folder.endswith("_deprecated")]
    for each in pkgutil.walk_packages(folders, "rclpy."):
        importlib.import_module(each.name)


def _home_of(name: str) -> str | None:
    """The name in the model of a module that a program imports; None for what is not the model's."""
    roots = (root for root in HOMES if name == root or name.startswith(f"{root}."))
    root = next(roots, None)
    return None if root is None else f"{HOMES[root]}.{name}"


class _ModelFinder:
    """Finds what programs import of ROS's Python packages, and loads the model's modules in their place."""

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
        """Leave it to Python: the module is replaced when it is filled."""

    def exec_module(self, module: ModuleType) -> None:
        """Put the model's module in its place."""
        sys.modules[module.__name__] = importlib.import_module(str(_home_of(module.__name__)))
