"""Statistics of callbacks in a window of time: how often, how long, how regularly, and with how old data.

Percentiles are nearest-rank: the p-th is the smallest value that at least p per cent of the values do not
exceed. So each figure is a value that occurred.
"""

from array import array
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, groupby, pairwise
from operator import attrgetter
from typing import Any, TypeAlias

import numpy as np

from sim.trace.events import EntityId, EntityKind, ThreadId
from sim.trace.figures.concurrency import threads_at_once
from sim.trace.figures.losses import losses
from sim.trace.figures.waiting import waited_by
from sim.trace.incremental import STEP_SIZE, Incremental, collect, run_to_end, split
from sim.trace.model import EntityInfo, Nanoseconds, Wait, Window
from sim.trace.timeline import Timeline

_Ranked: TypeAlias = np.ndarray[Any, np.dtype[np.int64]]
"""Nanoseconds in ascending order."""


@dataclass(frozen=True, slots=True)
class Distribution:
    """The distribution of values in nanoseconds; ``count`` is at least 1."""

    count: int
    least: Nanoseconds
    median: Nanoseconds
    p95: Nanoseconds
    most: Nanoseconds


@dataclass(frozen=True, slots=True)
class CallbackStatistics:
    """The statistics of a callback's calls in a window. A distribution without values is None.

    - ``calls``: the number that started in the window. A resumption starts no call.
    - ``duration``: of those that started and ended in the window; of a suspended call, each segment.
    - ``wait``: how long the callback, or its message, had waited before each call: the length of the last
      series of waits that ended in the window and before the call, and belongs to no earlier call. 0 if there
      is none. It counts from its beginning, which may be before the window.
    - ``jitter``: absolute deviations. Timers: time between the starts of consecutive calls less the period.
      Subscriptions: time between the publications of consecutive messages less the median of these times.
      None for other entities.
    - ``drops``: messages that its queue lost in the window; None if it is not known.
    - ``age``: age of the message, request or reply at the start of each call; None for timers.
    - ``late``: the lateness of each call of a timer; None for others.
    - Of both, the call that still waits as the window ends counts as far as it is known by then, if it is
      worse than all calls: only then is its rank certain.
    - ``errors``: calls that started in the window and raised.
    """

    entity: EntityInfo
    calls: int
    duration: Distribution | None
    wait: Distribution | None
    jitter: Distribution | None
    drops: int | None
    age: Distribution | None
    late: Distribution | None
    errors: int = 0


@dataclass(frozen=True, slots=True)
class Statistics:
    """The statistics of a window: its callbacks, and the load of its threads.

    ``callbacks`` has the entities whose callbacks ran, waited or lost messages, in order of appearance.
    ``busy`` is the share (0 to 1) of the window in which each thread ran callbacks, blocked ones included;
    ``threads_at_once`` the highest number of such threads at one moment.
    """

    window: Window
    callbacks: tuple[CallbackStatistics, ...]
    busy: dict[ThreadId, float]
    threads_at_once: int


def statistics(timeline: Timeline, window: Window | None = None) -> Statistics:
    """The statistics of a window, or of the whole run.

    Takes time in proportion to the calls and waits in the window.
    """
    asked = Window(0, timeline.end + 1) if window is None else window
    callbacks = (run_to_end(statistics_incrementally(timeline, each, asked)) for each in timeline.entities)
    return Statistics(
        asked,
        tuple(each for each in callbacks if each.drops or each.duration or each.age or each.late),
        {thread: timeline.busy(thread, _known(timeline, asked)) for thread in timeline.threads},
        threads_at_once(timeline, asked),
    )


