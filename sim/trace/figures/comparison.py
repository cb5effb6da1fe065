"""Compares two runs: the figures of the same window of both, callback by callback."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TypeAlias

from sim.trace.descriptions import why_waiting
from sim.trace.events import EntityId
from sim.trace.figures.concurrency import threads_incrementally
from sim.trace.figures.statistics import CallbackStatistics, statistics_incrementally
from sim.trace.figures.summary import RobotFigures, robot_incrementally, trail_in_parts
from sim.trace.incremental import STEP_SIZE, Incremental, collect, run_to_end
from sim.trace.model import EntityInfo, Nanoseconds, Span, Wait, Window
from sim.trace.timeline import Timeline

CallbackKey: TypeAlias = tuple[str, str, str, str, int]
"""Identifies a callback in any run: node, kind, callback, topic or service, and number among equals."""


@dataclass(frozen=True, slots=True)
class WaitFigures:
    """The waits of a ready callback in a window; ``why`` is the reason of most of that time."""

    longest: Nanoseconds
    total: Nanoseconds
    why: str


@dataclass(frozen=True, slots=True)
class CallbackInRun:
    """A callback's figures in one run; ``waits`` None: it ran as soon as it was ready."""

    figures: CallbackStatistics
    waits: WaitFigures | None

    @property
    def longest_wait(self) -> Nanoseconds:
        """The longest wait, whether or not a call followed it in the window."""
        of_calls = self.figures.wait.most if self.figures.wait else 0
        return max(of_calls, self.waits.longest if self.waits else 0)

    @property
    def idle(self) -> bool:
        """Whether the callback had no calls, losses or waits in the window."""
        return not (self.figures.calls or self.figures.drops or self.waits)


@dataclass(frozen=True, slots=True)
class CallbackPair:
    """A callback in both runs; None if a run does not have it."""

    name: str
    first: CallbackInRun | None
    second: CallbackInRun | None


@dataclass(frozen=True, slots=True)
class RunFigures:
    """A run in the window: threads that ran callbacks, the most at one moment, and the robot's figures.

    ``end`` is the end of the whole run; ``collisions`` counts contacts of the robot, including one that began
    before the window. ``mismatches`` counts publishers and subscriptions that do not match by its end,
    ``crashes`` is 1 if an error has ended the run by then, and ``fails`` tells whether one ended it at all.
    """

    end: Nanoseconds
    threads_used: int
    threads_at_once: int
    robot: RobotFigures | None
    collisions: int
    mismatches: int = 0
    crashes: int = 0
    fails: bool = False


@dataclass(frozen=True, slots=True)
class Comparison:
    """The same window of two runs.

    Callbacks are in order of appearance, the first run's first, without those that are idle in both.
    """

    window: Window
    first: RunFigures
    second: RunFigures
    callbacks: tuple[CallbackPair, ...]


def compare(first: Timeline, second: Timeline, window: Window) -> Comparison:
    """Compare a window of two runs; callbacks match by node, kind, function and topic or service.

    The others match without their node, where that is unambiguous. Takes time in proportion to the calls and
    waits in the window.
    """
    return run_to_end(compare_incrementally(first, second, window))


def compare_incrementally(first: Timeline, second: Timeline, window: Window) -> Incremental[Comparison]:
    """As ``compare``, step by step. The runs may continue: events after the window have no effect."""
    of_first = yield from _callbacks_of(first, window)
    of_second = yield from _callbacks_of(second, window)
    partners = _partners(of_first, of_second)
    pairs: list[tuple[CallbackKey, CallbackInRun | None, CallbackInRun | None]] = [
        (key, callback, of_second.get(partners.get(key, key))) for key, callback in of_first.items()
    ]
    taken = {*of_first, *partners.values()}
    pairs += [(key, None, callback) for key, callback in of_second.items() if key not in taken]
    used = [pair for pair in pairs if any(callback and not callback.idle for callback in pair[1:])]
    short = Counter(_short_name(key) for key, *_ in used)
    return Comparison(
        window,
        (yield from _run_figures(first, window)),
        (yield from _run_figures(second, window)),
        tuple(
            CallbackPair(_short_name(key) if short[_short_name(key)] == 1 else _long_name(key), one, other)
            for key, one, other in used
        ),
    )


def first_difference(first: Timeline, second: Timeline, window: Window) -> Incremental[Nanoseconds | None]:
    """Return when the runs first differ in a window: a call begins or ends otherwise, or on one side only.

    Callbacks match as for ``compare``. Times are the same that differ by less than 1 ms, on the real clock by
    less than 100 ms. None: they do not differ.
    """
    is_real = any(each.started is not None and each.started.clock != "virtual" for each in (first, second))
    of_first, of_second = _entities_of(first), _entities_of(second)
    partners = _partners(of_first, of_second)
    found: list[Nanoseconds] = []
    for key, entity in of_first.items():
        other = of_second.get(partners.get(key, key))
        within = Window(window.start, min([window.end, *found]))
        spans = first.spans_of(entity, within), () if other is None else second.spans_of(other, within)
        differs = _first_different(*spans, _ALIKE if is_real else _SAME)
        if differs is not None and differs < window.end:
            found.append(differs)
        yield
    return min(found, default=None)


