"""Recordings of runs: where one is written, and its metadata."""

import time
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import msgspec

from sim.engine.setup import RunSetup
from sim.quantities.nanoseconds import SECOND
from sim.recording import RecordingMetadata, RecordingWriter


class CannotRecordError(Exception):
    """A recording cannot be started; the text says why and what to do."""


class NameTakenError(CannotRecordError):
    """The recording would replace a file."""


def start_recording(path: Path, setup: RunSetup, *, replace: bool = False) -> RecordingWriter:
    """Begin to record a run of ``setup``; an existing file is only overwritten with ``replace``.

    Raises:
        NameTakenError: there is such a file.
        CannotRecordError: it cannot be made.
    """
    try:
        if path.is_dir():
            raise CannotRecordError(f"cannot record to {path}: it is a folder; name a file in it")
        is_new = not path.exists()
        recorder = RecordingWriter(path, about(setup), replace=replace, texts=setup.texts)
    except FileExistsError:
        sentence = f"there is a file {path} already; give another name, or --force to replace it"
        raise NameTakenError(sentence) from None
    except OSError as error:
        raise CannotRecordError(f"cannot record to {path}: {error.strerror}") from None
    if recorder.failure is not None:
        recorder.close()
        if is_new:
            path.unlink(missing_ok=True)
        raise CannotRecordError(f"cannot record to {path}: {recorder.failure}")
    return recorder


def about(setup: RunSetup) -> RecordingMetadata:
    """The metadata of a run's recording."""
    return RecordingMetadata(
        title=setup.title,
        clock=setup.clock,
        threads=setup.threads,
        programs=tuple(program.path for program in setup.programs),
        arguments=next((program.arguments for program in setup.programs), ()),
        setup=msgspec.json.encode(setup).decode(),
        version=version("cbtui"),
        recorded=time.time_ns(),
    )


def setup_of(recorded: RecordingMetadata) -> RunSetup | None:
    """The set-up in a recording; None if it holds none that this version knows."""
    try:
        return msgspec.json.decode(recorded.setup.encode(), type=RunSetup)
    except (msgspec.DecodeError, RecursionError, UnicodeEncodeError):
        return None


def date_text(nanoseconds: int) -> str:
    """Return nanoseconds since 1970 as date and time, in the form of recordings."""
    try:
        return f"{datetime.fromtimestamp(nanoseconds // SECOND, UTC):%Y-%m-%d %H:%M:%S} UTC"
    except (ValueError, OverflowError, OSError):
        return "at an impossible time"
