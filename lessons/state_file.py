"""The store for small persistent state: a file of JSON lines, shared with other consoles."""

import fcntl
import json
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Generic, NamedTuple, TypeVar

import msgspec

from sim.files.atomic import write_atomically
from sim.files.untrusted import MAX_PROGRAM_BYTES, read_bytes

EntryT = TypeVar("EntryT", bound=msgspec.Struct)

_LOCK_TIMEOUT = 1.0
"""Seconds to wait for another console's lock; after that this one continues without it."""
_POLL = 0.02


@dataclass(frozen=True)
class StateFileTexts:
    """Words for sentences on a file: an entry, the loss of all entries, the effect of a partial loss."""

    entry: str
    loss: str
    rest: str


class StateFileContent(NamedTuple, Generic[EntryT]):
    """The readable entries of a file; ``broken`` if it had other lines and was set aside."""

    entries: list[EntryT]
    broken: bool


class StateFile(Generic[EntryT]):
    """Entries of one kind, a JSON line each.

    A file is replaced as a whole, so it is never half written. Only ``faulty_line`` raises: if the file
    cannot be read or written, the state stays in memory and ``troubles`` returns a sentence, once for each
    kind of error. A file with unreadable lines is kept under another name. Not thread-safe.
    """

    def __init__(self, path: Path, kind: type[EntryT], words: StateFileTexts) -> None:
        self.path = path
        self._kind = kind
        self._words = words
        self._troubles: list[str] = []
        self._told: set[str] = set()
        self._usable = True

    def read(self) -> StateFileContent[EntryT] | None:
        """Return the content of the file; None if it is missing or unreadable."""
        try:
            lines = read_bytes(self._known_path(), MAX_PROGRAM_BYTES).splitlines()
        except FileNotFoundError:
            return None
        except OSError as error:
            self._usable = False
            self._tell("read", f"{self.path} cannot be read: {error.strerror}; {self._words.loss}")
            return None
        entries = [self._entry_in(line) for line in lines]
        if None in entries:
            self._set_aside(entries.index(None) + 1)
        return StateFileContent([entry for entry in entries if entry is not None], None in entries)

    def write(self, entries: Iterable[EntryT]) -> None:
        """Replace the file."""
        if not self._usable:
            return
        lines = (json.dumps(msgspec.to_builtins(entry), separators=(",", ":")) for entry in entries)
        text = "".join(f"{line}\n" for line in lines)
        try:
            self._known_path().parent.mkdir(parents=True, exist_ok=True)
            write_atomically(self.path, text.encode("ascii"), mode=0o600)
        except OSError as error:
            self._tell("written", f"{self._words.loss}: {self.path}: {error.strerror}")

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Lock out other consoles during the block; does nothing where locking is impossible."""
        try:
            self._known_path().parent.mkdir(parents=True, exist_ok=True)
            file = self.path.with_name(f"{self.path.name}.lock").open("wb")
        except OSError:
            yield  # ``write`` reports the reason
            return
        with file:
            _wait_for(file.fileno())
            yield

    def troubles(self) -> list[str]:
        """Return the errors that were not reported yet."""
        troubles, self._troubles = self._troubles, []
        return troubles

    def faulty_line(self) -> int | None:
        """Return the number of the first invalid line, None if there is none; changes nothing.

        Raises:
            OSError: the file cannot be read.
        """
        lines = enumerate(read_bytes(self.path, MAX_PROGRAM_BYTES).splitlines(), start=1)
        return next((number for number, line in lines if self._entry_in(line) is None), None)

    def _entry_in(self, line: bytes) -> EntryT | None:
        try:
            return msgspec.convert(json.loads(line), self._kind)
        except (ValueError, RecursionError):  # msgspec's errors are ValueErrors
            return None

    def _known_path(self) -> Path:
        """Return the path; None without a home folder."""
        if not self.path.is_absolute():
            raise OSError(0, "there is no home folder")
        return self.path

    def _set_aside(self, line: int) -> None:
        """Keep a file with foreign lines under another name."""
        names = (self.path.with_name(f"{self.path.name}.broken-{number}") for number in count(1))
        aside = next(path for path in names if not path.exists())
        what = f"{self.path}:{line} is no {self._words.entry}"
        try:
            self.path.rename(aside)
        except OSError:
            self._usable = False
            self._tell("broken", f"{what}; {self._words.loss}")
        else:
            rest = f"{self._words.rest} with what could be read"
            self._tell("broken", f"{what}; the file was kept as {aside.name}, and {rest}")

    def _tell(self, trouble: str, sentence: str) -> None:
        if trouble not in self._told:
            self._told.add(trouble)
            self._troubles.append(sentence)


def _wait_for(lock: int) -> None:
    """Wait for a lock; closing the descriptor releases it, as a crash of the console does."""
    deadline = time.monotonic() + _LOCK_TIMEOUT
    while time.monotonic() < deadline:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            time.sleep(_POLL)
        except OSError:
            return  # a network file system without locks
        else:
            return
