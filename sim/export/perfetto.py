"""Writes a run as a Perfetto trace, for ui.perfetto.dev.

Source: the protocol buffers of Perfetto (``trace_packet.proto``, ``track_event.proto``), "Synthetic tracks".
"""

import math
from typing import IO

import perfetto.protos.perfetto.trace.perfetto_trace_pb2 as pb

from sim.export.trace_sink import NO_ARGS, NO_LINKS, Args, Arrows, Track, TrackId, TrackKind
from sim.trace.model import Nanoseconds

_SEQUENCE = 1
_PACKETS_AT_ONCE = 2048
_BEGIN = pb.TrackEvent.TYPE_SLICE_BEGIN
_END = pb.TrackEvent.TYPE_SLICE_END
_INSTANT = pb.TrackEvent.TYPE_INSTANT
_COUNTER = pb.TrackEvent.TYPE_COUNTER
_FIRST_THREAD_NUMBER = 1_000_000
"""Viewers take a thread with its process's number for the main one, so threads have numbers of their own."""


class PerfettoFile:
    """A trace sink that writes packets to a binary file, some thousand at a time. Times are nanoseconds."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self._trace = pb.Trace()
        self._waiting = 0
        self._processes: dict[TrackId, int] = {}

    def begin_run(self, epoch: Nanoseconds) -> None:
        """Write the wall time of the run's start."""
        snapshot = self._packet(0).clock_snapshot
        snapshot.clocks.add(clock_id=pb.BUILTIN_CLOCK_BOOTTIME, timestamp=0)
        snapshot.clocks.add(clock_id=pb.BUILTIN_CLOCK_REALTIME, timestamp=max(0, epoch))

    def add(self, track: Track) -> None:
        about = self._packet(0).track_descriptor
        about.uuid = track.id
        if track.parent:
            about.parent_uuid = track.parent
            about.sibling_order_rank = track.id
        if track.kind is TrackKind.PROCESS:
            self._processes[track.id] = len(self._processes) + 1
            about.process.pid = self._processes[track.id]
            about.process.process_name = track.name
            return
        if track.kind is TrackKind.THREAD:
            about.thread.pid = self._processes[track.parent]
            about.thread.tid = _FIRST_THREAD_NUMBER + track.id
            about.thread.thread_name = track.name
            return
        about.name = track.name
        if track.kind is TrackKind.COUNTER:
            about.counter.unit_name = track.unit
        else:
            about.child_ordering = pb.TrackDescriptor.EXPLICIT

    def begin(
        self, track: TrackId, t: Nanoseconds, name: str, category: str, args: Args, links: Arrows = NO_LINKS
    ) -> None:
        _fill(self._event(track, t, _BEGIN, name, category), args, links)

    def end(self, track: TrackId, t: Nanoseconds, args: Args = NO_ARGS) -> None:
        _fill(self._event(track, t, _END), args, NO_LINKS)

    def instant(
        self, track: TrackId, t: Nanoseconds, name: str, category: str, args: Args, links: Arrows = NO_LINKS
    ) -> None:
        _fill(self._event(track, t, _INSTANT, name, category), args, links)

    def count(self, track: TrackId, t: Nanoseconds, value: float) -> None:
        if math.isfinite(value):
            self._event(track, t, _COUNTER).double_counter_value = value

    def close(self) -> None:
        self._file.write(self._trace.SerializeToString())
        # A cleared message keeps its memory; a new one does not.
        self._trace = pb.Trace()

    def _event(
        self, track: TrackId, t: Nanoseconds, kind: pb.TrackEvent.Type, name: str = "", category: str = ""
    ) -> pb.TrackEvent:
        event = self._packet(t).track_event
        event.type = kind
        event.track_uuid = track
        if name:
            event.name = name
            event.categories.append(category)
        return event

    def _packet(self, t: Nanoseconds) -> pb.TracePacket:
        self._waiting += 1
        if self._waiting > _PACKETS_AT_ONCE:
            self.close()
            self._waiting = 1
        packet: pb.TracePacket = self._trace.packet.add(timestamp=t, trusted_packet_sequence_id=_SEQUENCE)
        return packet


def _fill(event: pb.TrackEvent, args: Args, links: Arrows) -> None:
    if args:
        add = event.debug_annotations.add
        for name, value in args.items():
            if isinstance(value, str):
                add(name=name, string_value=value)
            elif isinstance(value, float):
                add(name=name, double_value=value)
            else:
                add(name=name, int_value=value)
    if links is not NO_LINKS:
        event.flow_ids.extend(links.begin + links.through)
        event.terminating_flow_ids.extend(links.end)
