"""The recently opened lessons, programs and recordings, in a small file that all consoles share."""

from collections.abc import Iterable
from enum import StrEnum
from itertools import islice
from pathlib import Path

import msgspec

from lessons.personal import state_folder
from lessons.state_file import StateFile, StateFileTexts

FILE_NAME = "recent.jsonl"
FILES_KEPT = 20
"""Programs and recordings that are remembered."""
LESSONS_KEPT = 500
"""Lessons that are remembered; there are fewer."""
_CLOCKS = ("real", "virtual")
_WORDS = StateFileTexts("entry", "what you open is not remembered", "the list goes on")


class RecentKind(StrEnum):
    """The kind of an entry."""

    LESSON = "lesson"
    PROGRAM = "program"
    RECORDING = "recording"


class RecentEntry(msgspec.Struct, frozen=True):
    """Something that was opened: ``what`` is a lesson's id or a file's absolute path.

    ``at`` is seconds since 1970; ``arguments`` and ``clock`` tell how a program was run.
    """

    kind: RecentKind
    what: str
    at: int
    arguments: tuple[str, ...] = ()
    clock: str = "real"

    def __post_init__(self) -> None:
        if self.clock not in _CLOCKS:
            raise ValueError(f"there is no clock {self.clock}")

    @property
    def name(self) -> str:
        """The file's name without its folder, or the lesson's id."""
        return self.what if self.kind is RecentKind.LESSON else Path(self.what).name

    @property
    def key(self) -> tuple[RecentKind, str]:
        """The identity of an entry's lesson or file."""
        return self.kind, self.what


def usual_path() -> Path:
    """The file's usual path, in the user's folder for state."""
    return state_folder() / FILE_NAME


class RecentList:
    """The entries of a file of JSON lines, the newest first.

    If the file cannot be read or written, the entries stay in memory, see ``StateFile``. Not thread-safe.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._file = StateFile(usual_path() if path is None else path, RecentEntry, _WORDS)
        self._entries: tuple[RecentEntry, ...] | None = None

    @property
    def entries(self) -> tuple[RecentEntry, ...]:
        """All entries; the file is read on the first access."""
        if self._entries is None:
            self._entries = self._read()
        return self._entries

    @property
    def latest(self) -> RecentEntry | None:
        """What was opened last; None for nothing."""
        return next(iter(self.entries), None)

    @property
    def files(self) -> list[RecentEntry]:
        """The programs and recordings."""
        return [entry for entry in self.entries if entry.kind is not RecentKind.LESSON]

    @property
    def lessons(self) -> dict[str, int]:
        """When each lesson was opened last, by its id."""
        return {entry.what: entry.at for entry in self.entries if entry.kind is RecentKind.LESSON}

    def note(self, entry: RecentEntry) -> None:
        """Remember an entry."""
        with self._file.lock():
            before = self._read()
            self._keep([entry, *(each for each in before if each.key != entry.key)])

    def forget(self, entry: RecentEntry) -> None:
        """Remove an entry from the list."""
        with self._file.lock():
            self._keep([each for each in self._read() if each.key != entry.key])

    def troubles(self) -> list[str]:
        """Return the errors that were not reported yet."""
        return self._file.troubles()

    def _read(self) -> tuple[RecentEntry, ...]:
        """Read the file again: another console may have written it."""
        content = self._file.read()
        if content is None:
            return self._entries or ()
        entries = _bounded(content.entries)
        if content.broken:
            self._file.write(entries)
        return entries

    def _keep(self, entries: Iterable[RecentEntry]) -> None:
        self._entries = _bounded(entries)
        self._file.write(self._entries)


def _bounded(entries: Iterable[RecentEntry]) -> tuple[RecentEntry, ...]:
    every = list(entries)
    files = (entry for entry in every if entry.kind is not RecentKind.LESSON)
    lessons = (entry for entry in every if entry.kind is RecentKind.LESSON)
    kept = [*islice(files, FILES_KEPT), *islice(lessons, LESSONS_KEPT)]
    return tuple(sorted(kept, key=every.index))


_UNITS = (
    (60, 60, "min", "min"),
    (3600, 24, "h", "h"),
    (86400, 7, "day", "days"),
    (604800, 53, "week", "weeks"),
)
"""A unit's seconds, the number of them from which the next unit is used, and its names."""


def time_ago(at: int, now: float) -> str:
    """Return how long before ``now`` a moment was, in words; both are seconds since 1970."""
    passed = max(0, int(now) - at)
    if passed < 60:
        return "just now"
    for length, limit, one, several in _UNITS:
        number = passed // length
        if number < limit:
            return f"{number} {one if number == 1 else several} ago"
    return "over a year ago"
