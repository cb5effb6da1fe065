"""Reads a ``package.xml``. Source of the format: REP 149."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

from sim.files.untrusted import read_bytes
from sim.packages.errors import PackageError

MANIFEST = "package.xml"
_NAME = re.compile(r"\w[\w-]*", re.ASCII)
"""Folders have this name, so that it must not contain a path."""


def read_name(folder: Path) -> str:
    """Return the package's name in the ``package.xml`` of ``folder``.

    Raises:
        PackageError: the file cannot be read, is not a package manifest, or declares XML entities.
    """
    path = folder / MANIFEST
    try:
        parser = ElementTree.XMLParser(target=_NoEntities(path))
        root = ElementTree.fromstring(read_bytes(path), parser=parser)
    except ElementTree.ParseError as error:
        line, _ = error.position
        raise PackageError(f"{path}:{line}: this is not XML: {str(error).split(':', 1)[0]}") from None
    except OSError as error:
        raise PackageError(f"{path}: {error.strerror}") from None
    name = (root.findtext("name") or "").strip()
    if root.tag != "package" or not name:
        raise PackageError(f"{path}: a package manifest needs <package> with a <name> in it")
    if not _NAME.fullmatch(name):
        raise PackageError(f"{path}: {name!r} is no name of a package; use letters, digits, '_' and '-'")
    return name


class _NoEntities(ElementTree.TreeBuilder):
    """Builds a tree, but refuses entities, which a few lines can expand without limit."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path = path

    def doctype(self, _name: str, _public: str | None, _system: str | None) -> None:
        raise PackageError(f"{self._path}: a package manifest with a DOCTYPE is not read; remove that line")
