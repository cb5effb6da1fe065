"""Exploring orders of threads: the choices of a schedule, and what threads share without guarding it."""

from sim.trace.events.event import TraceEvent
from sim.trace.events.fields import Nanoseconds, SourcePlace, WireOnly


class ThreadChosen(TraceEvent, frozen=True, tag="choice"):
    """Several threads could continue, and one was chosen by the moves of the run's schedule."""

    number: int
    """Number of the choice, from 0."""
    able: int
    """The number of threads that could continue."""
    chosen: int
    """Which of them continues, from 0."""
    preempts: bool
    """Whether the first of them ran and could have continued."""
    state: int
    """Equal in two runs with the same possible continuations."""
    left: str = ""
    """The first of them and its line, if another one was chosen; else empty."""
    follows: str = ""
    """The one that was chosen instead, and its line; else empty."""


class MachineStalled(TraceEvent, frozen=True, tag="stall"):
    """Time has passed although a thread could go on, as the run's schedule has it."""

    duration: Nanoseconds
    before: str
    """A thread that could go on, and its line."""


class ChoiceAsked(TraceEvent, frozen=True, tag="choice_asked"):
    """Several threads can continue, and time stands until one is chosen."""

    number: int
    """Number of the choice, from 0."""
    threads: tuple[str, ...]
    """The threads that can continue."""
    functions: tuple[str, ...]
    """The innermost function of the program in which each of them is; "" for none."""
    places: tuple[SourcePlace, ...]
    """The line that each of them would run next."""
    preempts: bool
    """Whether the first of them runs and could continue."""
    others: tuple[str, ...]
    """The threads that cannot continue, and what they wait for."""
    pooled: WireOnly[tuple[int, ...]] = ()
    """Positions in ``threads`` of those that are workers of a thread pool."""


class AccessesConflicted(TraceEvent, frozen=True, tag="conflict"):
    """A thread used the same data twice, and another one changed or read it in between."""

    name: str
    """The name of the data, an attribute's with a dot in front."""
    places: tuple[SourcePlace, ...]
    """Where it was used: by the first thread, by the other one, and by the first again."""
    writes: tuple[bool, ...]
    """Which of these uses wrote it."""
    entities: tuple[int, ...]
    """Numbers of the entities whose callbacks these were, 0 for none."""
