"""Two runs that are compared, each a recording, a lesson or a file: read or run, and put side by side."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from queue import Queue

import msgspec

from cbtui.session import Session
from sim.engine.setup import RunSetup, TimedCall
from sim.trace.comparison import compare
from sim.trace.comparison_text import comparison_text
from sim.trace.events import AnyEvent
from sim.trace.model import Nanoseconds, Window
from sim.trace.recording import RecordingError, read
from sim.trace.timeline import Timeline

_SECOND = 1_000_000_000
_BATCHES = 64
_LENGTH = 60 * _SECOND
"""How long runs are that nothing gives a length: nanoseconds."""


class CannotCompareError(Exception):
    """Something that cannot be compared; the text is a sentence."""


@dataclass(frozen=True)
class Contender:
    """One of two runs: a recording's path, or what is to be run."""

    name: str
    what: Path | RunSetup


def compare_runs(
    first: Contender,
    second: Contender,
    *,
    start: float,
    end: float | None,
    calls: Sequence[float],
) -> int:
    """Print the comparison; returns the exit code: 0 well, 1 a run failed, 2 there is nothing to compare.

    ``start`` and ``end`` (seconds) bound the window, which ends where the
    shorter recording does at the latest. What is
    run is called at the times ``calls`` and lasts until the window's end.
    """
    try:
        known = {each.name: _recorded(each.what) for each in (first, second) if isinstance(each.what, Path)}
        lengths = [timeline.end for timeline in known.values()]
        until = min(lengths, default=_LENGTH)
        if end is not None:
            until = min([round(end * _SECOND), *lengths])
        window = Window(round(start * _SECOND), until)
        _check(window)
        timelines = [
            known[each.name] if isinstance(each.what, Path) else _run(each.name, each.what, until, calls)
            for each in (first, second)
        ]
    except CannotCompareError as error:
        sys.stderr.write(f"cbtui: {error}\n")
        return 2
    of_first, of_second = timelines
    sys.stdout.write(comparison_text(compare(of_first, of_second, window), first.name, second.name))
    return _verdict(zip((first.name, second.name), timelines, strict=True))


def _check(window: Window) -> None:
    if window.length <= 0:
        start, end = window.start / _SECOND, window.end / _SECOND
        raise CannotCompareError(f"nothing is left to compare from {start:g} s to {end:g} s")


def _verdict(runs: "zip[tuple[str, Timeline]]") -> int:
    failed = [
        (name, timeline.ended.reason) for name, timeline in runs if timeline.ended and timeline.ended.failed
    ]
    for name, reason in failed:
        sys.stderr.write(f"cbtui: {name}: {reason}\n")
    return 1 if failed else 0


def _recorded(path: Path) -> Timeline:
    timeline = Timeline()
    try:
        recording = read(path)
        for events in recording.batches():
            timeline.extend(events)
    except RecordingError as error:
        raise CannotCompareError(str(error)) from None
    except OSError as error:
        raise CannotCompareError(f"{path} cannot be read to its end: {error.strerror}") from None
    if recording.damage is not None:
        sys.stderr.write(f"cbtui: {recording.damage}\n")
    return timeline


def _run(name: str, program: RunSetup, until: Nanoseconds, calls: Sequence[float]) -> Timeline:
    """Run a program on virtual time, as fast as it goes."""
    setup = msgspec.structs.replace(
        program,
        clock="virtual",
        speed=None,
        until=until,
        calls=tuple(TimedCall(round(at * _SECOND), data=True) for at in sorted(calls)),
    )
    news: Queue[list[AnyEvent] | str | None] = Queue(_BATCHES)
    session = Session(setup, news.put, news.put)
    timeline = Timeline()
    session.start()
    try:
        while isinstance(batch := news.get(), list):
            timeline.extend(batch)
    finally:
        session.stop()
    if batch is not None:
        raise CannotCompareError(f"{name} could not be run to its end: {batch}")
    return timeline
