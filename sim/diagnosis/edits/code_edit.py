"""An edit of a program's source that a rule advises, as a value."""

from collections.abc import Callable
from dataclasses import dataclass
from difflib import unified_diff
from pathlib import Path

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor


@dataclass(frozen=True, slots=True)
class CodeEdit:
    """An edit of one file: in words, as a clause, and how it is made.

    ``change`` edits the source, or raises ``NotSimpleError`` where that has not the shape it is for; it also
    gets the ``arguments``.
    """

    file: str
    words: str
    change: Callable[..., None]
    arguments: tuple[object, ...]

    def applied(self, text: str) -> str | None:
        """The edited text; None if the source has not the simple shape that the edit is for."""
        try:
            source = SourceEditor(text)
            self.change(source, *self.arguments)
            edited = source.result()
        except NotSimpleError:
            return None
        return None if edited == text else edited


def diff(file: str, before: str, after: str) -> str:
    """The difference of two texts of a file, as ``diff -U1`` writes it."""
    name = Path(file).name
    lines = unified_diff(before.splitlines(), after.splitlines(), name, f"{name}, the copy", n=1, lineterm="")
    return "\n".join(lines)
