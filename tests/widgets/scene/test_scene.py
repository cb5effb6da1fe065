"""Scenes: where a figure stands at a moment, and what is said beside it."""

import asyncio
from typing import get_args, get_type_hints

import pytest

from cbtui.looks.theme import Charset
from cbtui.widgets.robot import RobotView
from cbtui.widgets.scene import paint_scene
from cbtui.widgets.scene.figures import ACROSS, DOWN, FIGURES
from lessons.catalogue import lessons
from lessons.description import Actor
from lessons.lesson import Lesson
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns
from tests.support.console import WIDE, RecordedConsole, settle
from tests.support.pictures import text_of
from tests.support.runs import shared_group_run
from tests.widgets.pictures import plain, shared_group, told

ACTORS = (Actor(figure="belt", follows="timer_callback"), Actor(figure="camera", follows="/odom"))
WITH_SCENES = [lesson for lesson in lessons() if lesson.scene]


def scene(timeline: Timeline, at: float, height: int = 6, charset: Charset = Charset.BRAILLE) -> list[str]:
    return plain(paint_scene(ACTORS, timeline, ns(at), 60, height, charset)).splitlines()


def test_a_figure_moves_while_its_callback_runs_and_goes_back_afterwards() -> None:
    timeline = shared_group()
    before, *running = [scene(timeline, at)[1][:10] for at in (3.95, 4.1, 5.0, 13.0)]
    assert len({before, *running}) == 4
    assert scene(timeline, 0.1)[1][:10] == scene(timeline, 0.4)[1][:10]


def test_a_moment_looks_the_same_however_one_came_there() -> None:
    whole, part = shared_group(), shared_group(12.0)
    assert scene(whole, 11.5) == scene(part, 11.5)


def test_what_a_callback_does_and_why_stands_beside_its_figure() -> None:
    timeline = shared_group(12.9)
    first, _, _, second, reason, _ = scene(timeline, 12.9)
    assert first.rstrip().endswith("timer_callback runs 8.9 s")
    assert second.rstrip().endswith("/odom waits 8.9 s")
    assert "group A held by timer_callback; lost 20 message" in reason
    assert "group A held by timer_callback" in "\n".join(scene(timeline, 4.2))


@pytest.mark.parametrize(("width", "height", "row", "column"), [(60, 10, 1, 22), (44, 14, 4, 0)])
def test_where_there_is_room_figures_are_twice_as_large(
    width: int, height: int, row: int, column: int
) -> None:
    timeline = shared_group(12.9)
    rows = plain(paint_scene(ACTORS, timeline, ns(12.9), width, height, Charset.BRAILLE)).splitlines()
    assert len(rows) == height
    assert {len(each) for each in rows} == {width}
    assert rows[row][column:].rstrip() == "timer_callback runs 8.9 s"
    assert rows[row + 1 + height // 2][column:].startswith("group A held by timer_callback")


def test_in_few_columns_name_state_and_reason_stand_one_below_the_other() -> None:
    timeline = shared_group(12.9)
    rows = plain(paint_scene(ACTORS, timeline, ns(12.9), 34, 9, Charset.BRAILLE)).splitlines()
    assert [row[12:].rstrip() for row in (*rows[:2], *rows[3:5])] == (
        ["timer_callback", "runs 8.9 s", "/odom", "waits 8.9 s"]
    )
    assert rows[5].startswith("group A held by timer_callback")


def test_nothing_is_left_out_silently_where_not_every_figure_has_room() -> None:
    timeline = shared_group(12.9)
    first, _, second = scene(timeline, 12.9, height=3)
    assert first.rstrip().endswith("timer_callback runs 8.9 s")
    assert second.strip().startswith("/odom waits 8.9 s: group A held by timer")
    assert [row.split()[:2] for row in scene(timeline, 12.9, height=2)] == [
        ["timer_callback", "runs"],
        ["/odom", "waits"],
    ]
    assert scene(timeline, 12.9, height=1)[0].rstrip() == "+2 more"


@pytest.mark.parametrize("charset", Charset)
@pytest.mark.parametrize(("width", "height"), [(60, 6), (24, 4), (11, 1), (5, 3), (60, 12), (24, 14)])
def test_a_scene_has_exactly_its_room(charset: Charset, width: int, height: int) -> None:
    timeline = shared_group(12.9)
    rows = paint_scene(ACTORS, timeline, timeline.end, width, height, charset)
    assert len(rows) <= height
    assert {sum(len(run.text) for run in row) for row in rows} == {width}
    assert charset is not Charset.ASCII or plain(rows).isascii()


def test_every_figure_that_a_lesson_may_name_is_drawn_within_its_cells() -> None:
    assert set(get_args(get_type_hints(Actor)["figure"])) == set(FIGURES)
    for figure in FIGURES.values():
        for (right, below), lines in (((0, 0), figure.still), *figure.moving):
            for left, top, end, bottom in lines:
                assert all(0 <= x < ACROSS for x in (left, end, left + right, end + right))
                assert all(0 <= y < DOWN for y in (top, bottom, top + below, bottom + below))


@pytest.mark.parametrize("lesson", WITH_SCENES, ids=lambda lesson: lesson.id)
def test_a_scene_follows_what_is_in_its_node(lesson: Lesson) -> None:
    source = lesson.node_path.read_text()
    for actor in lesson.scene:
        assert f"def {actor.follows}(" in source or f'"{actor.follows}"' in source


async def test_c_goes_from_the_scene_to_the_map_and_on_to_the_scene_again() -> None:
    app = RecordedConsole("stale-data", shared_group_run().events, 12.9)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        app.lesson_screen.draw()
        await settle(pilot)
        view = app.lesson_screen.query_one(RobotView)
        assert "decide is not there yet" in text_of(app)
        looks = []
        for _ in range(4):
            await pilot.press("c")
            looks.append((view.shows_robot, view.look.value))
        assert looks == [(True, "map"), (True, "camera"), (True, "both"), (False, "map")]
        async with asyncio.timeout(30):
            while "decide is not there yet" not in text_of(app):
                await pilot.pause(0.02)


def test_of_several_calls_of_a_callback_the_longest_is_told() -> None:
    run = Run()
    work = run.subscription(run.reentrant(run.node("/n")), "/work", "work")
    for thread, at in ((run.thread("Pool-0_0"), 2.0), (run.thread("Pool-0_1"), 1.0)):
        run.callback(work, thread, at)
    run.stop(4.0)
    rows = paint_scene([Actor(figure="belt", follows="work")], told(run), ns(3.0), 60, 2, Charset.BRAILLE)
    assert plain(rows).splitlines()[0].rstrip().endswith("work runs 2.0 s")
