"""Reads trace viewers' files back into one simple form, as a viewer would understand them."""

import json
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any

import perfetto.protos.perfetto.trace.perfetto_trace_pb2 as pb

from sim.export.chrome import ChromeFile
from sim.export.perfetto import PerfettoFile
from sim.export.trace_exporter import TraceExporter
from sim.trace.events import AnyEvent


@dataclass
class Slice:
    name: str
    start: int
    end: int | None
    facts: dict[str, Any]
    depth: int


@dataclass
class Trace:
    """``tracks`` are names by id, ``parents`` ids by id; flows are the times at which each comes by."""

    tracks: dict[int, str] = field(default_factory=dict)
    parents: dict[int, int] = field(default_factory=dict)
    slices: defaultdict[int, list[Slice]] = field(default_factory=lambda: defaultdict(list))
    instants: defaultdict[int, list[tuple[int, str]]] = field(default_factory=lambda: defaultdict(list))
    counts: defaultdict[int, list[tuple[int, float]]] = field(default_factory=lambda: defaultdict(list))
    begun: defaultdict[int, list[tuple[int, int, str]]] = field(default_factory=lambda: defaultdict(list))
    ended: defaultdict[int, list[tuple[int, int, str]]] = field(default_factory=lambda: defaultdict(list))
    times: list[int] = field(default_factory=list)
    open: defaultdict[int, list[Slice]] = field(default_factory=lambda: defaultdict(list))

    def named(self, name: str) -> list[int]:
        return [track for track, each in self.tracks.items() if each == name]

    def begin(self, track: int, t: int, name: str, facts: dict[str, Any]) -> None:
        made = Slice(name, t, None, facts, len(self.open[track]))
        self.slices[track].append(made)
        self.open[track].append(made)

    def end(self, track: int, t: int, facts: dict[str, Any]) -> None:
        ended = self.open[track].pop()
        ended.end = t
        ended.facts |= facts


def written(events: Sequence[AnyEvent], sink: type[PerfettoFile] | type[ChromeFile]) -> bytes:
    file = BytesIO()
    exporter = TraceExporter(sink(file))
    for start in range(0, len(events), 7):
        exporter.take(events[start : start + 7])
    exporter.finish()
    return file.getvalue()


def perfetto(events: Sequence[AnyEvent]) -> Trace:
    read = pb.Trace()
    read.ParseFromString(written(events, PerfettoFile))
    trace = Trace()
    for packet in read.packet:
        assert packet.trusted_packet_sequence_id
        if packet.HasField("track_descriptor"):
            about = packet.track_descriptor
            assert about.uuid not in trace.tracks
            name = about.name or about.thread.thread_name or about.process.process_name
            trace.tracks[about.uuid] = name
            trace.parents[about.uuid] = about.parent_uuid
        elif packet.HasField("track_event"):
            _perfetto_event(trace, packet.timestamp, packet.track_event)
    return trace


def _perfetto_event(trace: Trace, t: int, event: pb.TrackEvent) -> None:
    track = event.track_uuid
    assert track in trace.tracks
    trace.times.append(t)
    facts = {each.name: getattr(each, str(each.WhichOneof("value"))) for each in event.debug_annotations}
    if event.type == pb.TrackEvent.TYPE_SLICE_BEGIN:
        trace.begin(track, t, event.name, facts)
    elif event.type == pb.TrackEvent.TYPE_SLICE_END:
        trace.end(track, t, facts)
    elif event.type == pb.TrackEvent.TYPE_INSTANT:
        trace.instants[track].append((t, event.name))
    else:
        assert event.type == pb.TrackEvent.TYPE_COUNTER
        trace.counts[track].append((t, event.double_counter_value))
    for flow in event.flow_ids:
        trace.begun[flow].append((t, track, event.name))
    for flow in event.terminating_flow_ids:
        trace.ended[flow].append((t, track, event.name))


def chrome(events: Sequence[AnyEvent]) -> Trace:
    trace = Trace()
    lines = json.loads(written(events, ChromeFile))["traceEvents"]
    name = ""
    for line in lines:
        if line["ph"] == "M":
            if line["name"].endswith("_name"):
                trace.tracks[line["tid"] or line["pid"]] = line["args"]["name"]
                trace.parents[line["tid"]] = line["pid"]
            continue
        t, track = round(line["ts"] * 1000), line["tid"]
        trace.times.append(t)
        assert line["ph"] == "C" or trace.parents[track] == line["pid"]
        name = line.get("name", name)
        match line["ph"]:
            case "B":
                trace.begin(track, t, name, line["args"])
            case "E":
                trace.end(track, t, line.get("args", {}))
            case "i" | "X":
                trace.instants[track].append((t, name))
            case "C":
                trace.counts[track].append((t, line["args"]["value"]))
            case "s" | "t":
                trace.begun[line["id"]].append((t, track, line["ph"]))
            case "f":
                trace.ended[line["id"]].append((t, track, line["ph"]))
            case other:
                raise AssertionError(other)
    return trace
