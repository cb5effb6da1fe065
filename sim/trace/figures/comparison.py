"""Compares two runs: the figures of the same window of both, callback by callback."""

from bisect import bisect
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from operator import attrgetter
from typing import NamedTuple, TypeAlias

from sim.trace.descriptions import why_waiting
from sim.trace.events import EntityId
from sim.trace.figures.concurrency import threads_incrementally
from sim.trace.figures.losses import losses
from sim.trace.figures.statistics import CallbackStatistics, statistics_incrementally, with_calls_at_start
from sim.trace.figures.summary import RobotFigures, robot_incrementally, trail_in_parts
from sim.trace.figures.waiting import waited_by
from sim.trace.incremental import STEP_SIZE, Incremental, collect, run_to_end
from sim.trace.model import EntityInfo, Nanoseconds, Span, Window
from sim.trace.timeline import Timeline

CallbackKey: TypeAlias = tuple[str, str, str, str, int]
"""Identifies a callback in any run: node, kind, callback, topic or service, and number among equals."""


_LONG: Nanoseconds = 10_000_000
_LASTING: Nanoseconds = 1_000_000_000


@dataclass(frozen=True, slots=True)
class WaitFigures:
    """The waits of a ready callback that reach into a window; ``why`` is the reason of most of its time.

    ``longest`` is that of a callback, or of its next message, from its beginning to the window's end at most;
    ``lasts``: it took a second, and still goes on then.
    """

    longest: Nanoseconds
    why: str
    lasts: bool = False


@dataclass(frozen=True, slots=True)
class CallbackInRun:
    """A callback's figures in one run; ``waits`` None: it ran as soon as it was ready."""

    figures: CallbackStatistics
    waits: WaitFigures | None

    @property
    def longest_wait(self) -> Nanoseconds:
        """The longest wait, whether or not a call followed it in the window."""
        return self.waits.longest if self.waits else 0

    @property
    def lasts(self) -> bool:
        """Whether the longest wait still goes on as the window ends."""
        return self.waits is not None and self.waits.lasts

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

    @property
    def calls(self) -> tuple[int, int]:
        """The number of its calls in each run."""
        first, second = (side.figures.calls if side else 0 for side in (self.first, self.second))
        return first, second

    @property
    def is_unlike(self) -> bool:
        """Whether it runs in one run only, or there more than twice as often."""
        return max(self.calls) > 2 * min(self.calls)

    @property
    def lasts(self) -> bool:
        """Whether in both runs it still waits as the window ends."""
        return all(side is not None and side.lasts for side in (self.first, self.second))

    @property
    def takes_unlike(self) -> bool:
        """Whether its longest call takes more than twice as long in one run."""
        sides = (side and side.figures.duration for side in (self.first, self.second))
        longest = [duration.most if duration else 0 for duration in sides]
        return max(longest) > 2 * min(longest) + _LONG

    @property
    def waits(self) -> bool:
        """Whether it waits long in a run."""
        return any(side is not None and side.longest_wait >= _LONG for side in (self.first, self.second))


