"""The robot pane on screen: when it opens a camera, what it asks of it, and what it shows of the answers."""

import asyncio
from collections.abc import Callable
from time import monotonic

import pytest
from textual.app import App, ComposeResult
from textual.pilot import Pilot

from cbtui.looks.theme import Charset
from cbtui.widgets.robot import RobotView, RobotViewMode
from cbtui.widgets.robot.painter import RobotPainter
from cbtui.widgets.robot.view import PICTURES_A_SECOND
from lessons.description import Actor
from sim.camera import Picture, Shot
from sim.trace.timeline import Timeline
from tests.support.physics import with_pybullet
from tests.support.runs import ns
from tests.widgets.pictures import plain, shared_group

YELLOW = b"\xff\xdb\x00"


class FakeCamera:
    """Remembers what was wanted; its pictures are all yellow."""

    def __init__(self, deliver: Callable[[Picture], None], lost: Callable[[str], None]) -> None:
        self.deliver = deliver
        self.lost = lost
        self.wanted: list[Shot] = []
        self.stopped = False

    def want(self, shot: Shot) -> None:
        self.wanted.append(shot)

    def stop(self) -> None:
        self.stopped = True

    def answer(self) -> None:
        shot = self.wanted[-1]
        self.deliver(Picture(shot.width, shot.height, YELLOW * shot.width * shot.height))


class OnePane(App[None]):
    def __init__(self) -> None:
        super().__init__()
        self.cameras: list[FakeCamera] = []

    def compose(self) -> ComposeResult:
        yield RobotView(open_camera=self._open)

    def _open(self, deliver: Callable[[Picture], None], lost: Callable[[str], None]) -> FakeCamera:
        self.cameras.append(FakeCamera(deliver, lost))
        return self.cameras[-1]

    @property
    def view(self) -> RobotView:
        return self.query_one(RobotView)

    def show(self, now: float, timeline: Timeline | None = None) -> None:
        self.view.now, self.view.timeline = ns(now), timeline or shared_group()

    def text(self) -> str:
        return "\n".join(self.view.render_line(y).text for y in range(self.view.size.height))


async def settle(pilot: Pilot[None], until: Callable[[], bool]) -> None:
    """Let the app work until something holds; a test that waits in vain fails by pytest's patience."""
    for _ in range(400):
        await pilot.pause()
        if until():
            return
        await asyncio.sleep(0.01)
    raise AssertionError("it never came to hold")


async def test_the_pane_draws_on_screen_what_its_painter_paints() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.show(9.25)
        await pilot.pause()
        assert app.text() == plain(RobotPainter().paint(shared_group(), ns(9.25), 80, 14).rows)
        await pilot.resize_terminal(3, 2)
        await pilot.pause()


async def test_no_camera_is_opened_for_a_map() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.show(9.25)
        await pilot.pause()
        assert app.cameras == []


async def test_no_camera_is_opened_without_a_robot() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.show(0.0, Timeline())
        app.view.look = RobotViewMode.CAMERA
        await pilot.pause()
        assert app.cameras == []
        assert "no robot yet" in app.text()


async def test_the_key_goes_from_map_to_camera_to_both_and_back() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.show(9.25)
        looks = []
        for _ in range(3):
            app.view.cycle_camera()
            await pilot.pause()
            looks.append(app.view.look)
        assert looks == [RobotViewMode.CAMERA, RobotViewMode.BOTH, RobotViewMode.MAP]
        assert len(app.cameras) == 1


async def test_no_picture_lies_over_a_scene() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.view.actors = (Actor(figure="belt", follows="timer_callback"),)
        app.show(9.25)
        await pilot.pause()
        scene = app.text()
        app.view.look, app.view.shows_robot = RobotViewMode.BOTH, True
        await pilot.pause()
        app.cameras[0].answer()
        await settle(pilot, lambda: "▀" in app.text())
        app.view.cycle_camera()
        await pilot.pause()
        assert app.text() == scene


async def test_the_picture_wanted_is_that_of_the_moment_on_screen_and_fits_its_place() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.show(9.25)
        app.view.look = RobotViewMode.CAMERA
        await pilot.pause()
        robot, arena = shared_group().robot(ns(9.25)), shared_group().arena
        assert robot is not None
        assert arena is not None
        (shot,) = app.cameras[0].wanted
        assert (shot.walls, shot.sphere) == (arena.walls, arena.sphere)
        assert (shot.x, shot.y, shot.yaw) == pytest.approx((robot.x, robot.y, robot.yaw), abs=1e-3)
        assert (shot.width, shot.height) == (78, 2 * 11)


