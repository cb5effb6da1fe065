"""The table of marks as CSV: rows are written as they are graded, and an earlier table can be resumed."""

import csv
import io
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TypeAlias

from cbtui.grading.grading import Grade, LoadedHandIn

SheetRow: TypeAlias = Mapping[str, str]
_BEFORE = ("learner", "lesson", "passed", "total")
_AFTER = ("problem", "suspicious", "digest")


class BadSheetError(Exception):
    """A table cannot be resumed; the text is a sentence."""


class UnwritableSheetError(Exception):
    """A table that cannot be written; the text is a sentence."""


class MarkSheet:
    """The rows, by their columns; ``checks`` is the number of columns for check results."""

    def __init__(self, checks: int) -> None:
        self._columns = [*_BEFORE, *(f"check {number}" for number in range(1, checks + 1)), *_AFTER]
        self.rows: list[SheetRow] = []
        self.unfinished: Sequence[str] = ()
        """Learner and lesson of the last row if the table that ``read`` took has only its beginning."""

    def beginning(self, entry: LoadedHandIn) -> str:
        """Return the beginning of an entry's row, which is known before its grade."""
        learner, lesson, _ = entry.key
        return self._text([_harmless(learner), _harmless(lesson), ""]).removesuffix("\n")

    def is_unfinished(self, entry: LoadedHandIn) -> bool:
        """Whether grading was cut short while the program of this entry ran."""
        return [*map(_harmless, entry.key[:2])] == [*self.unfinished]

    def add(self, grade: Grade) -> str:
        """Add a grade; returns its row as text."""
        learner, lesson, digest = grade.entry.key
        row = {
            "learner": learner,
            "lesson": lesson,
            "passed": str(grade.passed),
            "total": str(grade.entry.total),
            **{f"check {place}": _result(*each) for place, each in enumerate(grade.marks.checks, start=1)},
            "problem": grade.marks.trouble,
            "suspicious": grade.suspicion,
            "digest": digest,
        }
        self.rows.append({name: _harmless(text) for name, text in row.items()})
        return self._line(self.rows[-1])

    def read(self, text: str, wanted: Iterable[tuple[str, str, str]]) -> None:
        """Add those rows of an earlier table whose learner, lesson and digest are among ``wanted``.

        Raises:
            BadSheetError: it has other columns.
        """
        rows = [*csv.reader(io.StringIO(text))]
        if rows and text.find("\n") > 0 and rows[0] != self._columns:
            raise BadSheetError("its columns are not those of these exercises")
        known = {tuple(map(_harmless, key)) for key in wanted if key[-1]}
        if rows and not text.endswith("\n"):
            self.unfinished = rows.pop()[:2]
        for cells in rows[1:]:
            if (
                len(cells) == len(self._columns)
                and _key(row := dict(zip(self._columns, cells, strict=True))) in known
            ):
                self.rows.append(row)

    def holds(self, key: tuple[str, str, str]) -> bool:
        """Whether there is a row for a learner, a lesson and the digest of files."""
        return tuple(map(_harmless, key)) in map(_key, self.rows)

    def text(self) -> str:
        """Return the whole table."""
        return "".join([self._text(self._columns), *map(self._line, self.rows)])

    def _line(self, row: SheetRow) -> str:
        return self._text([row.get(name, "") for name in self._columns])

    def _text(self, cells: Iterable[str]) -> str:
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerow(cells)
        return text.getvalue()


def _key(row: SheetRow) -> tuple[str, ...]:
    return row["learner"], row["lesson"], row["digest"]


_PASSED, _FAILED = "passed: ", "failed: "


def check_results(row: SheetRow) -> Iterator[tuple[bool, str]]:
    """Yield for each check of a row, in order, whether it passed and the line on it."""
    for column, cell in row.items():
        if column.startswith("check ") and cell:
            yield cell.startswith(_PASSED), cell.removeprefix(_PASSED).removeprefix(_FAILED)


def _result(passed: bool, text: str) -> str:
    return f"{_PASSED if passed else _FAILED}{text}"


def _harmless(cell: str) -> str:
    """A cell that no spreadsheet evaluates as a formula: it may contain output of a learner's program."""
    return f"'{cell}" if cell.lstrip(" ").startswith(("=", "+", "-", "@", "\t", "\r", "\n")) else cell


class SheetStream:
    """A table that is written row by row to a stream; ``write`` takes text."""

    def __init__(self, sheet: MarkSheet, write: Callable[[str], None]) -> None:
        self._sheet = sheet
        self._write = write

    def begin(self) -> None:
        """Write what is in the table already."""
        self._write(self._sheet.text())

    def begun(self, entries: Iterable[LoadedHandIn]) -> Iterator[LoadedHandIn]:
        """Return the entries as they are."""
        return iter(entries)

    def append(self, row: str) -> None:
        """Write one more row."""
        self._write(row)

    def end(self) -> None:
        """Do nothing."""

    def restored(self) -> str | None:
        """Return None: a stream cannot be changed."""
        return None


class SheetFile:
    """A table in a file that is written row by row; changes by others are undone.

    A row is begun before its program runs: if that ends the grader, the table tells which program it was.
    """

    def __init__(self, sheet: MarkSheet, path: Path) -> None:
        self.path = path
        self._sheet = sheet
        self._written = b""
        self._begun = b""

    def begin(self) -> None:
        """Write the rows of an earlier table.

        Raises:
            UnwritableSheetError: as by every method.
        """
        self._written = _encoded(self._sheet.text())
        self._write(self._written, "wb")

    def begun(self, entries: Iterable[LoadedHandIn]) -> Iterator[LoadedHandIn]:
        """Yield each of the entries once its row is begun."""
        for entry in entries:
            self._begun = _encoded(self._sheet.beginning(entry))
            self._write(self._begun, "ab")
            yield entry

    def append(self, row: str) -> None:
        """Write the rest of the row that was begun."""
        data = _encoded(row)
        self._write(data.removeprefix(self._begun), "ab")
        self._written += data
        self._begun = b""

    def end(self) -> None:
        """Remove a row that was begun and not ended."""
        if self._begun:
            self._write(self._written, "wb")

    def restored(self) -> str | None:
        """Write the file again if it was changed; returns a sentence then, else None."""
        whole = self._written + self._begun
        if not self._is_ordinary() or self._holds(whole):
            return None
        self._write(whole, "wb")
        return f"{self.path} was changed while it ran"

    def _is_ordinary(self) -> bool:
        return self.path.is_file() or not self.path.exists()

    def _holds(self, data: bytes) -> bool:
        try:
            return self.path.read_bytes() == data
        except OSError:
            return False

    def _write(self, data: bytes, mode: str) -> None:
        try:
            with self.path.open(mode) as file:
                file.write(data)
                file.flush()
                if self._is_ordinary():
                    os.fsync(file.fileno())
        except OSError as error:
            raise UnwritableSheetError(f"{self.path} cannot be written: {error.strerror}") from error


def _encoded(text: str) -> bytes:
    return text.encode(errors="backslashreplace")
