"""The messages of ROS 2 Jazzy's standard packages, as defined by the rosbags library."""

import builtins
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.machinery import SourceFileLoader
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import cast

from rosbags.interfaces.typing import Typesdict

from sim.interfaces.definition_text import message_text
from sim.interfaces.interface_definition import FILLER_FIELD, Definition, Kind

DEFAULTS: Mapping[str, Mapping[str, object]] = {
    "geometry_msgs/msg/Quaternion": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
    "rcl_interfaces/msg/ParameterDescriptor": {"read_only": False, "dynamic_typing": False},
}
"""Default values declared in the standard ``.msg`` files; rosbags does not keep them."""


class JazzyMessages:
    """The definitions of all messages in rosbags' Jazzy typestore, which has no services and actions."""

    def __init__(self) -> None:
        names: dict[str, list[str]] = {}
        for type_name in sorted(jazzy_tables()):
            package, _, name = type_name.split("/")
            names.setdefault(package, []).append(name)
        self._names = {package: tuple(found) for package, found in names.items()}

    def packages(self) -> frozenset[str]:
        """Return the packages of the Jazzy typestore."""
        return frozenset(self._names)

    def names(self, package: str, kind: Kind) -> tuple[str, ...]:
        """Return a package's message names; empty for services and actions."""
        return self._names.get(package, ()) if kind == "msg" else ()

    def parts(self, package: str, kind: Kind, name: str) -> tuple[Definition]:
        """Return a message's definition with its default values."""
        type_name = f"{package}/msg/{name}"
        constants, fields = jazzy_tables()[type_name]
        own_fields = [entry for entry in fields if entry[0] != FILLER_FIELD]
        return (Definition(package, "msg", name, constants, own_fields, DEFAULTS.get(type_name, {})),)

    def text(self, package: str, kind: Kind, name: str) -> str:
        """Return a message's definition, without comments: rosbags does not keep them."""
        return message_text(*self.parts(package, kind, name))


@cache
def jazzy_tables() -> Typesdict:
    """Return rosbags' table of Jazzy messages: constants and fields by type name.

    rosbags' Jazzy module imports the modules of six earlier releases, which decorate about 300 dataclasses.
    That takes nine tenths of the import time, and only the tables are needed here. So the modules are
    executed privately, with a decorator that does nothing. The ordinary modules are not affected.
    """
    spec = find_spec("rosbags")
    assert spec is not None
    assert spec.submodule_search_locations
    stores = Path(spec.submodule_search_locations[0]) / "typesys" / "stores"

    def run(name: str) -> ModuleType:
        module = ModuleType(name)
        module.__dict__["__builtins__"] = {**vars(builtins), "__import__": importing}
        SourceFileLoader(name, str(stores / f"{name}.py")).exec_module(module)
        return module

    def importing(
        name: str,
        global_names: Mapping[str, object] | None = None,
        local_names: Mapping[str, object] | None = None,
        wanted: Sequence[str] = (),
        level: int = 0,
    ) -> object:
        if level:
            return SimpleNamespace(**{sibling: run(sibling) for sibling in wanted})
        if name == "dataclasses":
            return SimpleNamespace(dataclass=lambda cls: cls)
        return __import__(name, global_names, local_names, wanted, level)

    return cast("Typesdict", run("ros2_jazzy").FIELDDEFS)
