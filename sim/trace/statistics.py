"""Statistics of callbacks in a window of time: how often, how long, how regularly, and with how old data.

Every distribution takes its percentiles by nearest rank: the p-th is the smallest value that at least p
per cent of the values do not exceed. So each figure is one that occurred.
"""

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, groupby, pairwise

from sim.trace.concurrency import threads_at_once
from sim.trace.events import EntityId, EntityKind, ThreadId
from sim.trace.model import Entity, Nanoseconds, Span, Wait, Window
from sim.trace.timeline import Timeline


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
    about = timeline.entities[entity]
    stretches = [span for span in timeline.spans_of(entity, window) if span.start >= window.start]
    calls = timeline.calls_begun(entity, window)
    is_timer = about.kind is EntityKind.TIMER
    ages = distribution(span.age for span in calls)
    return CallbackStatistics(
        entity=about,
        calls=len(calls),
        duration=distribution(span.end - span.start for span in stretches if span.end is not None),
        wait=distribution(_waits(timeline, calls, window)),
        jitter=_jitter(about, calls),
        drops=timeline.drops_of(entity, window),
        age=None if is_timer else ages,
        late=ages if is_timer else None,
        errors=sum(bool(span.error) for span in stretches),
    )


def distribution(values: Iterable[Nanoseconds]) -> Distribution | None:
    """The distribution of values; None for none."""
    ranked = sorted(values)
    if not ranked:
        return None
    return Distribution(len(ranked), ranked[0], percentile(ranked, 50), percentile(ranked, 95), ranked[-1])


def percentile(ranked: Sequence[Nanoseconds], per_cent: int) -> Nanoseconds:
    """The percentile of ascending values by nearest rank: number ⌈per_cent/100 · n⌉, counted from 1."""
    return ranked[max(0, -(-per_cent * len(ranked) // 100) - 1)]


def _known(timeline: Timeline, window: Window) -> Window:
    """The window without what lies after the end of the run."""
    return Window(window.start, min(window.end, max(timeline.end, window.start)))


def _waits(timeline: Timeline, calls: Sequence[Span], window: Window) -> Iterable[Nanoseconds]:
    """How long each call's callback had been ready; a series of waits belongs to one call at most."""
    if not calls:
        return
    # A wait that ends with the window's first moment is one for a call that begins then.
    waits = timeline.waits_of(calls[0].entity, Window(window.start - 1, window.end))
    over = list(_over(waits))
    place = 0
    for call in calls:
        waited = 0
        while place < len(over) and over[place][0] <= call.start:
            ended, since = over[place]
            waited = ended - since
            place += 1
        yield waited


def _over(waits: Sequence[Wait]) -> Iterator[tuple[Nanoseconds, Nanoseconds]]:
    """End and ``since`` of each series of waits that is over; in a series only the reason changes."""
    for since, series in groupby(waits, key=lambda wait: wait.since):
        *_, last = series
        if last.end is not None:
            yield last.end, since


def _jitter(entity: Entity, calls: Sequence[Span]) -> Distribution | None:
    if entity.kind is EntityKind.TIMER:
        steps = [after.start - before.start for before, after in pairwise(calls)]
        return distribution(abs(step - entity.period) for step in steps)
    if entity.kind is EntityKind.SUBSCRIPTION:
        published = [call.start - call.age for call in calls]
        steps = sorted(after - before for before, after in pairwise(published))
        return distribution(abs(step - percentile(steps, 50)) for step in steps)
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
