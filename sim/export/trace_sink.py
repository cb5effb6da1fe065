"""The interface of trace files: tracks, slices, instants, counters and arrows."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple, Protocol, TypeAlias

from sim.trace.model import Nanoseconds

TrackId: TypeAlias = int
FlowId: TypeAlias = int
Facts: TypeAlias = Mapping[str, str | int | float]
"""Named values of a slice or instant; times carry their unit in the name (``age_ms``)."""

NO_FACTS: Facts = {}


class TrackKind(Enum):
    """What a track is."""

    PROCESS = auto()
    THREAD = auto()
    FOLDER = auto()
    """Only holds other tracks."""
    LANE = auto()
    COUNTER = auto()


@dataclass(frozen=True, slots=True)
class Track:
    """A row of the picture; ``parent`` is 0 at the top. ``unit`` is a counter's."""

    id: TrackId
    kind: TrackKind
    name: str
    parent: TrackId = 0
    unit: str = ""


class Links(NamedTuple):
    """The flows (arrows) that begin, pass and end at a slice or instant."""

    begin: tuple[FlowId, ...] = ()
    through: tuple[FlowId, ...] = ()
    end: tuple[FlowId, ...] = ()


NO_LINKS = Links()


class Sink(Protocol):
    """Takes a picture piece by piece: tracks before what lies on them, and all else in order of time.

    Slices of a track are nested: ``end`` ends the innermost one.
    """

    def begin_run(self, epoch: Nanoseconds) -> None:
        """Time 0 of the picture is ``epoch`` nanoseconds after 1970."""

    def add(self, track: Track) -> None:
        """A track appears."""

    def begin(
        self, track: TrackId, t: Nanoseconds, name: str, category: str, facts: Facts, links: Links = NO_LINKS
    ) -> None:
        """A slice begins."""

    def end(self, track: TrackId, t: Nanoseconds, facts: Facts = NO_FACTS) -> None:
        """The innermost slice ends; ``facts`` are what was learnt since its beginning."""

    def instant(
        self, track: TrackId, t: Nanoseconds, name: str, category: str, facts: Facts, links: Links = NO_LINKS
    ) -> None:
        """Something happens that takes no time."""

    def count(self, track: TrackId, t: Nanoseconds, value: float) -> None:
        """A counter has a new value."""

    def close(self) -> None:
        """The picture is complete."""
