"""An edit of a program's source that a rule advises, as a value."""

from collections.abc import Callable
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor


@dataclass(frozen=True, slots=True)
class CodeEdit:
    """An edit of one file: its description, a clause, and its function.

    ``change`` gets the source and the ``arguments``; it edits the source, or raises ``NotSimpleError`` if the
    source does not have the shape that the edit needs.
    """

    file: str
    words: str
    change: Callable[..., None]
    arguments: tuple[object, ...]

    def applied(self, text: str) -> str | None:
        """Return the edited text; None if the source does not have the shape that the edit needs."""
        try:
            source = SourceEditor(text)
            self.change(source, *self.arguments)
            edited = source.result()
        except NotSimpleError:
            return None
        return None if edited == text else edited


def diff(file: str, before: str, after: str) -> str:
    """Return the difference of two texts of a file, as ``diff -U1`` writes it."""
    name = Path(file).name
    lines = unified_diff(before.splitlines(), after.splitlines(), name, f"{name}, the copy", n=1, lineterm="")
    return "\n".join(lines)
