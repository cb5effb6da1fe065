"""Reads the interfaces of this package: ``definitions.interfaces``, a file for all of them."""

import re
from pathlib import Path

from sim.interfaces.folder import interface_parts
from sim.interfaces.interface_definition import Definition, Kind

_HEADING = re.compile(r"^=== (\w+)/(msg|srv|action)/(\w+)\n", re.MULTILINE)


class DefinitionBundle:
    """The definitions in an ``.interfaces`` file.

    A line ``=== std_srvs/srv/SetBool`` stands before the definition as ROS 2 has it in ``srv/SetBool.srv``.
    """

    def __init__(self, path: Path) -> None:
        self._texts: dict[tuple[str, str], dict[str, str]] = {}
        _, *sections = _HEADING.split(path.read_text(encoding="utf-8"))
        for package, kind, name, text in zip(*(sections[part::4] for part in range(4)), strict=True):
            self._texts.setdefault((package, kind), {})[name] = text

    def packages(self) -> frozenset[str]:
        """Return the packages."""
        return frozenset(package for package, _ in self._texts)

    def names(self, package: str, kind: Kind) -> tuple[str, ...]:
        """Return the sorted names of a package's interfaces of one kind."""
        return tuple(self._texts.get((package, kind), ()))

    def parts(self, package: str, kind: Kind, name: str) -> tuple[Definition, ...]:
        """Return the structures of an interface."""
        return interface_parts(self.text(package, kind, name), package, kind, name, "")

    def text(self, package: str, kind: Kind, name: str) -> str:
        """Return the definition of an interface."""
        return self._texts[package, kind][name]
