"""Finding message and service classes by name, and building each one when it is first asked for."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from threading import RLock

from sim.ros.interfaces.base import Message, ServiceType
from sim.ros.interfaces.building import build_class
from sim.ros.interfaces.field_types import NamespacedType
from sim.ros.interfaces.interface_definition import Definition, DefinitionError, Kind, Source

_NOUNS: Mapping[Kind, str] = {"msg": "message", "srv": "service"}


class UnknownInterfaceError(LookupError):
    """No package, message or service has this name; the text names the nearest one."""


class Registry:
    """All interfaces of some sources. Safe to use from several threads."""

    def __init__(self, *sources: Source) -> None:
        self._sources = list(sources)
        self._messages: dict[tuple[str, str], type[Message]] = {}
        self._services: dict[tuple[str, str], ServiceType] = {}
        self._under_way: list[NamespacedType] = []
        self._lock = RLock()

    def add(self, source: Source) -> None:
        """Add a source of further interfaces.

        Raises:
            DefinitionError: it defines an interface that is already known.
        """
        with self._lock:
            for package in sorted(source.packages() & self.packages()):
                for kind in _NOUNS:
                    known = self._known(package, kind)
                    for name in source.names(package, kind):
                        if name in known:
                            raise DefinitionError(f"{package}/{kind}/{name} is already defined elsewhere")
            self._sources.append(source)

    def packages(self) -> frozenset[str]:
        """Return the names of all packages."""
        return frozenset().union(*(source.packages() for source in self._sources))

    def names(self, package: str, kind: Kind) -> tuple[str, ...]:
        """Return the sorted names of a package's messages or services."""
        packages = self.packages()
        if package not in packages:
            raise UnknownInterfaceError(f"there is no package {package!r}{_nearest(package, packages)}")
        return tuple(sorted(self._known(package, kind)))

    def message(self, package: str, name: str) -> type[Message]:
        """Return a message class, built with all it contains on the first call."""
        found = self._messages.get((package, name))
        if found is not None:
            return found
        with self._lock:
            if (package, name) not in self._messages:
                definition = self._source(package, "msg", name).message(package, name)
                self._messages[package, name] = self._build(definition)
            return self._messages[package, name]

    def service(self, package: str, name: str) -> ServiceType:
        """Return a service class, built with request and response on the first call."""
        found = self._services.get((package, name))
        if found is not None:
            return found
        with self._lock:
            if (package, name) not in self._services:
                request, response = self._source(package, "srv", name).service(package, name)
                self._services[package, name] = ServiceType(
                    name,
                    (),
                    {
                        "__module__": request.module_name,
                        "__doc__": f"Service class for {package}/srv/{name}; it is not instantiated.",
                        "Request": self._build(request),
                        "Response": self._build(response),
                        "__type_name__": f"{package}/srv/{name}",
                    },
                )
            return self._services[package, name]

    def _known(self, package: str, kind: Kind) -> frozenset[str]:
        return frozenset().union(*(source.names(package, kind) for source in self._sources))

    def _source(self, package: str, kind: Kind, name: str) -> Source:
        for source in self._sources:
            if name in source.names(package, kind):
                return source
        known = self.names(package, kind)
        other: Kind = "srv" if kind == "msg" else "msg"
        if name in self._known(package, other):
            raise UnknownInterfaceError(
                f"{package} has {name!r} as a {_NOUNS[other]}, not as a {_NOUNS[kind]}"
            )
        raise UnknownInterfaceError(f"{package} has no {_NOUNS[kind]} {name!r}{_nearest(name, known)}")

    def _build(self, definition: Definition) -> type[Message]:
        try:
            return build_class(definition, self._contained)
        except UnknownInterfaceError as error:
            raise UnknownInterfaceError(f"{definition.type_name}: {error}") from None

    def _contained(self, of: NamespacedType) -> type[Message]:
        if of in self._under_way:
            raise DefinitionError(f"{'/'.join(of.namespaced_name())} contains itself")
        self._under_way.append(of)
        try:
            return self.message(of.namespaces[0], of.name)
        finally:
            self._under_way.pop()


def _nearest(name: str, known: frozenset[str] | tuple[str, ...]) -> str:
    close = get_close_matches(name, sorted(known), n=1, cutoff=0.5)
    return f"; did you mean {close[0]!r}?" if close else ""
