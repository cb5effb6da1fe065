"""Statistics of callbacks in a window of time: how often, how long, how regularly, and with how old data.

Every distribution takes its percentiles by nearest rank: the p-th is the smallest value that at least p
per cent of the values do not exceed. So each figure is one that occurred.
"""

from array import array
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, groupby, pairwise
from operator import itemgetter
from typing import Any, TypeAlias

import numpy as np

from sim.trace.events import EntityId, EntityKind, ThreadId
from sim.trace.figures.concurrency import threads_at_once
from sim.trace.incremental import STEP_SIZE, Incremental, collect, run_to_end, split
from sim.trace.model import Entity, Nanoseconds, Window
from sim.trace.timeline import Timeline

_Ranked: TypeAlias = np.ndarray[Any, np.dtype[np.int64]]
"""Nanoseconds in ascending order."""


@dataclass(frozen=True, slots=True)
class Distribution:
    """How values in nanoseconds are distributed; ``count`` is at least 1."""

    count: int
    least: Nanoseconds
    median: Nanoseconds
    p95: Nanoseconds
    most: Nanoseconds


@dataclass(frozen=True, slots=True)
class CallbackStatistics:
    """What a callback's calls in a window were like. A distribution without values is None.

    - ``calls``: how many began in the window. Going on after a suspension begins no call.
    - ``duration``: from start to end of each that began in the window and has ended. A coroutine's call that
      was suspended is several stretches on threads, and counts each.
    - ``wait``: of each call that began in the window, how long the callback had been ready: the length of the
      last series of waits that ended in the window, was over when the call began and is no earlier call's. 0
      for a call without one: it ran as soon as it was ready.
    - ``jitter``: how regular it was, as absolute deviations. Timers: time between the starts of a call and of
      the one before it, less the period. Subscriptions: time between the publications of the message that a
      call takes and of the one before, less the median of these times. Both calls begin in the window. None
      for other entities.
    - ``drops``: messages that its queue lost in the window.
    - ``age``: age of the message, request or reply when a call takes it; None for timers.
    - ``late``: how late each call of a timer was; None for others.
    - ``errors``: calls that began in the window and raised.
    """

    entity: Entity
    calls: int
    duration: Distribution | None
    wait: Distribution | None
    jitter: Distribution | None
    drops: int
    age: Distribution | None
    late: Distribution | None
    errors: int = 0


@dataclass(frozen=True, slots=True)
class Statistics:
    """A window in figures: its callbacks, and how busy its threads were.

    ``callbacks`` has the entities whose callbacks ran, waited or lost messages, in order of appearance.
    ``busy`` is the share (0 to 1) of the window in which each thread ran callbacks, standing still in them
    included; ``threads_at_once`` the most that did so at any one moment.
    """

    window: Window
    callbacks: tuple[CallbackStatistics, ...]
    busy: dict[ThreadId, float]
    threads_at_once: int


def statistics(timeline: Timeline, window: Window | None = None) -> Statistics:
    """The statistics of a window, or of all that is known.

    Takes time in proportion to the calls and waits in the window.
    """
    asked = Window(0, timeline.end + 1) if window is None else window
    callbacks = (statistics_of(timeline, entity, asked) for entity in timeline.entities)
    return Statistics(
        asked,
        tuple(each for each in callbacks if each.calls or each.drops or each.duration or each.wait),
        {thread: timeline.busy(thread, _known(timeline, asked)) for thread in timeline.threads},
        threads_at_once(timeline, asked),
    )


def statistics_of(timeline: Timeline, entity: EntityId, window: Window) -> CallbackStatistics:
    """The statistics of one callback.

    Raises:
        KeyError: the timeline knows no such entity.
    """
    return run_to_end(statistics_incrementally(timeline, entity, window))


def statistics_incrementally(
    timeline: Timeline, entity: EntityId, window: Window
) -> Incremental[CallbackStatistics]:
    """The same in small pieces; the run may go on in between, after the window.

    Raises:
        KeyError: the timeline knows no such entity.
    """
    about = timeline.entities[entity]
    is_timer = about.kind is EntityKind.TIMER
    # Numbers and no spans: hundreds of thousands of objects would keep the garbage collector busy.
    lengths, starts, ages = array("q"), array("q"), array("q")
    errors = 0
    for part in split(window, timeline.calls_of(entity, window)):
        begun = [span for span in timeline.spans_of(entity, part) if span.start >= part.start]
        lengths.extend(span.end - span.start for span in begun if span.end is not None)
        errors += sum(bool(span.error) for span in begun)
        calls = timeline.calls_begun(entity, part)
        starts.extend(span.start for span in calls)
        ages.extend(span.age for span in calls)
        yield
    of_ages = yield from _distributed(ages)
    return CallbackStatistics(
        entity=about,
        calls=len(starts),
        duration=(yield from _distributed(lengths)),
        wait=(yield from _waited(timeline, entity, starts, window)),
        jitter=(yield from _jitter(about, starts, ages)),
        drops=timeline.drops_of(entity, window),
        age=None if is_timer else of_ages,
        late=of_ages if is_timer else None,
        errors=errors,
    )


