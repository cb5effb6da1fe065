"""Exports the events of a run to trace viewers, spreadsheets and paper, in several formats."""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from io import TextIOWrapper
from itertools import chain
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, NamedTuple, Self, TypeAlias

from sim.quantities.nanoseconds import SECOND, nearest_ns

if TYPE_CHECKING:
    from sim.export.csv import CallTable
    from sim.export.trace_exporter import TraceExporter
    from sim.trace.events import AnyEvent
    from sim.trace.figures.chains import ChainStep
    from sim.trace.model import Nanoseconds, Window
    from sim.trace.timeline import Timeline

FORMATS = {
    "perfetto": ("OUT.pftrace", "a trace for ui.perfetto.dev"),
    "chrome": ("OUT.json", "a trace for chrome://tracing and Speedscope"),
    "svg": ("OUT.svg", "a picture of the lanes, for paper; see --from, --to and --width"),
    "csv": ("OUT.csv", "a table of the calls"),
    "markdown": ("OUT.md", "a report: set-up, statistics, waits, notices; with the --svg picture, if any"),
    "html": ("OUT.html", "a page that plays the run in any browser, without a server or a network"),
}
WIDTH = 1100


EventSource: TypeAlias = "Callable[[], Iterator[list[AnyEvent]]]"
"""Yields the events of an open recording, or of a live run's event store, in batches."""


class ExportError(Exception):
    """An export failed; the text is one sentence for the person."""


class ExportRequest(NamedTuple):
    """The wanted files: paths by format, and the part (seconds) and width (pixels) of the picture.

    Existing files are only replaced with ``replace``, each when the new one is complete.
    """

    outputs: dict[str, Path]
    start: float = 0.0
    end: float | None = None
    width: int = WIDTH
    replace: bool = True
    chains: Sequence[Sequence[str]] = ()
    """What a report follows, from the first topic to the last; a picture frames their critical paths."""


def export(
    source: EventSource, wish: ExportRequest, reached: "Callable[[Nanoseconds], object]" = lambda _: None
) -> None:
    """Write the wanted files in one pass over the events.

    ``reached`` gets the time of the last written event after each batch; what it raises ends the export.

    Raises:
        ExportError: an output cannot be written, the source cannot be read, or the picture cannot be drawn.
    """
    from sim.trace.timeline import Timeline

    batches = _read(source)
    first = next(batches, None)
    if first is None:
        raise ExportError("there are no events to export")
    timeline = Timeline(until_ending=True) if {"svg", "markdown", "html"} & wish.outputs.keys() else None
    with ExitStack() as open_files:
        outputs = [
            open_files.enter_context(_ExportFile(name, path, wish.replace))
            for name, path in wish.outputs.items()
        ]
        for output in outputs:
            output.begin()
        for batch in chain([first], batches):
            if timeline is not None:
                timeline.extend(batch)
            for output in outputs:
                output.take(batch)
            if batch:
                reached(batch[-1].t)
        for output in outputs:
            output.finish(timeline, wish)


class _ExportFile:
    """One file that is written."""

    def __init__(self, name: str, path: Path, replace: bool) -> None:
        from sim.files.atomic import atomic_file

        self._name = name
        self._path = path
        self._writer: TraceExporter | CallTable | None = None
        self._atomic = atomic_file(path, replace=replace)
        with self._trouble():
            self._file = self._atomic.__enter__()
        self._text = TextIOWrapper(self._file, "utf-8", newline="", write_through=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._trouble():
            self._atomic.__exit__(kind, error, trace)

    def begin(self) -> None:
        """Write the head of a format that is written event by event."""
        from sim.export.chrome import ChromeFile
        from sim.export.csv import CallTable
        from sim.export.perfetto import PerfettoFile
        from sim.export.trace_exporter import TraceExporter

        with self._trouble():
            if self._name == "perfetto":
                self._writer = TraceExporter(PerfettoFile(self._file))
            elif self._name == "chrome":
                self._writer = TraceExporter(ChromeFile(self._file))
            elif self._name == "csv":
                self._writer = CallTable(self._text)

    def take(self, batch: "list[AnyEvent]") -> None:
        """Write a batch, for a format that is written event by event."""
        if self._writer is not None:
            with self._trouble():
                self._writer.take(batch)

    def finish(self, timeline: "Timeline | None", wish: ExportRequest) -> None:
        """Write the rest, or a page of the complete run."""
        page = _page(self._name, timeline, wish) if timeline is not None else ""
        with self._trouble():
            if self._writer is not None:
                self._writer.finish()
            else:
                self._text.write(page)

    @contextmanager
    def _trouble(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise ExportError(f"cannot write {self._path}: {error.strerror}") from None


def _page(name: str, timeline: "Timeline", wish: ExportRequest) -> str:
    """The text of a page, a picture or a report; empty for other formats."""
    from sim.export.html import page
    from sim.export.markdown import report
    from sim.export.svg import svg

    if name == "html":
        return page(timeline)
    if name == "markdown":
        return report(timeline, _picture_beside(wish), wish.chains)
    if name == "svg":
        return svg(timeline, _window(timeline, wish), wish.width, path=_critical_steps(timeline, wish.chains))
    return ""


def _critical_steps(timeline: "Timeline", chains: Sequence[Sequence[str]]) -> "list[ChainStep]":
    """The steps of the critical paths of the existing chains; a report says why the others do not exist."""
    from sim.trace.figures.chains import ChainError, chain

    steps: list[ChainStep] = []
    for names in chains:
        with suppress(ChainError):
            critical = chain(timeline, names).critical
            steps += () if critical is None else critical.steps
    return steps


def _window(timeline: "Timeline", wish: ExportRequest) -> "Window":
    from sim.trace.model import Window

    start = max(nearest_ns(wish.start), timeline.begun)
    end = timeline.end if wish.end is None else nearest_ns(wish.end)
    if wish.start and start >= timeline.end:
        raise ExportError(f"the run is over at {timeline.end / SECOND:g} s, before --from {wish.start:g}")
    return Window(start, max(end, start + 1))


def _picture_beside(wish: ExportRequest) -> str | None:
    picture = wish.outputs.get("svg")
    if picture is None:
        return None
    return Path(os.path.relpath(picture.resolve(), wish.outputs["markdown"].resolve().parent)).as_posix()


def _read(source: EventSource) -> "Iterator[list[AnyEvent]]":
    try:
        yield from source()
    except OSError as error:
        raise ExportError(f"the recording cannot be read: {error.strerror}") from None
