"""The interface of trace files: tracks, slices, instants, counters and flows."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple, Protocol, TypeAlias

from sim.trace.model import Nanoseconds

TrackId: TypeAlias = int
FlowId: TypeAlias = int
Args: TypeAlias = Mapping[str, str | int | float]
"""Named values of a slice or instant; times carry their unit in the name (``age_ms``)."""

NO_ARGS: Args = {}


class TrackKind(Enum):
    """The kind of a track."""

    PROCESS = auto()
    THREAD = auto()
    FOLDER = auto()
    """Only holds other tracks."""
    LANE = auto()
    COUNTER = auto()


@dataclass(frozen=True, slots=True)
class Track:
    """A row of the trace viewer; ``parent`` is 0 at the top level, ``unit`` a counter's."""

    id: TrackId
    kind: TrackKind
    name: str
    parent: TrackId = 0
    unit: str = ""


class Arrows(NamedTuple):
    """The flows (arrows) that begin, pass and end at a slice or instant."""

    begin: tuple[FlowId, ...] = ()
    through: tuple[FlowId, ...] = ()
    end: tuple[FlowId, ...] = ()


NO_LINKS = Arrows()


class TraceSink(Protocol):
    """Writes a trace file: a track before its contents, all else in order of time.

    Slices of a track are nested: ``end`` ends the innermost one.
    """

    def begin_run(self, epoch: Nanoseconds) -> None:
        """Set the time of the run's start: ``epoch`` nanoseconds after 1970."""

    def add(self, track: Track) -> None:
        """Add a track."""

    def begin(
        self, track: TrackId, t: Nanoseconds, name: str, category: str, args: Args, links: Arrows = NO_LINKS
    ) -> None:
        """Begin a slice."""

    def end(self, track: TrackId, t: Nanoseconds, args: Args = NO_ARGS) -> None:
        """End the innermost slice; ``args`` are those that became known since its start."""

    def instant(
        self, track: TrackId, t: Nanoseconds, name: str, category: str, args: Args, links: Arrows = NO_LINKS
    ) -> None:
        """Add an event without a duration."""

    def count(self, track: TrackId, t: Nanoseconds, value: float) -> None:
        """Add a value of a counter."""

    def close(self) -> None:
        """Write the rest of the file."""