async def test_pictures_are_wanted_a_few_times_a_second_and_the_last_moment_always() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.view.look = RobotViewMode.CAMERA
        began = monotonic()
        for tick in range(50):
            app.show(4.0 + tick / 10)
            await pilot.pause()
        wanted = app.cameras[0].wanted
        last = shared_group().robot(ns(8.9))
        assert last is not None
        await settle(pilot, lambda: wanted[-1].yaw == round(last.yaw, 3))
        assert len(wanted) <= (monotonic() - began) * PICTURES_A_SECOND + 2


async def test_while_the_robot_stands_still_no_further_picture_is_wanted() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.view.look = RobotViewMode.CAMERA
        for now in (0.1, 0.2, 0.3):
            app.show(now)
            await pilot.pause(0.25)
        await settle(pilot, lambda: app.cameras[0].wanted != [])
        assert len(app.cameras[0].wanted) == 1


async def test_a_picture_is_shown_in_its_place_and_the_figures_stay() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.show(9.25)
        app.view.look = RobotViewMode.BOTH
        await pilot.pause()
        assert "The camera starts." in app.text()
        app.cameras[0].answer()
        await settle(pilot, lambda: "▀" in app.text())
        lines = app.text().splitlines()
        assert all(line.count("▀") == 37 for line in lines[1:12])
        assert "node saw 5.3 s ago" in lines[0]
        assert "pose  0.28" in lines[12]
        assert "The camera starts." not in app.text()


async def test_a_picture_of_another_size_is_not_shown() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.show(9.25)
        app.view.look = RobotViewMode.CAMERA
        await pilot.pause()
        camera = app.cameras[0]
        await pilot.resize_terminal(60, 20)
        await pilot.pause()
        camera.deliver(Picture(78, 22, YELLOW * 78 * 22))
        await pilot.pause()
        assert "▀" not in app.text()
        await settle(pilot, lambda: camera.wanted[-1].width == 58)
        camera.answer()
        await settle(pilot, lambda: "▀" in app.text())


@pytest.mark.parametrize("charset", Charset)
async def test_without_colours_a_picture_is_made_of_signs(
    charset: Charset, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.view.charset = charset
        app.show(9.25)
        app.view.look = RobotViewMode.CAMERA
        await pilot.pause()
        app.cameras[0].answer()
        await settle(pilot, lambda: "The camera" not in app.text())
        picture = [line[1:79] for line in app.text().splitlines()[1:12]]
        assert all(line == "%" * 78 for line in picture)


async def test_a_picture_changes_with_the_theme_where_signs_stand_for_brightness() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.theme = "textual-dark"
        app.view.charset = Charset.ASCII
        app.show(9.25)
        app.view.look = RobotViewMode.CAMERA
        await pilot.pause()
        app.cameras[0].answer()
        await settle(pilot, lambda: "%%%" in app.text())
        app.theme = "textual-light"
        await settle(pilot, lambda: "..." in app.text())


async def test_a_lost_camera_says_why_and_the_next_look_at_it_opens_another() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.show(9.25)
        app.view.cycle_camera()
        await pilot.pause()
        app.cameras[0].lost("The robot's world needs PyBullet.")
        await settle(pilot, lambda: "needs PyBullet" in app.text())
        assert app.cameras[0].stopped
        app.show(9.5)
        await pilot.pause(0.3)
        assert len(app.cameras) == 1
        app.view.cycle_camera()
        await settle(pilot, lambda: len(app.cameras) == 2)
        assert "needs PyBullet" not in app.text()


async def test_the_camera_ends_with_the_screen() -> None:
    app = OnePane()
    async with app.run_test(size=(80, 14)) as pilot:
        app.show(9.25)
        app.view.look = RobotViewMode.CAMERA
        await pilot.pause()
        assert not app.cameras[0].stopped
    assert app.cameras[0].stopped


@with_pybullet
async def test_the_real_camera_shows_the_yellow_sphere() -> None:
    class RealPane(App[None]):
        def compose(self) -> ComposeResult:
            yield RobotView()

    app = RealPane()
    async with app.run_test(size=(80, 14)) as pilot:
        view = app.query_one(RobotView)
        view.now, view.timeline = ns(3.0), shared_group()
        view.look = RobotViewMode.CAMERA

        def yellow() -> bool:
            styles = [style for y in range(1, 12) for _, style, _ in view.render_line(y) if style is not None]
            names = {style.color.name for style in styles if style.color is not None}
            return bool(names & {"#ffda24", "#ffff24", "#dab624"})

        await settle(pilot, yellow)
