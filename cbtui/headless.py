"""Runs a program without the console: log to stderr, summary and diagnosis to stdout, events to files."""

import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from operator import itemgetter
from pathlib import Path
from queue import Queue
from typing import BinaryIO, TypeAlias

import msgspec

from cbtui.listening import ListeningSession
from cbtui.program_log import ProgramLog
from cbtui.record import CannotRecordError, start_recording
from sim.diagnosis import diagnose, findings_text
from sim.engine.commands import Stop
from sim.engine.setup import RunSetup, TimedCall, TimedLine
from sim.trace.events import AnyEvent
from sim.trace.jsonl import JsonLines
from sim.trace.recording import Recorder
from sim.trace.summary import summarise
from sim.trace.summary_text import plain_text
from sim.trace.timeline import Timeline

_SECOND = 1_000_000_000
_BATCHES = 64
"""Batches that may wait for this process; a full queue holds the engine up, and nothing is lost."""

News: TypeAlias = "list[AnyEvent] | str | None"


def run_headless(
    program: RunSetup,
    *,
    seconds: float,
    calls: Sequence[float],
    call_data: bool,
    lines: Sequence[tuple[float, str]],
    events_path: str | None,
    recording_path: str | None = None,
    replace_recording: bool = False,
) -> int:
    """Run a program to its end; returns the exit code: 0 well, 1 it failed, 2 a file cannot be written.

    ``seconds`` is how long the run lasts in its own time, ``calls`` when its SetBool service is called,
    ``lines`` which ``ros2`` lines are carried out when. A recording replaces another one only with
    ``replace_recording``.
    """
    setup = msgspec.structs.replace(
        program,
        until=round(seconds * _SECOND),
        calls=tuple(TimedCall(round(at * _SECOND), call_data) for at in sorted(calls)),
        lines=tuple(TimedLine(round(at * _SECOND), text) for at, text in sorted(lines, key=itemgetter(0))),
        contents=recording_path is not None,
    )
    return run_set_up(
        setup, events_path=events_path, recording_path=recording_path, replace_recording=replace_recording
    )


def run_set_up(
    setup: RunSetup, *, events_path: str | None, recording_path: str | None, replace_recording: bool
) -> int:
    """Run what is set up whole, as ``run_headless`` does."""
    with ExitStack() as files:
        try:
            file = None if events_path is None else files.enter_context(Path(events_path).open("wb"))
        except OSError as error:
            sys.stderr.write(f"cbtui: cannot write events to {events_path}: {error.strerror}\n")
            return 2
        recorder: Recorder | None = None
        if recording_path is not None:
            try:
                recorder = start_recording(Path(recording_path), setup, replace=replace_recording)
            except CannotRecordError as error:
                sys.stderr.write(f"cbtui: {error}\n")
                return 2
            files.callback(recorder.close)
        try:
            return _Headless(setup, file, recorder).run()
        except OSError as error:
            sys.stderr.write(f"cbtui: the run was cut short: {error.strerror}\n")
            return 1


class _Headless:
    """One run: takes the news of its session on this thread, one batch after another."""

    def __init__(self, setup: RunSetup, events_file: BinaryIO | None, recorder: Recorder | None) -> None:
        self._news: Queue[News] = Queue(_BATCHES)
        self._session = ListeningSession(setup, self._news.put, self._news.put)
        self._timeline = Timeline()
        self._file = events_file
        self._recorder = recorder
        self._lines = JsonLines()
        self._log = ProgramLog()

    def run(self) -> int:
        """Run to the end, whatever ends it, and print the summary and what the rules found."""
        self._session.start()
        interrupted = False
        try:
            loss = self._follow()
        except KeyboardInterrupt:
            interrupted = True
            self._session.send(Stop())
            loss = self._follow()
        finally:
            self._session.stop()
        sys.stdout.write(plain_text(summarise(self._timeline)))
        found = findings_text(diagnose(self._timeline), self._timeline)
        sys.stdout.write(f"\n{found}" if found else "")
        sys.stdout.flush()
        return 130 if interrupted else self._verdict(loss)

    def _follow(self) -> str | None:
        """Take news until the last; what was lost, if the engine was."""
        for events in iter(self._batches()):
            if self._recorder is not None:
                self._recorder.take(events)
            self._timeline.extend(events)
            self._log.print(events)
            if self._file is not None:
                self._file.writelines(self._lines.lines(events))
        return self._loss

    def _batches(self) -> Iterator[list[AnyEvent]]:
        while isinstance(news := self._news.get(), list):
            yield news
        self._loss = news

    def _verdict(self, loss: str | None) -> int:
        if loss is not None:
            sys.stderr.write(f"cbtui: {loss} at {self._timeline.end / _SECOND:.3f} s; run it again\n")
            return 1
        ended = self._timeline.ended
        if ended is not None and ended.failed:
            sys.stderr.write(f"cbtui: {ended.reason}\n")
            return 1
        return self._recording_verdict()

    def _recording_verdict(self) -> int:
        if self._recorder is None:
            return 0
        if self._timeline.contents_lost:
            sys.stderr.write(
                f"cbtui: {self._timeline.contents_lost} messages came faster than they could be recorded; "
                "the recording tells that they were sent, not what they held\n"
            )
        self._recorder.close()
        if self._recorder.failure is not None:
            sys.stderr.write(f"cbtui: the recording is not whole: {self._recorder.failure}\n")
            return 1
        return 0
