"""What may not grow with the length of a run or the number of entities, counted in calls of functions.

Calls are the same on every machine and at every load, where times are not; the bounds are far from both what
is counted and what is counted when the rule is broken.
"""

import sys
import threading
from collections.abc import Callable
from functools import lru_cache, partial
from types import FrameType

import pytest

from cbtui.keys.actions import ACTIONS
from cbtui.keys.keymap import Keymap
from cbtui.looks.theme import Ink, Role
from cbtui.runs.live.live_run import LiveRun
from cbtui.widgets.lanes import INTERVALS_PER_FRAME, LanePainter
from cbtui.widgets.status_line import StatusLine
from sim.engine.setup import RunSetup
from sim.trace.model import Window
from sim.trace.roster import MOST_LANES
from tests.benchmarks import scenes
from tests.benchmarks.crowd import Drawn, call, timers
from tests.benchmarks.drawing import FRAME, long_run
from tests.benchmarks.scenes import Scene, single
from tests.support.daily import first_daily
from tests.support.fake_session import FakeSession
from tests.support.runs import ns

_SELDOM = 1.0
"""Hertz: an hour of it is folded in a moment."""


def calls_of(work: Callable[[], object]) -> int:
    """How many functions of Python are called by what is done, on all threads that it starts."""
    count = 0

    def note(_frame: FrameType, event: str, _argument: object) -> None:
        nonlocal count
        count += event == "call"

    threading.setprofile(note)
    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(None)
        threading.setprofile(None)
    return count


def following_frame(seconds: int) -> int:
    """The calls of a frame that shows the last ten seconds of so long a run, after one before it."""
    timeline, painter = long_run(seconds, _SELDOM), LanePainter()
    first = ns(seconds - 1)

    def frame(now: int) -> None:
        painter.paint(timeline, Window(now - ns(10), now), now, 140, 20)

    frame(first)
    return calls_of(lambda: frame(first + FRAME))


def test_a_frame_costs_the_same_after_an_hour_as_after_a_minute() -> None:
    assert following_frame(3600) < 1.5 * following_frame(60)


def test_the_first_frame_after_zooming_out_looks_at_a_part_of_what_there_is() -> None:
    end = ns(300)
    timeline = long_run(301)

    def paint(painter: LanePainter) -> int:
        return calls_of(lambda: painter.paint(timeline, Window(0, end), end, 140, 20))

    assert paint(LanePainter(looks=INTERVALS_PER_FRAME)) < 0.5 * paint(LanePainter())


def test_a_callback_costs_the_same_among_five_hundred_entities_as_alone() -> None:
    assert of_a_callback(scenes.timer_among(500)) < 1.5 * of_a_callback(scenes.one_timer)


@pytest.mark.parametrize(
    "in_groups", first_daily(False, True), ids=["in one group", "in groups of their own"]
)
@pytest.mark.parametrize("part", ["lanes", "factory", "sentence", "code", "rules"])
def test_a_frame_with_two_thousand_timers_costs_what_fits_on_screen(part: str, in_groups: bool) -> None:
    assert of_a_frame(2000, in_groups)[part] < 1.2 * of_a_frame(MOST_LANES + 20, in_groups)[part]
    assert of_a_frame(2000, in_groups)[part] < 8 * of_a_frame(20, in_groups)[part]


@lru_cache
def of_a_frame(number: int, in_groups: bool) -> dict[str, int]:
    """The calls that each part of a picture takes when the first of so many timers was called once more."""
    drawn = Drawn(number, in_groups)
    for second in (10, 11):
        drawn.go_on(ns(second))
        calls = {part: calls_of(draw) for part, draw in drawn.parts.items()}
    return calls


def test_a_batch_costs_the_same_among_two_thousand_timers_as_among_twenty() -> None:
    def of_a_batch(number: int) -> int:
        session = partial(FakeSession, events=(), until=0)
        live = LiveRun(RunSetup(title="many", programs=()), session, lambda _: None, lambda _: None)
        live.take(timers(number, in_groups=False))
        live.take(call(1, ns(10)))
        return calls_of(lambda: live.take(call(1, ns(11))))

    assert of_a_batch(2000) == of_a_batch(20)


def test_a_style_is_found_by_its_ink_without_a_call() -> None:
    ink = Ink(Role.BAR, 1)
    styles = {ink: "a style"}
    assert calls_of(lambda: styles[ink]) == 1


def test_the_keys_of_actions_are_not_looked_up_one_by_one_if_nobody_has_chosen_any() -> None:
    assert calls_of(lambda: Keymap().of(ACTIONS)) < len(ACTIONS) / 10


def test_what_a_painted_widget_has_already_costs_next_to_nothing_to_set() -> None:
    line = StatusLine()
    assert line.turn == 0
    assert calls_of(lambda: setattr(line, "turn", 0)) < 8


def of_a_callback(scene: Scene) -> float:
    """The calls of one more callback of a scene, played once before so that everything is imported."""
    few, many = 100, 500
    scene(single, few)
    return (calls_of(lambda: scene(single, many)) - calls_of(lambda: scene(single, few))) / (many - few)