def distribution(values: Iterable[Nanoseconds]) -> Distribution | None:
    """The distribution of values; None for none."""
    return run_to_end(_distributed(values))


def _distributed(values: Iterable[Nanoseconds]) -> Incremental[Distribution | None]:
    ranked = yield from _ranked(values)
    if not len(ranked):
        return None
    least, median, p95, most = (percentile(ranked, per_cent) for per_cent in (0, 50, 95, 100))
    return Distribution(len(ranked), least, median, p95, most)


def _ranked(values: Iterable[Nanoseconds]) -> Incremental[_Ranked]:
    """Values in ascending order; an hour's are sorted within milliseconds."""
    found = array("q")
    for value in values:
        found.append(value)
        if len(found) % STEP_SIZE == 0:
            yield
    return np.sort(np.frombuffer(found, dtype=np.int64))


def percentile(ranked: Sequence[Nanoseconds] | _Ranked, per_cent: int) -> Nanoseconds:
    """The percentile of ascending values by nearest rank: number ⌈per_cent/100 · n⌉, counted from 1."""
    return int(ranked[max(0, -(-per_cent * len(ranked) // 100) - 1)])


def _known(timeline: Timeline, window: Window) -> Window:
    """The window without what lies after the end of the run."""
    return Window(window.start, min(window.end, max(timeline.end, window.start)))


def _waited(
    timeline: Timeline, entity: EntityId, starts: Sequence[Nanoseconds], window: Window
) -> Incremental[Distribution | None]:
    """How long the callback had been ready before each call."""
    if not starts:
        return None
    # A wait that ends with the window's first moment is one for a call that begins then.
    waits = timeline.waits_of(entity, Window(window.start - 1, window.end))
    known = yield from collect((wait.since, wait.end) for wait in waits)
    over = yield from collect(_over(known))
    return (yield from _distributed(_waits(starts, over)))


def _waits(
    starts: Sequence[Nanoseconds], over: Sequence[tuple[Nanoseconds, Nanoseconds]]
) -> Iterator[Nanoseconds]:
    """How long the callback had been ready; a series of waits belongs to one call at most."""
    place = 0
    for start in starts:
        waited = 0
        while place < len(over) and over[place][0] <= start:
            ended, since = over[place]
            waited = ended - since
            place += 1
        yield waited


def _over(
    waits: Iterable[tuple[Nanoseconds, Nanoseconds | None]],
) -> Iterator[tuple[Nanoseconds, Nanoseconds]]:
    """End and ``since`` of each series of waits that is over; in a series only the reason changes."""
    for since, series in groupby(waits, key=itemgetter(0)):
        *_, (_, end) = series
        if end is not None:
            yield end, since


def _jitter(
    entity: Entity, starts: Sequence[Nanoseconds], ages: Sequence[Nanoseconds]
) -> Incremental[Distribution | None]:
    if entity.kind is EntityKind.TIMER:
        steps = (after - before for before, after in pairwise(starts))
        return (yield from _distributed(abs(step - entity.period) for step in steps))
    if entity.kind is EntityKind.SUBSCRIPTION:
        published = (start - age for start, age in zip(starts, ages, strict=True))
        ranked = yield from _ranked(after - before for before, after in pairwise(published))
        middle = percentile(ranked, 50) if len(ranked) else 0
        return (yield from _distributed(abs(int(step) - middle) for step in ranked))
    return None


def ages_used(timeline: Timeline, timer: Entity, window: Window) -> dict[EntityId, Distribution]:
    """How old the newest message of each subscription of its node was when a timer's calls began.

    Of the messages that the subscription's callback had taken by then (at that moment included) the newest is
    the one published last. Calls before the first message count nowhere. Looks at all calls of the
    subscriptions before the window's end.
    """
    starts_of_timer = [call.start for call in timeline.calls_begun(timer.id, window)]
    used: dict[EntityId, Distribution] = {}
    for entity in timeline.entities.values():
        if entity.kind is not EntityKind.SUBSCRIPTION or entity.node != timer.node:
            continue
        taken = timeline.spans_of(entity.id, Window(0, window.end))
        starts = [span.start for span in taken]
        newest = list(accumulate((span.start - span.age for span in taken), max))
        places = ((start, bisect_right(starts, start)) for start in starts_of_timer)
        ages = distribution(start - newest[place - 1] for start, place in places if place)
        if ages is not None:
            used[entity.id] = ages
    return used
