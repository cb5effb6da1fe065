"""Gives a target many inputs and sees what comes of each: taken, refused in a sentence, or a crash.

A crash is any other exception, more than a second of computing, or memory growing by hundreds of megabytes.
"""

import resource
import signal
import sys
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from types import FrameType

from tests.soak.fuzz_mutation import mutated
from tests.soak.fuzz_target import Target

FOUND = Path(__file__).with_name("found")
"""Where inputs that crash are kept, for ``--again``."""
_LONGEST = 1.0
"""Seconds of computing that one input may take, whatever else the machine does."""
_MOST_MEMORY = 500_000_000
_IN_MEMORY = Path("/dev/shm")


class _TookTooLongError(BaseException):
    """Raised by the timer, so that nothing that catches exceptions takes it for its own."""


@dataclass(frozen=True)
class Crash:
    """An input that crashed a target; ``what`` is one line on it, ``where`` the place that raised."""

    number: int
    data: bytes
    what: str
    where: str


@dataclass
class Outcome:
    """What came of the inputs of one target. Crashes at one place count, and are kept once."""

    target: str
    inputs: int = 0
    accepted: int = 0
    refused: int = 0
    seconds: float = 0.0
    crashed: int = 0
    crashes: list[Crash] = field(default_factory=list)


def fuzz(target: Target, inputs: int, seed: int) -> Outcome:
    """Give the target so many inputs; the same seed, the same inputs."""
    outcome = Outcome(target.name)
    places: set[str] = set()
    began = time.monotonic()
    with TemporaryDirectory(dir=_IN_MEMORY if _IN_MEMORY.is_dir() else None) as folder, _timer():
        for number in range(inputs):
            data = input_of(target, seed, number)
            told = attempt(target, data, Path(folder))
            outcome.inputs += 1
            if told is None:
                outcome.accepted += 1
            elif isinstance(told, str):
                outcome.refused += 1
            else:
                outcome.crashed += 1
                what, where = told
                if where not in places:
                    places.add(where)
                    outcome.crashes.append(Crash(number, data, what, where))
    outcome.seconds = time.monotonic() - began
    return outcome


def input_of(target: Target, seed: int, number: int) -> bytes:
    """The input of that number, which every run with the seed has; the first ones are the samples."""
    if number < len(target.samples):
        return target.samples[number]
    return mutated(target.samples, target.words, Random(f"{seed}/{target.name}/{number}"))


def again(target: Target, data: bytes) -> "str | tuple[str, str] | None":
    """Give the target one input."""
    with TemporaryDirectory(dir=_IN_MEMORY if _IN_MEMORY.is_dir() else None) as folder, _timer():
        return attempt(target, data, Path(folder))


def attempt(target: Target, data: bytes, folder: Path) -> "str | tuple[str, str] | None":
    """None: it was taken; a text: why it was refused; what and where: it crashed."""
    before = _peak()
    signal.setitimer(signal.ITIMER_PROF, _LONGEST)
    try:
        target.take(data, folder)
    except target.refusals as error:
        told = str(error)
        if not told.strip():
            return f"{type(error).__name__} without a sentence", _place_of(error)
        return told
    except _TookTooLongError as error:
        return f"over {_LONGEST:g} s of computing", f"time, {_place_of(error)}"
    except Exception as error:  # noqa: BLE001 - whatever it is, it is what is looked for
        return f"{type(error).__name__}: {str(error)[:200]!r}", _place_of(error)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    grown = _peak() - before
    return None if grown < _MOST_MEMORY else (f"{grown / 1e6:.0f} MB of memory", "memory")


def keep(outcome: Outcome, folder: Path = FOUND) -> Iterator[tuple[Crash, Path]]:
    """Write the inputs that crashed into a folder that is not part of the project; yields where each is."""
    for crash in outcome.crashes:
        folder.mkdir(exist_ok=True)
        path = folder / f"{outcome.target}-{crash.number}"
        path.write_bytes(crash.data)
        yield crash, path


def _place_of(error: BaseException) -> str:
    """The innermost place in this project, and what raised: failures of one place are one failure."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [
        frame for frame in frames if "site-packages" not in frame.filename and "/tests/" not in frame.filename
    ]
    frame = (own or list(frames))[-1]
    return f"{Path(frame.filename).name}:{frame.lineno} {type(error).__name__}"


def _peak() -> int:
    """The most memory that this process has had, in bytes."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)


@contextmanager
def _timer() -> Iterator[None]:
    def ring(_number: int, _frame: FrameType | None) -> None:
        raise _TookTooLongError

    before = signal.signal(signal.SIGPROF, ring)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)