@dataclass(frozen=True, slots=True)
class RunFigures:
    """A run in the window: threads that ran callbacks, the most at one moment, and the robot's figures.

    ``end`` is the end of the whole run; ``collisions`` counts contacts of the robot, including one that began
    before the window. ``mismatches`` counts subscriptions that do not match a publisher by its end,
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


class CommandPair(NamedTuple):
    """A service call or a reset by the person, and how many times it was given in each run."""

    text: str
    first: int
    second: int


@dataclass(frozen=True, slots=True)
class Comparison:
    """The same window of two runs.

    Callbacks are in order of appearance, the first run's first, without those that are idle in both.
    ``is_real`` is of runs on the real clock, of which what differs little is no difference.
    ``unlike_commands`` were not given as often in both runs by the window's end. ``moved`` is the number of
    callbacks that are in nodes of different names.
    """

    window: Window
    first: RunFigures
    second: RunFigures
    callbacks: tuple[CallbackPair, ...]
    is_real: bool = False
    unlike_commands: tuple[CommandPair, ...] = ()
    moved: int = 0

    @property
    def shared(self) -> list[str]:
        """The names of the callbacks that are in both runs."""
        return [pair.name for pair in self.callbacks if pair.first and pair.second]

    @property
    def shares_little(self) -> bool:
        """Whether each run has more callbacks of its own than are in both and not ``moved``."""
        alone = Counter((pair.first is None, pair.second is None) for pair in self.callbacks)
        return len(self.shared) - self.moved < min(alone[True, False], alone[False, True])


def compare(first: Timeline, second: Timeline, window: Window) -> Comparison:
    """Compare a window of two runs; callbacks match by node, kind, function and topic or service.

    The others match without their node, where that is unambiguous. On the real clock a window from the
    beginning starts at the first call of each run, and is as long in both; losses before that call count,
    too. Takes time in proportion to the calls and waits in the window.
    """
    return run_to_end(compare_incrementally(first, second, window))


def compare_incrementally(first: Timeline, second: Timeline, window: Window) -> Incremental[Comparison]:
    """As ``compare``, step by step. The runs may continue: events after the window have no effect."""
    of_first_run, of_second_run = _windows(first, second, window)
    of_first = yield from _callbacks_of(first, of_first_run, window.start)
    of_second = yield from _callbacks_of(second, of_second_run, window.start)
    partners = _partners(of_first, of_second)
    pairs: list[tuple[CallbackKey, CallbackInRun | None, CallbackInRun | None]] = [
        (key, callback, of_second.get(partners.get(key, key))) for key, callback in of_first.items()
    ]
    taken = {*of_first, *partners.values()}
    pairs += [(key, None, callback) for key, callback in of_second.items() if key not in taken]
    used = [pair for pair in pairs if any(callback and not callback.idle for callback in pair[1:])]
    names = [_name(one or other) for _, one, other in used]
    shared = Counter(names)
    return Comparison(
        window,
        (yield from _run_figures(first, of_first_run)),
        (yield from _run_figures(second, of_second_run)),
        tuple(
            CallbackPair(name if shared[name] == 1 else _long_name(name, key), one, other)
            for name, (key, one, other) in zip(names, used, strict=True)
        ),
        first.is_real or second.is_real,
        unlike_commands(first, second, window.end),
        sum(key in partners for key, *_ in used),
    )


def unlike_commands(first: Timeline, second: Timeline, end: Nanoseconds) -> tuple[CommandPair, ...]:
    """Return what the person did before ``end`` in one of the runs more often than in the other."""
    one, other = (Counter(each.text for each in run.given if each.t < end) for run in (first, second))
    return tuple(
        CommandPair(text, one[text], other[text]) for text in one | other if one[text] != other[text]
    )


def _windows(first: Timeline, second: Timeline, window: Window) -> tuple[Window, Window]:
    """The window in each run: as long in both, and from the first call if the real clock began before.

    That of one run may come only after the window, which an early end of the other one has cut.
    """
    if window.start or not (first.is_real or second.is_real):
        return window, window
    starts = [_first_call(each, Window(0, each.end + 1)) for each in (first, second)]
    ends = [at for at, run in zip(starts, (first, second), strict=True) if run.end + 1 == window.end]
    length = window.end - max(ends or starts)
    if length <= 0:
        return window, window
    return Window(starts[0], starts[0] + length), Window(starts[1], starts[1] + length)


def covered(timeline: Timeline) -> Nanoseconds:
    """How long a window can be that a run fills; the moment of an exception that ended it belongs to it."""
    return timeline.end + (timeline.ended is not None and timeline.ended.failed)


def _first_call(timeline: Timeline, window: Window) -> Nanoseconds:
    of_threads = [timeline.spans_on(thread, window)[:1] for thread in tuple(timeline.threads)]
    return min((span.start for spans in of_threads for span in spans), default=window.start)


def first_difference(first: Timeline, second: Timeline, window: Window) -> Incremental[Nanoseconds | None]:
    """Return when the runs first differ in a window: a call begins or ends otherwise, or on one side only.

    Callbacks match as for ``compare``. Times are the same that differ by less than 1 ms. On the real clock
    each call is compared with the nearest one, from the first call of each run on, and 100 ms are no
    difference. None: they do not differ.
    """
    real = first.is_real or second.is_real
    windows = _windows(first, second, window)
    start, end = windows[0].start, windows[0].length
    for entity, other in matched(first, second):
        one, another = (
            [] if id_ is None else _times(run.spans_of(id_, Window(own.start, own.start + end)), own.start)
            for run, id_, own in zip((first, second), (entity, other), windows, strict=True)
        )
        differs = _first_unlike(one, another, end - _ALIKE) if real else _first_different(one, another)
        end = min(end, end if differs is None else differs)
        yield
    return start + max(0, end) if end < windows[0].length else None


def matched(first: Timeline, second: Timeline) -> list[tuple[EntityId, EntityId | None]]:
    """Return the callbacks of the first run, each with its match in the second run, if any."""
    of_first, of_second = _entities_of(first), _entities_of(second)
    partners = _partners(of_first, of_second)
    return [(entity, of_second.get(partners.get(key, key))) for key, entity in of_first.items()]


_SAME: Nanoseconds = 1_000_000
"""Times of two virtual runs that differ by less are the same."""
_ALIKE: Nanoseconds = 100_000_000
"""The same on the real clock, on which a program sleeps longer or shorter."""


class _Call(NamedTuple):
    """When a call began and ended, since the beginning of a window; None while it runs."""

    start: Nanoseconds
    end: Nanoseconds | None
    error: str

    def parts_from(self, other: "_Call", same: Nanoseconds) -> Nanoseconds | None:
        """When this call and the other one differ by so much, or only one has an error; None for never."""
        if abs(self.start - other.start) >= same:
            return min(self.start, other.start)
        ends = [call.end for call in (self, other) if call.end is not None]
        differ = len(ends) == 1 or bool(self.error) != bool(other.error)
        return min(ends) if ends and (differ or abs(ends[0] - ends[1]) >= same) else None


def _times(spans: Sequence[Span], zero: Nanoseconds) -> list[_Call]:
    return [_Call(each.start - zero, each.end and each.end - zero, each.error) for each in spans]


def _first_different(first: Sequence[_Call], second: Sequence[_Call]) -> Nanoseconds | None:
    for one, other in zip(first, second, strict=False):
        differs = one.parts_from(other, _SAME)
        if differs is not None:
            return differs
    return next((call.start for rest in (first[len(second) :], second[len(first) :]) for call in rest), None)


def _first_unlike(first: Sequence[_Call], second: Sequence[_Call], end: Nanoseconds) -> Nanoseconds | None:
    """When a call of one run first has none like it in the other, before ``end``."""
    found = [end]
    for own, others in ((first, second), (second, first)):
        for call in own:
            place = bisect(others, call.start, key=attrgetter("start"))
            near = min(
                others[max(0, place - 1) : place + 1],
                key=lambda other: abs(other.start - call.start),
                default=None,
            )
            differs = (
                call.start
                if near is None or abs(near.start - call.start) >= _ALIKE
                else call.parts_from(near, _ALIKE)
            )
            if differs is not None:
                found.append(differs)
                break
    return min(found) if min(found) < end else None


def _partners(first: Iterable[CallbackKey], second: Iterable[CallbackKey]) -> dict[CallbackKey, CallbackKey]:
    """Match callbacks of the first run with those of the second that differ only in the node's name."""
    alone, others = set(first) - set(second), set(second) - set(first)
    nodeless = Counter(key[1:] for key in alone), Counter(key[1:] for key in others)
    found = {key[1:]: key for key in others if nodeless[1][key[1:]] == 1}
    return {key: found[key[1:]] for key in alone if nodeless[0][key[1:]] == 1 and key[1:] in found}


