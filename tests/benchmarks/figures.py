"""The figures that are watched: what each measures, its goal, and what real rclpy was measured to take.

Most are in units u: one ``deque.append``, ``popleft`` and call of an empty function in a bare loop, measured
just before and after. Machines differ, and the same one differs from minute to minute; u differs with them.
"""

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from statistics import median
from typing import Any

from sim.interfaces import message
from tests.benchmarks import (
    drawing,
    exporting,
    growing,
    keys,
    looking,
    memory,
    probing,
    recording,
    scenes,
    seeking,
    starting,
    terminal,
    virtual,
)
from tests.benchmarks.scenes import MakeExecutor, Scene, events, multi, pinned, single

NUMBER: Any = message("std_msgs", "Int32")(data=7)
ODOMETRY: Any = message("nav_msgs", "Odometry")()

CALLS = 5_000
FEW_CALLS = 1_000
MANY_EVENTS = 200_000
PRESSES = 200


def unit() -> float:
    """The seconds that one u takes now."""
    turns = 40_000
    queue: deque[int] = deque()

    def empty() -> None:
        return None

    began = time.perf_counter()
    for _ in range(turns):
        queue.append(1)
        queue.popleft()
        empty()
    return (time.perf_counter() - began) / turns


@dataclass(frozen=True)
class Figure:
    """``measure`` runs so many calls once; ``goal`` is the most it may be, in ``unit``."""

    name: str
    unit: str
    goal: float
    rclpy: str
    measure: Callable[[int], float]
    calls: int = CALLS

    def median_of(self, rounds: int) -> float:
        """Measure several times, after one run that nobody counts."""
        self.measure(self.calls // 10)
        return median(self.measure(self.calls) for _ in range(rounds))


class DearFigure(Figure):
    """One that takes a console or half a minute to measure: it is measured once, whatever the rounds."""

    def median_of(self, rounds: int) -> float:
        """Measure once."""
        return self.measure(self.calls)


def _shares_of(waits: Callable[[int], list[float]]) -> Callable[[float], Callable[[int], float]]:
    """What gives the milliseconds that a share of waits stays within; measured once for all shares."""
    kept = lru_cache(maxsize=1)(waits)
    return lambda share: lambda presses: keys.percentile(kept(presses), share) * 1e3


_in_a_lesson = _shares_of(keys.in_a_lesson)
_beside_a_busy_node = _shares_of(keys.beside_a_busy_node)


def _in_units(scene: Scene, make_executor: MakeExecutor) -> Callable[[int], float]:
    def measure(calls: int) -> float:
        before = unit()
        took = scene(make_executor, calls)
        return took / ((before + unit()) / 2)

    return measure


def _on_one_core(measure: Callable[[int], float]) -> Callable[[int], float]:
    def measure_pinned(calls: int) -> float:
        with pinned():
            return measure(calls)

    return measure_pinned


def _growth(calls: int) -> float:
    """What a callback costs among 500 entities, relative to what it costs alone."""
    alone = scenes.one_timer(single, calls)
    among = scenes.timer_among(500)(single, calls)
    return among / alone


def _u(
    name: str, scene: Scene, make_executor: MakeExecutor, goal: float, rclpy: str, calls: int = CALLS
) -> Figure:
    return Figure(name, "u", goal, rclpy, _in_units(scene, make_executor), calls)


def _both_ways(
    name: str, scene: Scene, threads: int, goal: float, rclpy: str, on_one_core: str
) -> tuple[Figure, Figure]:
    measure = _in_units(scene, multi(threads))
    return (
        Figure(f"{name}, multi {threads}", "u", goal, rclpy, measure),
        Figure(f"{name}, multi {threads}, one core", "u", goal, on_one_core, _on_one_core(measure)),
    )


_ANY, _PINNED = "5200-7900", "1850-2200"

FIGURES = (
    _u("zero timer, single", scenes.one_timer, single, 120, "920-1250"),
    *_both_ways("zero timer", scenes.one_timer, 2, 250, _ANY, _PINNED),
    *_both_ways("zero timer", scenes.one_timer, 4, 250, _ANY, _PINNED),
    *_both_ways("four timers and groups", scenes.four_timers, 2, 250, _ANY, _PINNED),
    *_both_ways("four timers and groups", scenes.four_timers, 4, 250, _ANY, _PINNED),
    _u("publish to callback, single", scenes.subscriptions(1), single, 250, "1800-2100"),
    _u("publish to callback, multi 4", scenes.subscriptions(1), multi(4), 250, ""),
    _u("publish to callback, events", scenes.subscriptions(1), events, 250, "1100-1600"),
    _u("ten subscriptions, a delivery, single", scenes.subscriptions(10), single, 150, "600-740"),
    _u("ten subscriptions, a delivery, multi 4", scenes.subscriptions(10), multi(4), 150, ""),
    _u("service round trip, single", scenes.calls_in_a_row, single, 700, "4700"),
    _u("service round trip, multi 2", scenes.calls_in_a_row, multi(2), 700, "4700"),
    _u("service, spin until done, single", scenes.calls_awaited, single, 700, "4700", FEW_CALLS),
    # Here too the thread that waits is not the one that runs the callbacks: two hand-overs at least.
    _u("service, spin until done, multi 2", scenes.calls_awaited, multi(2), 2500, "", FEW_CALLS),
    _u(
        "client in another thread, single", scenes.calls_from_another_thread, single, 2500, "11500", FEW_CALLS
    ),
    _u("client in another thread, multi 2", scenes.calls_from_another_thread, multi(2), 2500, "", FEW_CALLS),
    Figure("500 entities against one", "times", 1.2, "100", _growth),
    Figure(
        "1 ms timer, 99 % less late than", "ms", 0.3, "0.32", lambda n: scenes.lateness(single, n) * 1e3, 1000
    ),
    Figure(
        "five idle 100 Hz timers", "% of a core", 2.7, "", lambda n: scenes.idle_timers(single, n) * 1e2, 1000
    ),
    Figure("recording an event", "µs", 5, "", lambda n: recording.event(n) * 1e6),
    Figure("a lesson slowed by recording", "%", 10, "", lambda n: recording.slowing(n) * 1e2, 120),
    Figure(
        "a publisher slowed by recording", "%", 10, "", lambda n: recording.slowing_publisher(n) * 1e2, 480
    ),
    Figure("an event that is not recorded yet", "µs", 2, "", lambda n: recording.following(n) * 1e6),
    Figure("a number as CDR", "µs", 1, "", lambda n: recording.encoding(NUMBER, n) * 1e6),
    Figure("an odometry as CDR", "µs", 5, "", lambda n: recording.encoding(ODOMETRY, n) * 1e6),
    Figure("opening an hour's recording", "ms", 2000, "", lambda n: recording.opening(n) * 1e3, 3600),
    Figure("reading all of an hour's recording", "ms", 3000, "", lambda n: recording.reading(n) * 1e3, 3600),
    Figure("99 % of seeks in an hour's run", "ms", 5, "", lambda n: seeking.seeking(n) * 1e3, 3600),
    Figure("memory that half an hour adds", "MB", 10, "", memory.added, 1800),
    Figure("a lesson sent to a terminal", "kB/s", 500, "", terminal.sent, 100),
    Figure("export to perfetto", "s a million", 15, "", exporting.perfetto, MANY_EVENTS),
    Figure("export to chrome", "s a million", 15, "", exporting.chrome, MANY_EVENTS),
    Figure("export to csv", "s a million", 15, "", exporting.csv, MANY_EVENTS),
    Figure("export of picture and report", "s a million", 15, "", exporting.pages, MANY_EVENTS),
    Figure("a frame as zoomed-out lanes fill", "ms", 8, "", lambda n: drawing.filling_frame(n) * 1e3, 3600),
    Figure(
        "a frame of zoomed-out lanes after", "ms", 8, "", lambda n: 1e3 * drawing.following_frame(n), 3600
    ),
    Figure(
        "longest look of the rules, 10 min read", "ms", 30, "", lambda n: looking.longest_look(n) * 1e3, 600
    ),
    Figure("cbtui --help", "ms", 150, "", lambda n: starting.command_help(n) * 1e3),
    DearFigure("the robot's virtual second", "ms", 20, "", lambda n: virtual.robot(n) * 1e3, 60),
    DearFigure("20 s of every lesson", "s", 60, "", virtual.all_lessons, 20),
    DearFigure("menu on screen", "ms", 250, "", lambda n: starting.menu(n) * 1e3),
    DearFigure("first callbacks of a lesson on screen", "ms", 600, "", lambda n: starting.lesson(n) * 1e3),
    DearFigure("key to screen, half within", "ms", 15, "", _in_a_lesson(0.5), PRESSES),
    DearFigure("key to screen, 99 % within", "ms", 50, "", _in_a_lesson(0.99), PRESSES),
    DearFigure("key beside a busy node, half within", "ms", 15, "", _beside_a_busy_node(0.5), PRESSES),
    DearFigure("key beside a busy node, 99 % within", "ms", 50, "", _beside_a_busy_node(0.99), PRESSES),
    DearFigure("console that draws a lesson", "% of a core", 12, "", lambda n: drawing.live(n) * 1e2, 20),
    DearFigure(
        "and the camera's pictures", "% of a core", 25, "", lambda n: drawing.with_camera(n) * 1e2, 20
    ),
    DearFigure("the probe's CPU time a callback", "µs", 15, "", lambda n: probing.callback_cost(n) * 1e6, 9),
    DearFigure("the probe's CPU time at 1 kHz", "% more", 5, "", lambda n: probing.slowing(n) * 1e2, 9),
    DearFigure(
        "callbacks of 1 kHz lost to the probe", "%", 5, "", lambda n: probing.lost_callbacks(n) * 1e2, 9
    ),
    DearFigure("memory of a console in half an hour", "MB", 10, "", growing.added, 1800),
)
