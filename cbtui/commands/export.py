"""The ``export`` command: takes a recording to trace viewers, spreadsheets and paper."""

import argparse
import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from io import TextIOWrapper
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, Self

from cbtui.commands.values import moment

if TYPE_CHECKING:
    from sim.trace.events import AnyEvent
    from sim.trace.model import Window
    from sim.trace.timeline import Timeline

FORMATS = {
    "perfetto": ("OUT.pftrace", "a trace for ui.perfetto.dev"),
    "chrome": ("OUT.json", "a trace for chrome://tracing and Speedscope"),
    "svg": ("OUT.svg", "a picture of the lanes, for paper; see --from, --to and --width"),
    "csv": ("OUT.csv", "a table of the calls"),
    "markdown": ("OUT.md", "a report: set-up, statistics, waits, notices; with the --svg picture, if any"),
}
_SECOND = 1_000_000_000
_WIDTH = 1100


class Source(Protocol):
    """Where events come from: an open recording."""

    def batches(self) -> "Iterator[list[AnyEvent]]":
        """The events, batch after batch."""


class ExportError(Exception):
    """What stands in the way of an export, in one sentence for the person."""


@dataclass(frozen=True)
class Wish:
    """What is to be written: paths by format, and the part (seconds) and width (pixels) of the picture."""

    outputs: dict[str, Path]
    start: float = 0.0
    end: float | None = None
    width: int = _WIDTH


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give the command its arguments."""
    parser.add_argument("file", metavar="FILE.mcap", help="a recording")
    for name, (metavar, about) in FORMATS.items():
        parser.add_argument(f"--{name}", metavar=metavar, help=about)
    parser.add_argument("--from", dest="start", metavar="S", type=moment, help="where the picture begins (0)")
    parser.add_argument("--to", dest="end", metavar="S", type=moment, help="where it ends (the run's end)")
    parser.add_argument("--width", metavar="PIXELS", type=int, help=f"how wide it is ({_WIDTH})")


def export_command(options: argparse.Namespace) -> int:
    """Carry the command out; returns the exit code: 0 well, 2 it was wrong or a file is in the way."""
    from sim.trace.recording import RecordingError, read

    source = Path(options.file)
    try:
        wish = _wish(options, source)
        recording = read(source)
        export(recording, wish)
    except (ExportError, RecordingError) as error:
        sys.stderr.write(f"cbtui: {error}\n")
        return 2
    if recording.damage:
        sys.stderr.write(f"cbtui: {source}: {recording.damage}\n")
    return 0


def export(source: Source, wish: Wish) -> None:
    """Write what is wished for, in one pass over the events.

    Raises:
        ExportError: an output cannot be written, the source cannot be read, or the picture cannot be drawn.
    """
    from sim.trace.timeline import Timeline

    batches = _read(source)
    first = next(batches, None)
    if first is None:
        raise ExportError("there are no events in the recording to export")
    timeline = Timeline() if {"svg", "markdown"} & wish.outputs.keys() else None
    with ExitStack() as open_files:
        outputs = [open_files.enter_context(_Output(name, path)) for name, path in wish.outputs.items()]
        for batch in chain([first], batches):
            if timeline is not None:
                timeline.extend(batch)
            for output in outputs:
                output.take(batch)
        for output in outputs:
            output.finish(timeline, wish)


class _Output:
    """One file that is written."""

    def __init__(self, name: str, path: Path) -> None:
        from sim.trace.export import CallTable, ChromeFile, Narrator, PerfettoFile

        self._name = name
        self._path = path
        self._writer: Narrator | CallTable | None = None
        with self._trouble():
            self._file = path.open("wb")
        self._text = TextIOWrapper(self._file, "utf-8", newline="")
        with self._trouble():
            if name == "perfetto":
                self._writer = Narrator(PerfettoFile(self._file))
            elif name == "chrome":
                self._writer = Narrator(ChromeFile(self._file))
            elif name == "csv":
                self._writer = CallTable(self._text)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        # What cannot be flushed has been told of before.
        with suppress(OSError):
            self._text.close()

    def take(self, batch: "list[AnyEvent]") -> None:
        """Write a batch, if the format is one that is written as events go by."""
        if self._writer is not None:
            with self._trouble():
                self._writer.take(batch)

    def finish(self, timeline: "Timeline | None", wish: Wish) -> None:
        """Write the rest, or the page that is made of the whole run, and close the file."""
        page = _page(self._name, timeline, wish) if timeline is not None else ""
        with self._trouble():
            if self._writer is not None:
                self._writer.finish()
            else:
                self._text.write(page)
            self._text.close()

    @contextmanager
    def _trouble(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise ExportError(f"cannot write {self._path}: {error.strerror}") from None


def _page(name: str, timeline: "Timeline", wish: Wish) -> str:
    """The text of a picture or a report; nothing for other formats."""
    from sim.trace.export import report, svg

    if name == "markdown":
        return report(timeline, _picture_beside(wish))
    if name == "svg":
        return svg(timeline, _window(timeline, wish), wish.width)
    return ""


def _window(timeline: "Timeline", wish: Wish) -> "Window":
    from sim.trace.model import Window

    start = round(wish.start * _SECOND)
    end = timeline.end if wish.end is None else round(wish.end * _SECOND)
    if wish.start and start >= timeline.end:
        raise ExportError(f"the run is over at {timeline.end / _SECOND:g} s, before --from {wish.start:g}")
    return Window(start, max(end, start + 1))


def _picture_beside(wish: Wish) -> str | None:
    """Where the picture is, seen from the report."""
    picture = wish.outputs.get("svg")
    if picture is None:
        return None
    return Path(os.path.relpath(picture.resolve(), wish.outputs["markdown"].resolve().parent)).as_posix()


def _read(source: Source) -> "Iterator[list[AnyEvent]]":
    try:
        yield from source.batches()
    except OSError as error:
        raise ExportError(f"the recording cannot be read: {error.strerror}") from None


def _wish(options: argparse.Namespace, source: Path) -> Wish:
    """What the options ask for.

    Raises:
        ExportError: they ask for nothing, or contradict each other.
    """
    from sim.trace.export.svg import NARROWEST, WIDEST

    given = {name: getattr(options, name) for name in FORMATS}
    outputs = {name: Path(path) for name, path in given.items() if path is not None}
    if not outputs:
        raise ExportError(f"name what to write, such as --svg lanes.svg; there are --{', --'.join(FORMATS)}")
    _check_paths(outputs, source)
    placed = [options.start, options.end, options.width]
    if "svg" not in outputs and any(value is not None for value in placed):
        raise ExportError("--from, --to and --width are for the picture; add --svg OUT.svg")
    start = 0.0 if options.start is None else options.start
    if options.end is not None and options.end <= start:
        raise ExportError(f"a picture from {start:g} to {options.end:g} s is empty; give --to a later time")
    width = _WIDTH if options.width is None else options.width
    if not NARROWEST <= width <= WIDEST:
        raise ExportError(f"a picture cannot be {width} pixels wide; give {NARROWEST} to {WIDEST}")
    return Wish(outputs, start, options.end, width)


def _check_paths(outputs: dict[str, Path], source: Path) -> None:
    seen = {source.resolve(): str(source)}
    for name, path in outputs.items():
        if path.resolve() in seen:
            raise ExportError(f"--{name} would overwrite {seen[path.resolve()]}; give it a file of its own")
        seen[path.resolve()] = str(path)
