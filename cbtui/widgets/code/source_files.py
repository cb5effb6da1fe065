"""The source files of a run's programs, as they were when the run was started or recorded."""

import ast
import sysconfig
from collections.abc import Mapping, Set
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType

from rich.cells import cell_len

import sim
from cbtui.widgets.code.highlight import SourceToken, highlight
from sim.files.untrusted import program_text

_LIBRARY_FOLDERS = tuple(
    {
        Path(place).resolve()
        for place in (*sim.__path__, *map(sysconfig.get_path, ("stdlib", "purelib", "platlib")))
    }
)
"""Folders of library code: ours, Python's, and installed packages."""


@dataclass(frozen=True, eq=False)
class SourceFile:
    """A file, its text, and the text's lines in words of a kind.

    ``recorded``: the text is that of a recording, or of an edited copy (``is_copy``), not the file's own.
    """

    path: Path
    text: str
    lines: tuple[list[SourceToken], ...]
    recorded: bool = False
    is_copy: bool = False

    @property
    def widest(self) -> int:
        """Columns of the longest line."""
        return max((sum(cell_len(word.text) for word in line) for line in self.lines), default=0)

    @cached_property
    def looped(self) -> Set[int]:
        """The lines inside loops, counted from 1."""
        try:
            nodes = list(ast.walk(ast.parse(self.text)))
        except (SyntaxError, ValueError):
            return frozenset()
        loops = (node for node in nodes if isinstance(node, ast.For | ast.While | ast.AsyncFor))
        return {line for loop in loops for line in range(loop.lineno, 1 + (loop.end_lineno or loop.lineno))}

    def has_changed(self) -> bool:
        """Whether the file on disk has another text; False if it is recorded or cannot be read."""
        text = None if self.recorded else program_text(self.path)
        return text is not None and text != self.text


class SourceFiles:
    """Finds the file that an entity's callback is in.

    ``main`` is the program's own file, ``source`` its text where that is not what lies there now, and
    ``recorded`` the texts that a recording holds, by path. A file is read once, when it is first asked for.
    """

    def __init__(
        self, main: Path, source: str | None = None, recorded: Mapping[str, str] = MappingProxyType({})
    ) -> None:
        self._recorded = recorded
        self._found: dict[str, SourceFile | None] = {}
        text = source if source is not None else program_text(main)
        self.main = _source_file(main, text or "", recorded=source is not None)
        self._real_main = main.resolve()
        self._by_path = {self._real_main: self.main}

    def of(self, file: str) -> SourceFile | None:
        """Return a callback's file; None if it is library code or unreadable.

        A name without a folder means the program's own file.
        """
        if file in self._recorded and self._found.get(file) is None:
            self._found.pop(file, None)
        if file not in self._found:
            self._found[file] = self._find(file)
        return self._found[file]

    def changed_beside_main(self) -> SourceFile | None:
        """Return a file that was asked for, other than the program's own, that has changed on disk."""
        others = (file for path, file in self._by_path.items() if path != self._real_main)
        return next((file for file in others if file.has_changed()), None)

    def read_anew(self, texts: Mapping[str, str]) -> None:
        """Read the files again; an unreadable one stays as it was.

        ``texts`` are run in place of files, by path.
        """
        self._found.clear()
        copies = {Path(path).resolve(): text for path, text in texts.items()}
        for path, known in self._by_path.items():
            text = copies.get(path)
            if text is None and (known.recorded or known.has_changed()):
                text = program_text(known.path)
            if text is not None:
                self._by_path[path] = _source_file(
                    known.path, text, recorded=path in copies, is_copy=path in copies
                )
        self.main = self._by_path[self._real_main]

    def _find(self, file: str) -> SourceFile | None:
        path = Path(file.replace("\0", ""))
        if file == self.main.path.name:
            return self.main
        if not path.is_absolute():
            return None
        real = path.resolve()
        if real in self._by_path:
            return self._by_path[real]
        if self._is_library_code(real):
            return None
        recorded = self._recorded.get(file)
        text = program_text(path) if recorded is None else recorded
        if text is None:
            return None
        self._by_path[real] = _source_file(path, text, recorded=recorded is not None or self.main.recorded)
        return self._by_path[real]

    def _is_library_code(self, path: Path) -> bool:
        """Tell whether a file is library code; a lesson may itself be installed in such a folder."""
        folders = (folder for folder in _LIBRARY_FOLDERS if not self._real_main.is_relative_to(folder))
        return any(path.is_relative_to(folder) for folder in folders)


def _source_file(path: Path, text: str, *, recorded: bool = False, is_copy: bool = False) -> SourceFile:
    return SourceFile(path, text, tuple(highlight(text)), recorded, is_copy)
