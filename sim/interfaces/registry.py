"""Finds message, service and action classes by name, and builds each class at its first use."""

from collections.abc import Callable, Mapping
from difflib import get_close_matches
from threading import RLock
from typing import TypeVar, cast

from sim.interfaces.action_parts import ActionDefinition
from sim.interfaces.base import ActionType, Message, ServiceType
from sim.interfaces.building import build_class
from sim.interfaces.field_types import NamespacedType
from sim.interfaces.interface_definition import (
    Definition,
    DefinitionSource,
    Kind,
    UnknownInterfaceError,
    owner_of,
)
from sim.interfaces.owners import action_class, service_class
from sim.interfaces.service_events import event_definition

_NOUNS: Mapping[Kind, str] = {"msg": "message", "srv": "service", "action": "action"}

_COMMON_PACKAGES = ("std_msgs", "geometry_msgs", "sensor_msgs", "std_srvs", "nav_msgs")
"""The packages to suggest first if several packages have an interface of the same name."""

BuiltT = TypeVar("BuiltT")


class Registry:
    """The interfaces of several sources. Thread-safe.

    If two sources have an interface of the same name, the later source counts, as for the
    overlaid workspaces of ROS 2.
    """

    def __init__(self, *sources: DefinitionSource) -> None:
        self._sources = list(reversed(sources))
        self._packages = frozenset().union(*(source.packages() for source in sources))
        self._messages: dict[str, type[Message]] = {}
        self._services: dict[str, ServiceType] = {}
        self._actions: dict[str, ActionType] = {}
        self._under_way: list[NamespacedType] = []
        self._lock = RLock()

    def add(self, source: DefinitionSource) -> None:
        """Put a source before all others. The classes that it changes are rebuilt at their next use.

        An unchanged source that was added before keeps its place.
        """
        with self._lock:
            replaced = {
                f"{package}/{kind}/{name}"
                for package in source.packages() & self.packages()
                for kind in _NOUNS
                for name in source.names(package, kind)
            }
            if source not in self._sources:
                self._sources.insert(0, source)
                self._packages |= source.packages()
                self._forget(replaced)

    def packages(self) -> frozenset[str]:
        """Return the names of all packages."""
        return self._packages

    def names(self, package: str, kind: Kind) -> tuple[str, ...]:
        """Return the sorted names of a package's interfaces of one kind."""
        packages = self.packages()
        if package not in packages:
            raise UnknownInterfaceError(f"there is no package {package!r}{_nearest(package, packages)}")
        return tuple(sorted(self._known(package, kind)))

    def message(self, package: str, name: str) -> type[Message]:
        """Return a message class; the first call builds it and the classes that it contains."""
        return self._built(
            self._messages, f"{package}/msg/{name}", lambda: self._build(*self._parts(package, "msg", name))
        )

    def service(self, package: str, name: str) -> ServiceType:
        """Return a service class; the first call builds it with request and response."""
        return self._built(self._services, f"{package}/srv/{name}", lambda: self._new_service(package, name))

    def action(self, package: str, name: str) -> ActionType:
        """Return an action class; the first call builds it with its messages and services."""
        return self._built(self._actions, f"{package}/action/{name}", lambda: self._new_action(package, name))

    def part(self, package: str, kind: Kind, name: str) -> type[Message]:
        """Return a message, or a part of a service or an action such as ``SetBool_Request``."""
        if kind == "msg":
            return self.message(package, name)
        type_name = f"{package}/{kind}/{name}"
        if type_name not in self._messages:
            owner = owner_of(name)
            built = self.service(package, owner) if kind == "srv" else self.action(package, owner)
            if name.endswith("_Event"):
                self._build_event(built, type_name)
        if type_name not in self._messages:
            raise UnknownInterfaceError(f"{package} has no {kind} part {name!r}")
        return self._messages[type_name]

    def text(self, package: str, kind: Kind, name: str) -> str:
        """Return an interface's definition as its author wrote it."""
        return self._source(package, kind, name).text(package, kind, name)

    def _build_event(self, owner: ServiceType | ActionType, type_name: str) -> None:
        services = {
            f"{service.__type_name__}_Event": service
            for service in (
                (owner,)
                if isinstance(owner, ServiceType)
                else (owner.Impl.SendGoalService, owner.Impl.GetResultService)
            )
        }
        if type_name in services:
            self._built(self._messages, type_name, lambda: self._build(event_definition(services[type_name])))

    def _built(self, classes: dict[str, BuiltT], type_name: str, build: Callable[[], BuiltT]) -> BuiltT:
        found = classes.get(type_name)
        if found is not None:
            return found
        with self._lock:
            if type_name not in classes:
                classes[type_name] = build()
            return classes[type_name]

    def _new_service(self, package: str, name: str) -> ServiceType:
        request, response = self._parts(package, "srv", name)
        return service_class(request, response, self._build)

    def _new_action(self, package: str, name: str) -> ActionType:
        parts = ActionDefinition(*self._parts(package, "action", name))
        cancel_goal, status = ("action_msgs", "CancelGoal"), ("action_msgs", "GoalStatusArray")
        return action_class(parts, self._build, self.service(*cancel_goal), self.message(*status))

    def _parts(self, package: str, kind: Kind, name: str) -> tuple[Definition, ...]:
        return self._source(package, kind, name).parts(package, kind, name)

    def _known(self, package: str, kind: Kind) -> frozenset[str]:
        return frozenset().union(*(source.names(package, kind) for source in self._sources))

    def _source(self, package: str, kind: Kind, name: str) -> DefinitionSource:
        for source in self._sources:
            if name in source.names(package, kind):
                return source
        known = self.names(package, kind)
        for other in _NOUNS:
            if name in self._known(package, other):
                raise UnknownInterfaceError(
                    f"{package} has {name!r} as {_a(_NOUNS[other])}, not as {_a(_NOUNS[kind])}"
                )
        elsewhere = [f"{other}/{name}" for other in self.packages() if name in self._known(other, kind)]
        hint = _did_you_mean(min(elsewhere, key=_rarity)) if elsewhere else _nearest(name, known)
        raise UnknownInterfaceError(f"{package} has no {_NOUNS[kind]} {name!r}{hint}")

    def _build(self, definition: Definition) -> type[Message]:
        built = build_class(definition, self._contained)
        self._messages[definition.type_name] = built
        return built

    def _contained(self, of: NamespacedType) -> type[Message]:
        if of in self._under_way:
            raise UnknownInterfaceError(f"{'/'.join(of.namespaced_name())} contains itself")
        self._under_way.append(of)
        try:
            package, kind = of.namespaces
            return self.part(package, cast("Kind", kind), of.name)
        finally:
            self._under_way.pop()

    def _forget(self, replaced: set[str]) -> None:
        """Drop the built classes that are, belong to or contain one of these interfaces."""

        def is_stale(cls: type[Message]) -> bool:
            parts = cls.__interface__.parts.values()
            return _owner(cls) in replaced or any(map(is_stale, parts))

        stale = {type_name for type_name, cls in self._messages.items() if is_stale(cls)}
        owners = {_owner(self._messages[type_name]) for type_name in stale}
        self._messages = {name: cls for name, cls in self._messages.items() if name not in stale}
        self._services = {name: cls for name, cls in self._services.items() if name not in owners}
        self._actions = {name: cls for name, cls in self._actions.items() if name not in owners}


def _owner(cls: type[Message]) -> str:
    """Return the full name of the message, or of the service or action that a class belongs to."""
    definition = cls.__interface__.definition
    name = definition.name if definition.kind == "msg" else owner_of(definition.name)
    return f"{definition.package}/{definition.kind}/{name}"


def _a(noun: str) -> str:
    return f"an {noun}" if noun.startswith("a") else f"a {noun}"


def _rarity(full_name: str) -> tuple[int, str]:
    package = full_name.partition("/")[0]
    return (_COMMON_PACKAGES.index(package) if package in _COMMON_PACKAGES else 99), package


def _nearest(name: str, known: frozenset[str] | tuple[str, ...]) -> str:
    close = get_close_matches(name, sorted(known), n=1, cutoff=0.5)
    return _did_you_mean(close[0]) if close else ""


def _did_you_mean(name: str) -> str:
    return f"; did you mean {name!r}?"
