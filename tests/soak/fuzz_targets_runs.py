"""Targets that read runs: recordings, events from an engine, and commands to one."""

from contextlib import suppress
from io import BytesIO, StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec
from mcap.writer import CompressionType, Writer

from sim.diagnosis import diagnose, findings_text
from sim.engine.commands import (
    CallService,
    CompleteLine,
    RunLine,
    RunUntil,
    SetSpeed,
    Stop,
    input_of,
    input_text,
)
from sim.engine.commands import decode as decode_command
from sim.engine.commands import encode as encode_command
from sim.export.chrome import ChromeFile
from sim.export.csv import CallTable
from sim.export.jsonl import JsonLines
from sim.export.markdown import report
from sim.export.perfetto import PerfettoFile
from sim.export.svg import svg
from sim.export.trace_exporter import TraceExporter
from sim.recording import RecordingError, batch, read
from sim.trace import events as ev
from sim.trace.figures.summary import summarise
from sim.trace.figures.summary_text import plain_text
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.export.examples import small_run
from tests.recording.files import run_in_batches, write_in_chunks
from tests.soak.fuzz_target import Target
from tests.trace.samples import BARE, FULL


def recording() -> Target:
    """Files that are to be recordings."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        write_in_chunks(path, run_in_batches(30)[:3])
        samples = (path.read_bytes(), _unpacked_recording(), _unpacked_recording(CompressionType.LZ4))
    words = (b"lz4", b"zstd", b"cbtui", b"/cbtui/events", b"\x06", b"\x05", b"\x0c", b"\x09")
    return Target("recording", _read_recording, samples, words, (RecordingError,))


def _unpacked_recording(compression: CompressionType = CompressionType.NONE) -> bytes:
    """A recording in which a changed byte is no wrong checksum, and so gets further."""
    file = BytesIO()
    writer = Writer(file, compression=compression, enable_crcs=False)
    writer.start("ros2", "cbtui 0.1")
    writer.add_metadata("cbtui", {"title": "shared-group", "threads": "2", "recorded": "1700000000"})
    schema = writer.register_schema(batch.TYPE, "ros2msg", batch.DEFINITION.encode())
    channel = writer.register_channel(batch.TOPIC, "cdr", schema)
    for events in ([*FULL], small_run()[:40]):
        writer.add_message(channel, 1, batch.pack_batch(events), 1)
    writer.finish()  # type: ignore[no-untyped-call]
    return file.getvalue()


def _read_recording(data: bytes, folder: Path) -> None:
    path = folder / "run.mcap"
    path.write_bytes(data)
    opened = read(path)
    for _ in opened.batches():
        pass
    for _ in opened.messages():
        pass
    opened.topics()
    assert opened.damage is None or "\n" not in opened.damage


def events() -> Target:
    """Batches of events as they come from an engine."""
    # Events by themselves: where many stand in one input, hardly any of it can still be read.
    samples = (ev.encode(FULL), *(ev.encode([event]) for event in (*FULL, *BARE)))
    tags = tuple(msgspec.msgpack.encode(tag) for tag in ("log", "ready", "start", "end", "published", "scan"))
    return Target("events", lambda data, _: ev.decode(data), samples, tags, (msgspec.DecodeError,))


def run() -> Target:
    """Events that can be read but tell of no run that there could be, and all that is made of them."""
    samples = tuple(
        b"\n".join(msgspec.json.encode(event) for event in events)
        for events in (FULL, BARE, small_run()[:50], small_run()[50:])
    )
    words = tuple(f"{number}," for number in (-1, 0, 1, 2, 3, 999, 2**62, -(2**62), 1_500_000_000))
    texts = ("null", "true", '"\\u001b[31m"', '"\\ud800"', '"group held"', "0.5", "1e308", '""')
    return Target("run", _look_at_run, samples, tuple(map(str.encode, words + texts)), ())


_event_decoder: msgspec.json.Decoder[ev.AnyEvent] = msgspec.json.Decoder(ev.AnyEvent)


def _look_at_run(data: bytes, _: Path) -> None:
    told: list[ev.AnyEvent] = []
    for line in data.split(b"\n"):
        with suppress(msgspec.DecodeError, RecursionError, UnicodeDecodeError, OverflowError):
            told += ev.decode(ev.encode([_event_decoder.decode(line)]))
    timeline = Timeline()
    timeline.extend(told)
    plain_text(summarise(timeline))
    findings_text(diagnose(timeline), timeline)
    timeline.moment(timeline.end // 2)
    table, chrome, perfetto = (
        CallTable(StringIO()),
        TraceExporter(ChromeFile(BytesIO())),
        TraceExporter(PerfettoFile(BytesIO())),
    )
    for writer in (table, chrome, perfetto):
        writer.take(told)
        writer.finish()
    report(timeline, None)
    svg(timeline, Window(0, max(timeline.end, 1)), 700)
    for _line in JsonLines().lines(told):
        pass


def commands() -> Target:
    """What is told an engine, from the console, a terminal, or a recording that is repeated."""
    told = (RunLine(3, "ros2 topic list"), CallService("/a", True), SetSpeed(2.0), RunUntil(9), Stop())
    samples = (
        *(encode_command(each) for each in (*told, CompleteLine(1, "ros2 t", 6))),
        input_text(told[0]).encode(),
    )
    words = (b"line", b"speed", b"stop", b'"type":"call"', b"null", b"\xc0")
    return Target("commands", _take_command, samples, words, (msgspec.DecodeError,))


def _take_command(data: bytes, _: Path) -> None:
    with suppress(msgspec.DecodeError, UnicodeDecodeError):
        input_of(data.decode())
    decode_command(data)
