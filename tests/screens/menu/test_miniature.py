"""The picture of the lesson on which the menu's highlight rests."""

import asyncio
from collections.abc import Callable
from multiprocessing import active_children
from threading import Thread

import pytest
from textual.geometry import Size
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.engines.follow import GivenUpError
from cbtui.engines.session import Deliver, Ended, ProcessSession
from cbtui.learning.preview import CALLS, LENGTH, CannotPreviewError, PreviewRun
from cbtui.looks.theme import Charset
from cbtui.widgets.lanes import LanePainter
from cbtui.widgets.miniature import Miniature, PreviewPicture, miniature, sentence_rows
from cbtui.widgets.robot import scene_of
from lessons.catalogue import find, lessons
from sim.engine.setup import RunSetup, TimedCall
from sim.trace.timeline import Timeline
from tests.support.builder import ns
from tests.support.console import NARROW, predict
from tests.support.daily import first_daily
from tests.support.fake_session import FakeEngines, FakeSession
from tests.support.pictures import text_of
from tests.support.runs import shared_group_run


@pytest.fixture(autouse=True)
def rest(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """Let the highlight have rested at once; the function sets another time."""

    def set_rest(seconds: float) -> None:
        monkeypatch.setattr("cbtui.screens.parts.previews.HOVER_DELAY", seconds)

    set_rest(0.001)
    return set_rest


def console() -> tuple[CbtuiApp, FakeEngines]:
    engines = FakeEngines(shared_group_run().events, ns(14))
    app = CbtuiApp(open_session=engines)
    app.animation_level = "none"
    for lesson in lessons():
        predict(app, lesson.id)
    return app, engines


async def until(pilot: Pilot[None], condition: Callable[[], object]) -> None:
    async with asyncio.timeout(60):
        while not condition():
            await pilot.pause(0.01)


def subject_of(app: CbtuiApp) -> PreviewPicture | None:
    return app.screen.query_one(Miniature).subject


async def test_the_lesson_on_which_the_highlight_rests_is_run_and_drawn() -> None:
    app, engines = console()
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: engines.sessions and engines.latest.started)
        setup = engines.latest.setup
        assert (setup.title, setup.clock, setup.speed, setup.until) == (
            lessons()[0].id,
            "virtual",
            None,
            LENGTH,
        )
        assert setup.calls == tuple(TimedCall(at, data=True) for at in CALLS)
        assert "MainThread" not in text_of(app)
        engines.latest.end()
        await until(pilot, lambda: subject_of(app))
        await until(pilot, lambda: "MainThread" in text_of(app))
        await until(pilot, lambda: engines.latest.stopped)


async def test_a_lesson_that_the_highlight_only_passes_is_not_run(rest: Callable[[float], None]) -> None:
    rest(3600)
    app, engines = console()
    async with app.run_test(size=NARROW) as pilot:
        await pilot.press("down", "down", "up")
        await pilot.pause(0.05)
        assert engines.sessions == []


async def test_nothing_is_run_for_the_menu_while_a_lesson_lies_over_it() -> None:
    engines = FakeEngines(shared_group_run().events, ns(14))
    app = CbtuiApp(start_lesson="shared-group", open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await pilot.pause(0.1)
        assert [session.setup.title for session in engines.sessions] == ["shared-group"]


async def test_one_is_run_at_a_time_and_one_that_is_left_is_given_up() -> None:
    app, engines = console()
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: engines.sessions and engines.latest.started)
        await pilot.press("down")
        await until(pilot, lambda: len(engines.sessions) > 1 and engines.latest.started)
        assert engines.sessions[0].stopped
        assert engines.latest.setup.title == lessons()[1].id
        assert subject_of(app) is None


async def test_a_lesson_is_run_for_its_picture_once() -> None:
    app, engines = console()
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: engines.sessions and engines.latest.started)
        engines.latest.end()
        await until(pilot, lambda: subject_of(app))
        await pilot.press("down")
        assert subject_of(app) is None
        await until(pilot, lambda: len(engines.sessions) > 1 and engines.latest.started)
        await pilot.press("up")
        await until(pilot, lambda: subject_of(app))
        await pilot.pause(0.05)
        assert len(engines.sessions) == 2


async def test_a_lesson_that_cannot_be_run_is_said_to_be_once() -> None:
    app, engines = console()
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: engines.sessions and engines.latest.started)
        engines.latest.end("the engine was killed by signal 9")
        await until(pilot, lambda: "killed by signal 9" in text_of(app))
        await pilot.press("down", "up")
        await pilot.pause(0.05)
        assert [session.setup.title for session in engines.sessions].count(lessons()[0].id) == 1


@pytest.mark.parametrize("key", first_daily("enter", "q", "question_mark", "o", "ctrl+p"))
async def test_whatever_takes_the_menu_s_place_ends_the_engine_that_draws(key: str) -> None:
    app, engines = console()
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: engines.sessions and engines.sessions[0].started)
        await pilot.press(key)
        if app.is_running:
            await until(pilot, lambda: engines.sessions[0].stopped)
    assert engines.sessions[0].stopped


