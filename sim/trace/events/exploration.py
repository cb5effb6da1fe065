"""Exploring orders of threads: the choices of a schedule, and what threads share without guarding it."""

from sim.trace.events.event import TraceEvent
from sim.trace.events.fields import SourcePlace


class ThreadChosen(TraceEvent, frozen=True, tag="choice"):
    """More than one thread could go on, and one was chosen, as the moves of the run's schedule say."""

    number: int
    """Number of the choice, from 0."""
    able: int
    """How many could."""
    chosen: int
    """Which of them goes on, from 0."""
    preempts: bool
    """Whether the first of them ran and could have gone on."""
    state: int
    """Equal in two runs where the same can follow."""
    left: str = ""
    """The first of them and the line that it has come to, where another one was chosen; else empty."""
    follows: str = ""
    """The one that was chosen instead, and its line."""


class ChoiceAsked(TraceEvent, frozen=True, tag="choice_asked"):
    """More than one thread can go on, and time stands until one is chosen."""

    number: int
    """Number of the choice, from 0."""
    threads: tuple[str, ...]
    """The threads that can go on."""
    functions: tuple[str, ...]
    """The innermost function of the program in which each of them is; "" for none."""
    places: tuple[SourcePlace, ...]
    """The line that each of them would run next."""
    preempts: bool
    """Whether the first of them runs and could go on."""
    others: tuple[str, ...]
    """The threads that cannot go on, and what they wait for."""


class AccessesConflicted(TraceEvent, frozen=True, tag="conflict"):
    """A thread used the same data twice, and another one changed or read it in between."""

    name: str
    """The name of the data, an attribute's with a dot in front."""
    places: tuple[SourcePlace, ...]
    """Where it was used: by the one, by the other, and by the one again."""
    writes: tuple[bool, ...]
    """Which of them wrote it."""
    entities: tuple[int, ...]
    """Numbers of the entities in whose callbacks that was, 0 for none."""