def statistics_incrementally(
    timeline: Timeline, entity: EntityId, window: Window
) -> Incremental[CallbackStatistics]:
    """The statistics of one callback, step by step; the run may continue after the window.

    Raises:
        KeyError: the timeline knows no such entity.
    """
    known = timeline.entities[entity]
    is_timer = known.kind is EntityKind.TIMER
    # Arrays instead of spans: hundreds of thousands of objects would slow the garbage collector down.
    lengths, starts, ages = array("q"), array("q"), array("q")
    errors = 0
    for part in split(window, timeline.calls_of(entity, window)):
        begun = [span for span in timeline.spans_of(entity, part) if span.start >= part.start]
        ended = ((span.start, span.end_at(window.end)) for span in begun)
        lengths.extend(end - start for start, end in ended if end < window.end)
        errors += sum(bool(span.error) for span in begun)
        calls = timeline.calls_begun(entity, part)
        starts.extend(span.start for span in calls)
        ages.extend(span.age for span in calls)
        yield
    pending = pending_age(timeline, known, window)
    of_ages = yield from _distributed(ages, pending)
    return CallbackStatistics(
        entity=known,
        calls=len(starts),
        duration=(yield from _distributed(lengths)),
        wait=(yield from _waited(timeline, entity, starts, window)),
        jitter=(yield from _jitter(known, starts, ages)),
        drops=losses(timeline, known, window),
        age=None if is_timer else of_ages,
        late=of_ages if is_timer else None,
        errors=errors,
    )


def pending_age(timeline: Timeline, entity: EntityInfo, window: Window) -> Nanoseconds:
    """The age of what a call is for that waits as the window ends, or how late it is then; 0 for none."""
    end = min(window.end, timeline.end)
    since = timeline.queue(entity.id, window.end - 1).oldest
    if since is not None:
        return end - since
    waits = timeline.waits_of(entity.id, Window(window.end - 1, window.end))
    return max((end - wait.since for wait in waits if wait.end is None or wait.end >= window.end), default=0)


def distribution(values: Iterable[Nanoseconds]) -> Distribution | None:
    """The distribution of values; None for none."""
    return run_to_end(_distributed(values))


def _distributed(values: Iterable[Nanoseconds], pending: Nanoseconds = 0) -> Incremental[Distribution | None]:
    """The distribution of values, and of a pending one that exceeds them all."""
    ranked = yield from _ranked(values)
    if pending > max([0, *ranked[-1:]]):
        ranked = np.append(ranked, pending)
    if not len(ranked):
        return None
    least, median, p95, most = (percentile(ranked, per_cent) for per_cent in (0, 50, 95, 100))
    return Distribution(len(ranked), least, median, p95, most)


def _ranked(values: Iterable[Nanoseconds]) -> Incremental[_Ranked]:
    """Values in ascending order."""
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
    """The window up to the end of the run."""
    return Window(window.start, min(window.end, max(timeline.end, window.start)))


def _waited(
    timeline: Timeline, entity: EntityId, starts: Sequence[Nanoseconds], window: Window
) -> Incremental[Distribution | None]:
    """The time that the callback had been ready before each call."""
    if not starts:
        return None
    waits = timeline.waits_of(entity, with_calls_at_start(window))
    finished = yield from collect(_finished_series(waits, timeline))
    return (yield from _distributed(_waits(starts, finished)))


def with_calls_at_start(window: Window) -> Window:
    """Return a window with the waits that end as it begins: those are for calls that begin then."""
    return Window(window.start - 1, window.end)


def _waits(
    starts: Sequence[Nanoseconds], finished: Sequence[tuple[Nanoseconds, Nanoseconds]]
) -> Iterator[Nanoseconds]:
    """The time waited before each start; a series of waits belongs to at most one call."""
    place = 0
    for start in starts:
        waited = 0
        while place < len(finished) and finished[place][0] <= start:
            _, waited = finished[place]
            place += 1
        yield waited


def _finished_series(waits: Iterable[Wait], timeline: Timeline) -> Iterator[tuple[Nanoseconds, Nanoseconds]]:
    """End and length of each finished series of waits; within a series only the reason changes."""
    for _, series in groupby(waits, key=attrgetter("since")):
        *_, last = series
        if last.end is not None:
            yield last.end, waited_by(last.end, last, timeline)


def _jitter(
    entity: EntityInfo, starts: Sequence[Nanoseconds], ages: Sequence[Nanoseconds]
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


def ages_used(timeline: Timeline, timer: EntityInfo, window: Window) -> dict[EntityId, Distribution]:
    """The age of each subscription's newest message, of the timer's node, at the start of the timer's calls.

    The newest message is the one published last of those taken at or before that time. Calls before the first
    message do not count. Reads all calls of the subscriptions before the window's end.
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
