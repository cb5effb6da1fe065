"""Writes a run in the trace event format of Chrome, for chrome://tracing, Speedscope and the like.

Source: "Trace Event Format" of the Chromium project. Times there are microseconds.
"""

import math
from typing import IO

import msgspec

from sim.export.trace_sink import NO_ARGS, NO_LINKS, Args, Arrows, FlowId, Track, TrackId, TrackKind
from sim.trace.model import Nanoseconds

_LINES_AT_ONCE = 4096


class ChromeFile:
    """A trace sink that writes JSON to a binary file, an event a line.

    The format has processes and threads only: a track at the top level is a process, a track below it a
    thread of that process.
    """

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self._encode = msgspec.json.Encoder().encode
        self._lines: list[bytes] = []
        self._roots: dict[TrackId, TrackId] = {}
        self._names: dict[TrackId, str] = {}
        self._epoch: Nanoseconds = 0
        file.write(b'{"traceEvents":[\n')
        self._first = True

    def begin_run(self, epoch: Nanoseconds) -> None:
        """Keep the wall time, which is written at the end."""
        self._epoch = epoch

    def add(self, track: Track) -> None:
        """Name a process or a thread."""
        root = self._roots[track.id] = self._roots[track.parent] if track.parent else track.id
        self._names[track.id] = track.name
        if root == track.id:
            self._name("process_name", "process_sort_index", root, 0, track)
        if track.kind in (TrackKind.THREAD, TrackKind.LANE):
            self._name("thread_name", "thread_sort_index", root, track.id, track)

    def begin(
        self, track: TrackId, t: Nanoseconds, name: str, category: str, args: Args, links: Arrows = NO_LINKS
    ) -> None:
        self._put(track, t, {"ph": "B", "name": name, "cat": category, "args": args})
        self._link(track, t, links)

    def end(self, track: TrackId, t: Nanoseconds, args: Args = NO_ARGS) -> None:
        self._put(track, t, {"ph": "E", "args": args} if args else {"ph": "E"})

    def instant(
        self, track: TrackId, t: Nanoseconds, name: str, category: str, args: Args, links: Arrows = NO_LINKS
    ) -> None:
        """Add an instant; one with flows as a slice of no length, since flows bind to slices."""
        about: dict[str, object] = {"name": name, "cat": category, "args": args}
        if any(links):
            self._put(track, t, {"ph": "X", "dur": 0, **about})
            self._link(track, t, links)
        else:
            self._put(track, t, {"ph": "i", "s": "t", **about})

    def count(self, track: TrackId, t: Nanoseconds, value: float) -> None:
        if math.isfinite(value):
            self._put(track, t, {"ph": "C", "name": self._names[track], "args": {"value": value}})

    def close(self) -> None:
        self._write()
        other = {"epoch_ns": str(self._epoch)}
        self._file.write(b'\n],"displayTimeUnit":"ms","otherData":' + self._encode(other) + b"}\n")

    def _name(self, name: str, sort: str, process: int, thread: int, track: Track) -> None:
        about = {"ph": "M", "pid": process, "tid": thread}
        self._add({**about, "name": name, "args": {"name": track.name}})
        self._add({**about, "name": sort, "args": {"sort_index": track.id}})

    def _link(self, track: TrackId, t: Nanoseconds, links: Arrows) -> None:
        for phase, flows in zip("stf", links, strict=True):
            for flow in flows:
                self._flow(track, t, phase, flow)

    def _flow(self, track: TrackId, t: Nanoseconds, phase: str, flow: FlowId) -> None:
        about: dict[str, object] = {"ph": phase, "id": flow, "name": "flow", "cat": "flow"}
        if phase != "s":
            about["bp"] = "e"
        self._put(track, t, about)

    def _put(self, track: TrackId, t: Nanoseconds, about: dict[str, object]) -> None:
        about["pid"] = self._roots[track]
        about["tid"] = track
        about["ts"] = t / 1000
        self._add(about)

    def _add(self, about: dict[str, object]) -> None:
        self._lines.append(self._encode(about))
        if len(self._lines) == _LINES_AT_ONCE:
            self._write()

    def _write(self) -> None:
        if not self._lines:
            return
        text = b",\n".join(self._lines)
        self._file.write(text if self._first else b",\n" + text)
        self._lines.clear()
        self._first = False
