"""Sentences on packages of other people that have the name of one of cbtui's own."""

import sys
from pathlib import Path

_HOME = Path(__file__).parents[2]
_OWN = {"cbtui", "lessons", "sim"}


def on_hidden(error: ImportError) -> str:
    """Return a sentence on the package that hides the one of cbtui's that was imported; else empty."""
    package, file = _found(error)
    if file is None or file.is_relative_to(_HOME):
        return ""
    return f"cbtui's own package {package} is hidden by {file}; rename that, or keep it off sys.path"


def on_hiding(error: ImportError, importer: Path) -> str:
    """Return a sentence on the package of cbtui's that hides one a file imports; empty for cbtui's files."""
    package, file = _found(error)
    if file is None or not file.is_relative_to(_HOME) or importer.is_relative_to(_HOME):
        return ""
    return f"{file.parent} is cbtui's own package {package}, which hides yours; rename yours"


def _found(error: ImportError) -> tuple[str, Path | None]:
    """Return the package in which something is missing, and its file if cbtui has one of that name."""
    package = (error.name or "").partition(".")[0]
    file = getattr(sys.modules.get(package), "__file__", None)
    return package, Path(file) if package in _OWN and file else None
