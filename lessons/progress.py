"""How far a learner has come in each lesson, kept in a file of plain text from one console to the next."""

import fcntl
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path

import msgspec
from msgspec import Struct, structs

from lessons.personal import state_folder
from sim.foreign_file import read_bytes
from sim.whole_file import write_whole

FILE_NAME = "progress.jsonl"
_PATIENCE = 1.0
"""Seconds that another console may take to write; after that this one goes on without waiting for it."""
_LOOK = 0.02


class LessonProgress(Struct, frozen=True, kw_only=True):
    """How far a learner has come in one lesson."""

    lesson: str
    answers: tuple[int, ...] = ()
    """What was answered to its predictions, in their order; as many as were answered."""
    seen: bool = False
    """A run was watched to where its predictions can be told from."""
    hints: int = 0
    """How many hints were taken."""
    solution: bool = False
    """The solution was looked at."""
    passed: bool = False
    """The exercise passed every check."""


_decoder = msgspec.json.Decoder(LessonProgress)


def usual_path() -> Path:
    """Where the file is kept: in the person's folder for the state of programs."""
    return state_folder() / FILE_NAME


def faulty_line(path: Path) -> int | None:
    """Return the number of the first line of a progress file that is none, None if all are; changes nothing.

    Raises:
        OSError: the file cannot be read.
    """
    lines = enumerate(read_bytes(path).splitlines(), start=1)
    return next((number for number, line in lines if _entry_in(line) is None), None)


class Progress:
    """The progress in all lessons: a file of JSON lines, one for each lesson.

    Every change reads the file again, under a lock that other consoles respect, and replaces it as a whole;
    so none is lost, and none is half written. Nothing here raises: a file that cannot be read or written
    leaves the progress in memory, and ``troubles`` gives a sentence on it, each kind of trouble once. A file
    with something unreadable in it is kept under another name. Not thread-safe.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = usual_path() if path is None else path
        self._known: dict[str, LessonProgress] = {}
        self._troubles: list[str] = []
        self._told: set[str] = set()
        self._usable = True
        self.refresh()

    def of(self, lesson: str) -> LessonProgress:
        """Return how far the learner is in a lesson, as far as this console knows."""
        return self._known.get(lesson) or LessonProgress(lesson=lesson)

    def answer(self, lesson: str, place: int, answer: int) -> None:
        """Note an answer to the prediction at a place, the next one; a given answer stays as it is."""

        def answered(known: LessonProgress) -> LessonProgress:
            if place != len(known.answers):
                return known
            return structs.replace(known, answers=(*known.answers, answer))

        self._change(lesson, answered)

    def see(self, lesson: str) -> None:
        """Note that a run was watched."""
        self._change(lesson, lambda known: structs.replace(known, seen=True))

    def take_hint(self, lesson: str, number: int) -> None:
        """Note that the hint with that number, from 1, was taken."""
        self._change(lesson, lambda known: structs.replace(known, hints=max(known.hints, number)))

    def look_at_solution(self, lesson: str) -> None:
        """Note that the solution was looked at."""
        self._change(lesson, lambda known: structs.replace(known, solution=True))

    def passes(self, lesson: str) -> None:
        """Note that the exercise passed."""
        self._change(lesson, lambda known: structs.replace(known, passed=True))

    def reset(self, lesson: str) -> bool:
        """Forget everything about a lesson; tells whether there was anything."""
        nothing = LessonProgress(lesson=lesson)
        return self._change(lesson, lambda _: nothing) != nothing

    def refresh(self) -> None:
        """Take in what other consoles have written."""
        if os.path.lexists(self._path):
            with self._lock():
                self._read()

    def troubles(self) -> list[str]:
        """Return what went wrong and was not told yet."""
        told, self._troubles = self._troubles, []
        return told

    def _change(self, lesson: str, change: Callable[[LessonProgress], LessonProgress]) -> LessonProgress:
        """Change what is known of a lesson; what was known before."""
        with self._lock():
            self._read()
            before = self.of(lesson)
            after = change(before)
            if after != before:
                self._known[lesson] = after
                self._write()
        return before

    def _read(self) -> None:
        try:
            lines = read_bytes(self._whole_path()).splitlines()
        except FileNotFoundError:
            return
        except OSError as error:
            self._usable = False
            self._tell("read", f"{self._path} cannot be read: {error.strerror}; progress is not kept")
            return
        entries = [_entry_in(line) for line in lines]
        if None in entries:
            self._set_aside(entries.index(None) + 1)
        found = {entry.lesson: entry for entry in entries if entry is not None}
        if None in entries:
            self._known |= found
            self._write()
        else:
            self._known = found

    def _write(self) -> None:
        if not self._usable:
            return
        entries = (entry for entry in self._known.values() if entry != LessonProgress(lesson=entry.lesson))
        text = b"".join(msgspec.json.encode(entry) + b"\n" for entry in entries)
        try:
            self._whole_path().parent.mkdir(parents=True, exist_ok=True)
            write_whole(self._whole_path(), text, mode=0o600)
        except OSError as error:
            self._tell("written", f"progress is not kept: {self._path}: {error.strerror}")

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
            self._usable = False
            self._tell("broken", f"{self._path}:{line} is no progress; nothing more is kept there")
        else:
            self._tell(
                "broken",
                f"{self._path}:{line} is no progress; the file was kept as {aside.name}, "
                "and the lessons go on with what could be read",
            )

    @contextmanager
    def _lock(self) -> Iterator[None]:
        """Keep other consoles from writing meanwhile; where there can be no lock, there is none."""
        try:
            self._whole_path().parent.mkdir(parents=True, exist_ok=True)
            file = self._path.with_name(f"{self._path.name}.lock").open("wb")
        except OSError:
            yield  # whoever writes tells why that is not possible
            return
        with file:
            _wait_for(file.fileno())
            yield

    def _tell(self, trouble: str, sentence: str) -> None:
        if trouble not in self._told:
            self._told.add(trouble)
            self._troubles.append(sentence)


def _entry_in(line: bytes) -> LessonProgress | None:
    try:
        return _decoder.decode(line)
    except (ValueError, RecursionError):  # what msgspec complains with is a ValueError
        return None


def _wait_for(lock: int) -> None:
    """Take a lock when it is free; it goes with the file's descriptor, also when the console crashes."""
    give_up = time.monotonic() + _PATIENCE
    while time.monotonic() < give_up:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(_LOOK)
        except OSError:
            return  # a folder of another machine that knows no locks
        else:
            return