def _name(callback: CallbackInRun | None) -> str:
    return callback.figures.entity.spoken_name if callback else ""


def _long_name(short: str, key: CallbackKey) -> str:
    node, _, _, name, number = key
    known = "" if name == short else name
    place = known if known.startswith(f"{node}/") else " ".join(part for part in (node, known) if part)
    return f"{short} ({place}{f' #{number}' if number > 1 else ''})"


def _callbacks_of(
    timeline: Timeline, window: Window, losses_from: Nanoseconds
) -> Incremental[dict[CallbackKey, CallbackInRun]]:
    callbacks: dict[CallbackKey, CallbackInRun] = {}
    for key, entity in _entities_of(timeline).items():
        waits = yield from _wait_figures(entity, timeline, window)
        figures = yield from statistics_incrementally(timeline, entity, window)
        drops = losses(timeline, timeline.entities[entity], Window(losses_from, window.end))
        callbacks[key] = CallbackInRun(replace(figures, drops=drops), waits)
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


def _wait_figures(entity: EntityId, timeline: Timeline, window: Window) -> Incremental[WaitFigures | None]:
    """The figures of the waits of a callback; a series of waits has one ``since``."""
    shares: defaultdict[str, int] = defaultdict(int)
    series: dict[Nanoseconds, Nanoseconds] = {}
    pending: Nanoseconds = 0
    for number, wait in enumerate(timeline.waits_of(entity, with_calls_at_start(window))):
        end = min(wait.end_at(timeline.end), window.end)
        shares[why_waiting(wait, timeline)] += max(0, end - max(wait.start, window.start))
        series[wait.since] = waited_by(end, wait, timeline)
        pending = series[wait.since] if wait.end is None or wait.end > window.end else 0
        if number % STEP_SIZE == 0:
            yield
    longest = max(series.values(), default=0)
    if not longest:
        return None
    return WaitFigures(longest, max(shares, key=shares.__getitem__), longest == pending >= _LASTING)


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
    unmatched = {(each.entity, each.subscription) for each in timeline.mismatches if each.t <= window.end}
    ended = timeline.ended
    fails = ended is not None and ended.failed
    crashes = int(ended is not None and ended.failed and ended.t <= window.end)
    return RunFigures(timeline.end, used, most, robot, collisions, len(unmatched), crashes, fails)