_SAME: Nanoseconds = 1_000_000
"""Times of two virtual runs that differ by less are the same."""
_ALIKE: Nanoseconds = 100_000_000
"""The same on the real clock, on which a program starts sooner or later and sleeps longer or shorter."""


def _first_different(first: Sequence[Span], second: Sequence[Span], same: Nanoseconds) -> Nanoseconds | None:
    for one, other in zip(first, second, strict=False):
        if abs(one.start - other.start) >= same:
            return min(one.start, other.start)
        ends = [span.end for span in (one, other) if span.end is not None]
        if ends and (len(ends) == 1 or abs(ends[0] - ends[1]) >= same):
            return min(ends)
    return next((span.start for rest in (first[len(second) :], second[len(first) :]) for span in rest), None)


def _partners(first: Iterable[CallbackKey], second: Iterable[CallbackKey]) -> dict[CallbackKey, CallbackKey]:
    """Match callbacks of the first run with those of the second that differ only in the node's name."""
    alone, others = set(first) - set(second), set(second) - set(first)
    nodeless = Counter(key[1:] for key in alone), Counter(key[1:] for key in others)
    found = {key[1:]: key for key in others if nodeless[1][key[1:]] == 1}
    return {key: found[key[1:]] for key in alone if nodeless[0][key[1:]] == 1 and key[1:] in found}


def _short_name(key: CallbackKey) -> str:
    _, kind, callback, name, _ = key
    return callback or name or kind


def _long_name(key: CallbackKey) -> str:
    node, _, _, name, number = key
    place = " ".join(part for part in (node, name) if part)
    return f"{_short_name(key)} ({place}{f' #{number}' if number > 1 else ''})"


def _callbacks_of(timeline: Timeline, window: Window) -> Incremental[dict[CallbackKey, CallbackInRun]]:
    callbacks: dict[CallbackKey, CallbackInRun] = {}
    for key, entity in _entities_of(timeline).items():
        waits = yield from _wait_figures(timeline.waits_of(entity, window), timeline, window)
        figures = yield from statistics_incrementally(timeline, entity, window)
        callbacks[key] = CallbackInRun(figures, waits)
    return callbacks


def _entities_of(timeline: Timeline) -> dict[CallbackKey, EntityId]:
    equals: Counter[tuple[str, str, str, str]] = Counter()
    entities: dict[CallbackKey, EntityId] = {}
    for entity in tuple(timeline.entities.values()):
        alike = _description(entity, timeline)
        equals[alike] += 1
        entities[*alike, equals[alike]] = entity.id
    return entities


def _description(entity: EntityInfo, timeline: Timeline) -> tuple[str, str, str, str]:
    return timeline.nodes.get(entity.node, ""), entity.kind.value, entity.callback, entity.name


def _wait_figures(
    waits: Sequence[Wait], timeline: Timeline, window: Window
) -> Incremental[WaitFigures | None]:
    """The figures of waits, each clipped to the window; a series of waits has one ``since``."""
    shares: defaultdict[str, int] = defaultdict(int)
    lengths = yield from collect(
        (wait.since, why_waiting(wait, timeline), _length_in(wait, timeline, window)) for wait in waits
    )
    longest = length = latest = 0
    for number, (since, why, part) in enumerate(lengths):
        shares[why] += part
        length = length + part if since == latest else part
        latest = since
        longest = max(longest, length)
        if number % STEP_SIZE == 0:
            yield
    if not longest:
        return None
    return WaitFigures(longest, sum(shares.values()), max(shares, key=shares.__getitem__))


def _length_in(wait: Wait, timeline: Timeline, window: Window) -> Nanoseconds:
    """The length of a wait within the window."""
    return max(0, min(wait.end_at(timeline.end), window.end) - max(wait.start, window.start))


def _run_figures(timeline: Timeline, window: Window) -> Incremental[RunFigures]:
    used = 0
    for thread in tuple(timeline.threads):
        used += bool(timeline.spans_on(thread, window))
        yield
    robot = yield from robot_incrementally(timeline, window)
    before = timeline.robot(window.start)
    if robot is not None and before is not None:
        robot = replace(robot, travelled=robot.travelled - before.travelled)
    touching = yield from collect(pose.touching for pose in trail_in_parts(timeline, window))
    collisions = sum(touches for touches, _ in groupby(touching))
    most = yield from threads_incrementally(timeline, window)
    mismatches = sum(each.t <= window.end for each in timeline.mismatches)
    ended = timeline.ended
    fails = ended is not None and ended.failed
    crashes = int(ended is not None and ended.failed and ended.t <= window.end)
    return RunFigures(timeline.end, used, most, robot, collisions, mismatches, crashes, fails)