async def test_it_is_drawn_after_all_when_the_menu_is_back() -> None:
    app, engines = console()
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: engines.sessions and engines.latest.started)
        await pilot.press("question_mark")
        await until(pilot, lambda: engines.sessions[0].stopped)
        await pilot.press("escape")
        await until(pilot, lambda: len(engines.sessions) > 1 and engines.latest.started)
        engines.latest.end()
        await until(pilot, lambda: subject_of(app))


async def test_the_cursor_goes_through_a_run_once_and_rests_at_its_end() -> None:
    app, engines = console()
    app.animation_level = "full"
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: engines.sessions and engines.latest.started)
        engines.latest.end()
        await until(pilot, lambda: subject_of(app))
        drawn = app.screen.query_one(Miniature)
        assert drawn.now < ns(14)
        drawn._began -= 100
        await until(pilot, lambda: drawn.now == ns(14))
        assert drawn._sweep is None


@pytest.fixture(scope="module")
def shared_group() -> Timeline:
    """A whole run, which nobody changes."""
    timeline = Timeline()
    timeline.extend(shared_group_run().events)
    return timeline


@pytest.mark.slow
@pytest.mark.parametrize("charset", Charset)
@pytest.mark.parametrize("width", [*range(1, 130, 7), 38, 39, 61, 62, 120])
def test_a_picture_is_as_wide_as_it_is_to_be(width: int, charset: Charset, shared_group: Timeline) -> None:
    rows = miniature(
        PreviewPicture(shared_group, LanePainter(charset)), shared_group.end // 2, Size(width, 8)
    )
    assert {sum(len(run.text) for run in row) for row in rows} == {width}
    assert len(rows) <= 8


def test_a_tall_picture_has_the_lessons_robot_or_figures_below_its_lanes(shared_group: Timeline) -> None:
    scene = scene_of(find("shared-group"), shared_group, Charset.BRAILLE)
    subject = PreviewPicture(shared_group, LanePainter(), scene)
    for height, is_shown in ((9, False), (25, True)):
        rows = miniature(subject, shared_group.end // 2, Size(100, height))
        assert any("true scan" in run.text for row in rows for run in row) is is_shown
        assert len(rows) <= height
        assert {sum(len(run.text) for run in row) for row in rows} == {100}


def test_a_sentence_is_wrapped_and_cut_to_the_room() -> None:
    rows = sentence_rows("one two three four", Size(9, 2))
    assert ["".join(run.text for run in row) for row in rows] == ["one two  ", "three    "]
    assert sentence_rows("one", Size(0, 0)) == []


@pytest.mark.parametrize(("height", "shown"), [(13, 0), (14, 12), (20, 18)])
def test_below_a_question_the_code_that_it_is_about_is_shown_if_much_of_it_fits(
    height: int, shown: int
) -> None:
    code = "".join(f"line {number}\n" for number in range(40))
    rows = sentence_rows("What does it do?", Size(40, height), code)
    lines = ["".join(run.text for run in row).rstrip() for row in rows]
    assert lines == ["What does it do?", *(["", *code.splitlines()[:shown]] if shown else [])]


# with a real engine


def test_the_first_seconds_of_a_lesson_are_really_run_and_leave_no_process() -> None:
    timeline = PreviewRun(find("reentrant-2-threads"), ProcessSession).run()
    assert timeline.end == LENGTH
    assert len(timeline.services_called) == 1
    assert active_children() == []


def test_a_run_that_is_given_up_ends_its_engine() -> None:
    run = PreviewRun(find("shared-group"), ProcessSession)
    ended: list[BaseException] = []

    def follow() -> None:
        try:
            run.run()
        except GivenUpError as error:
            ended.append(error)

    thread = Thread(target=follow)
    thread.start()
    run.give_up()
    thread.join()
    assert len(ended) == 1
    assert active_children() == []


def test_an_engine_that_cannot_be_started_is_told_of_in_a_sentence() -> None:
    class NoEngine(FakeSession):
        def start(self) -> None:
            raise OSError(11, "Resource temporarily unavailable")

    def no_engines(setup: RunSetup, deliver: Deliver, ended: Ended) -> NoEngine:
        return NoEngine(setup, deliver, ended, [], 0)

    with pytest.raises(CannotPreviewError, match="Resource temporarily unavailable"):
        PreviewRun(lessons()[0], no_engines).run()


def test_a_lesson_on_the_real_clock_is_not_run_for_its_picture() -> None:
    computing = next(lesson for lesson in lessons() if lesson.setup.clock == "real")
    engines = FakeEngines((), 0)
    with pytest.raises(CannotPreviewError, match="on the real clock that would take 20 s"):
        PreviewRun(computing, engines).run()
    assert not any(session.started for session in engines.sessions)
