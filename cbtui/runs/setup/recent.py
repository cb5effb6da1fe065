"""What was opened lately, kept in a small file from one console to the next."""

import json
from collections.abc import Iterable, Sequence
from enum import StrEnum
from itertools import count, islice
from pathlib import Path

import msgspec

from lessons.personal import state_folder
from sim.foreign_file import MOST_OF_A_PROGRAM, read_bytes
from sim.whole_file import write_whole

FILE_NAME = "recent.jsonl"
FILES_KEPT = 20
"""How many programs and recordings are remembered."""
LESSONS_KEPT = 500
"""How many lessons are; more than there are."""


_CLOCKS = ("real", "virtual")


class Kind(StrEnum):
    """What was opened."""

    LESSON = "lesson"
    PROGRAM = "program"
    RECORDING = "recording"


class Opened(msgspec.Struct, frozen=True):
    """Something that was opened: ``what`` is a lesson's id or a file's absolute path.

    ``at`` is seconds since 1970; ``arguments`` and ``clock`` are how a program was run.
    """

    kind: Kind
    what: str
    at: int
    arguments: tuple[str, ...] = ()
    clock: str = "real"

    @property
    def name(self) -> str:
        """The file's name without its folder, or the lesson's id."""
        return self.what if self.kind is Kind.LESSON else Path(self.what).name

    @property
    def key(self) -> tuple[Kind, str]:
        """What two entries have in common that are about the same thing."""
        return self.kind, self.what


def usual_path() -> Path:
    """Where the file is kept: in the person's folder for the state of programs."""
    return state_folder() / FILE_NAME


class Recents:
    """The entries of a file of JSON lines, the newest first.

    Nothing here raises: a file that cannot be read or written leaves the console as it is, and ``troubles``
    gives a sentence on it, each kind of trouble once. The file is replaced as a whole, so that it is never
    half written; of two consoles that write at the same moment one may lose its entry. Not thread-safe.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = usual_path() if path is None else path
        self._entries: tuple[Opened, ...] | None = None
        self._troubles: list[str] = []
        self._told: set[str] = set()
        self._writable = True

    @property
    def entries(self) -> tuple[Opened, ...]:
        """Everything that is remembered; the file is read when this is asked for first."""
        if self._entries is None:
            self._entries = self._read()
        return self._entries

    @property
    def files(self) -> list[Opened]:
        """The programs and recordings."""
        return [entry for entry in self.entries if entry.kind is not Kind.LESSON]

    @property
    def lessons(self) -> dict[str, int]:
        """When each lesson was opened last, by its id."""
        return {entry.what: entry.at for entry in self.entries if entry.kind is Kind.LESSON}

    def note(self, entry: Opened) -> None:
        """Remember that something was opened."""
        before = self._read()
        self._keep([entry, *(each for each in before if each.key != entry.key)])

    def forget(self, entry: Opened) -> None:
        """Take something off the list."""
        self._keep([each for each in self._read() if each.key != entry.key])

    def troubles(self) -> list[str]:
        """Return what went wrong and was not told yet."""
        told, self._troubles = self._troubles, []
        return told

    def _read(self) -> tuple[Opened, ...]:
        """Read the file again: another console may have written it."""
        try:
            lines = read_bytes(self._whole_path(), MOST_OF_A_PROGRAM).splitlines()
        except FileNotFoundError:
            return self._entries or ()
        except OSError as error:
            self._writable = False
            self._tell("read", f"{self._path} cannot be read: {error.strerror}; nothing is remembered there")
            return self._entries or ()
        entries = [_entry_in(line) for line in lines]
        whole = _bounded(entry for entry in entries if entry is not None)
        if None in entries:
            self._set_aside(entries.index(None) + 1)
            self._write(whole)
        return whole

    def _keep(self, entries: Iterable[Opened]) -> None:
        self._entries = _bounded(entries)
        if self._writable:
            self._write(self._entries)

    def _write(self, entries: Sequence[Opened]) -> None:
        text = "".join(f"{json.dumps(msgspec.to_builtins(entry))}\n" for entry in entries)
        try:
            self._whole_path().parent.mkdir(parents=True, exist_ok=True)
            write_whole(self._whole_path(), text.encode("ascii"), mode=0o600)
        except OSError as error:
            self._tell("written", f"what you open is not remembered: {self._path}: {error.strerror}")

    def _whole_path(self) -> Path:
        """Return the path; without a home there is none."""
        if not self._path.is_absolute():
            raise OSError(0, "there is no home folder")
        return self._path

    def _set_aside(self, line: int) -> None:
        """Let a file that somebody else wrote into be looked at later."""
        names = (self._path.with_name(f"{self._path.name}.broken-{number}") for number in count(1))
        aside = next(path for path in names if not path.exists())
        try:
            self._path.rename(aside)
        except OSError:
            self._writable = False
            self._tell("broken", f"{self._path}:{line} is no entry; nothing is remembered there")
        else:
            self._tell(
                "broken",
                f"{self._path}:{line} is no entry; the file was kept as {aside.name}, "
                "and the list goes on with what could be read",
            )

    def _tell(self, trouble: str, sentence: str) -> None:
        if trouble not in self._told:
            self._told.add(trouble)
            self._troubles.append(sentence)


def _entry_in(line: bytes) -> Opened | None:
    try:
        entry = msgspec.convert(json.loads(line), Opened)
    except (ValueError, RecursionError):  # what msgspec complains with is a ValueError too
        return None
    return entry if entry.clock in _CLOCKS else None


def _bounded(entries: Iterable[Opened]) -> tuple[Opened, ...]:
    every = list(entries)
    files = (entry for entry in every if entry.kind is not Kind.LESSON)
    lessons = (entry for entry in every if entry.kind is Kind.LESSON)
    kept = [*islice(files, FILES_KEPT), *islice(lessons, LESSONS_KEPT)]
    return tuple(sorted(kept, key=every.index))


_UNITS = (
    (60, 60, "min", "min"),
    (3600, 24, "h", "h"),
    (86400, 7, "day", "days"),
    (604800, 53, "week", "weeks"),
)
"""Seconds of a unit, how many of them are not said in it any more, and what one and several are called."""


def ago(at: int, now: float) -> str:
    """Say in words how long before ``now`` a moment was; both are seconds since 1970."""
    passed = max(0, int(now) - at)
    if passed < 60:
        return "just now"
    for length, limit, one, several in _UNITS:
        number = passed // length
        if number < limit:
            return f"{number} {one if number == 1 else several} ago"
    return "over a year ago"
