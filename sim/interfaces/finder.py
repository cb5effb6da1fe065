"""Imports of interfaces as in ROS 2: ``from std_srvs.srv import SetBool``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, cast

from sim.interfaces.interface_definition import Kind, module_stem
from sim.interfaces.known import action, message, message_of_type, names, packages, service

if TYPE_CHECKING:
    # At run time this module alone would cost as much as the rest of the package.
    from importlib.abc import Loader

_Makers = Mapping[str, Callable[[], object]]
"""What builds each class of a module, by the class's name."""

_BUILDERS: Mapping[Kind, Callable[[str, str], object]] = {"msg": message, "srv": service, "action": action}

_SERVICE_PARTS = ("Request", "Response", "Event")
_ACTION_PARTS = (
    *("Goal", "Result", "Feedback", "FeedbackMessage"),
    *(f"{service}_{part}" for service in ("SendGoal", "GetResult") for part in _SERVICE_PARTS),
)


class InterfaceFinder:
    """Finds the modules of all interface packages, for ``sys.meta_path``.

    The caller installs it before Python's own finders: these would take a folder ``my_interfaces/msg``
    beside the program for an empty package.

    It finds ``std_msgs``, ``std_msgs.msg`` and, as rosidl has a module for each interface,
    ``std_msgs.msg._int32``, which a pickled class refers to.
    """

    def __init__(self) -> None:
        # The packages are read before the first import, because reading them imports modules, too.
        packages()

    def find_spec(
        self, fullname: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the spec of an interface module, ``None`` for any other name."""
        if not _is_interface_module(fullname):
            return None
        return ModuleSpec(fullname, cast("Loader", _InterfaceLoader()), is_package=fullname.count(".") < 2)


class _InterfaceLoader:
    def create_module(self, spec: ModuleSpec) -> ModuleType:
        return interface_module(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Do nothing: the module builds its classes when they are used."""


class InterfaceModule(ModuleType):
    """A module whose classes are built when they are first used."""

    def __init__(self, name: str, doc: str, makers: _Makers) -> None:
        super().__init__(name, doc)
        self.__all__ = list(makers)
        self._makers = makers

    def __getattr__(self, name: str) -> object:
        make = self._makers.get(name) if "_makers" in vars(self) else None
        if make is None:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        made = make()
        setattr(self, name, made)
        return made

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.__all__} - {"_makers"})


def interface_module(name: str) -> ModuleType:
    """Return a new module object for ``std_msgs``, ``std_msgs.msg`` or ``std_msgs.msg._int32``.

    A package's module is empty until its ``msg``, ``srv`` or ``action`` is imported, as in ROS 2. The classes
    in the other two kinds of modules are built when first used; ``dir()`` lists them before that.

    Raises:
        ModuleNotFoundError: no known interface package has such a module.
    """
    if not _is_interface_module(name):
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)
    package, *inside = name.split(".")
    if not inside:
        return ModuleType(name, f"Interfaces of {package}.")
    kind = cast("Kind", inside[0])
    if len(inside) == 1:
        build = _BUILDERS[kind]
        makers: _Makers = {found: partial(build, package, found) for found in names(package, kind)}
        return InterfaceModule(name, f"The {kind} interfaces of {package}.", makers)
    owner = _owner(package, kind, inside[1])
    return InterfaceModule(
        name, f"The classes of {package}/{kind}/{owner}.", _makers_of(package, kind, owner)
    )


def _is_interface_module(name: str) -> bool:
    package, *inside = name.split(".")
    if package not in packages() or len(inside) > 2:
        return False
    if not inside:
        return True
    if inside[0] not in _BUILDERS:
        return False
    kind = cast("Kind", inside[0])
    return bool(names(package, kind) if len(inside) == 1 else _owner(package, kind, inside[1]))


def _owner(package: str, kind: Kind, stem: str) -> str:
    """Return the interface whose own module has this name; empty without one."""
    return next((name for name in names(package, kind) if module_stem(name) == stem), "")


def _makers_of(package: str, kind: Kind, owner: str) -> _Makers:
    if kind == "msg":
        return {owner: partial(message, package, owner)}
    parts = _SERVICE_PARTS if kind == "srv" else _ACTION_PARTS
    makers: dict[str, Callable[[], object]] = {
        f"{owner}_{part}": partial(message_of_type, f"{package}/{kind}/{owner}_{part}") for part in parts
    }
    if kind == "srv":
        return {owner: partial(service, package, owner), **makers}
    return {
        owner: partial(action, package, owner),
        f"{owner}_SendGoal": lambda: action(package, owner).Impl.SendGoalService,
        f"{owner}_GetResult": lambda: action(package, owner).Impl.GetResultService,
        **makers,
    }
