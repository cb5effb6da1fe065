"""The robot pane: maps of its world and a camera's picture, at the cursor's moment."""

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from rich.segment import Segment
from textual import on
from textual.geometry import Region, Size
from textual.message import Message
from textual.reactive import reactive
from textual.strip import Strip

from cbtui.looks.theme import Charset, TextRun
from cbtui.widgets.painted_widget import PaintedWidget, painted
from cbtui.widgets.robot.camera_picture import half_blocks, ramp
from cbtui.widgets.robot.painter import RobotPainter, RobotPainting
from cbtui.widgets.robot.pane_regions import RobotViewMode
from cbtui.widgets.scene import paint_scene
from lessons.description import Actor
from lessons.lesson import Lesson
from sim.camera import Camera, Picture, Shot
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

PICTURES_A_SECOND = 5
_STARTING = "The camera starts."


class CameraClient(Protocol):
    """The camera's interface as the pane needs it; ``sim.camera.Camera`` implements it."""

    def want(self, shot: Shot) -> None:
        """Request a picture; a new request replaces a waiting one."""

    def stop(self) -> None:
        """Close the camera."""


OpenCamera = Callable[[Callable[[Picture], None], Callable[[str], None]], CameraClient]


class RobotView(PaintedWidget):
    """Robot, trail, true scan and the scan the node last saw, from above; a camera's picture when asked for.

    Set ``timeline`` again (it may be the same one) when it has grown. The camera is opened when its picture
    is first shown, and gets ``PICTURES_A_SECOND`` requests at most.
    """

    timeline: reactive[Timeline] = painted(Timeline, always_update=True)
    now: reactive[Nanoseconds] = painted(0)
    charset: reactive[Charset] = painted(Charset.BRAILLE)
    look: reactive[RobotViewMode] = painted(RobotViewMode.MAP)
    actors: reactive[tuple[Actor, ...]] = painted(())
    """The figures of the lesson's scene, which come before the robot."""
    shows_robot: reactive[bool] = painted(False)

    @dataclass
    class PictureTaken(Message):
        """The camera took a picture."""

        picture: Picture

    @dataclass
    class CameraLost(Message):
        """The camera failed and takes no more pictures."""

        why: str

    def __init__(self, *, id: str | None = None, open_camera: OpenCamera = Camera) -> None:  # noqa: A002
        super().__init__(id=id)
        self._open_camera = open_camera
        self._camera: CameraClient | None = None
        self._failure = ""
        self._requested: Shot | None = None
        self._resting = False
        self._picture: Picture | None = None
        self._strips: Sequence[Strip] = ()
        self._painting = RobotPainting(())

    def cycle_camera(self) -> None:
        """Show the next of scene, map, camera's picture and both; retry a camera that failed."""
        self._failure = ""
        if self.shows_robot or not self.actors:
            self.look = self.look.following
        self.shows_robot = self.look is not RobotViewMode.MAP or not self.shows_robot

    @property
    def shows_scene(self) -> bool:
        """Whether it shows the lesson's scene in place of the robot."""
        return bool(self.actors) and not self.shows_robot

    # drawing

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint everything except the picture, which is requested."""
        if self.shows_scene:
            self._painting = RobotPainting(())
            return paint_scene(self.actors, self.timeline, self.now, size.width, size.height, self.charset)
        note = "" if self._fits() else self._failure or _STARTING
        painter = RobotPainter(self.charset)
        self._painting = painter.paint(self.timeline, self.now, size.width, size.height, self.look, note)
        if self.is_running and self.look is not RobotViewMode.MAP:
            self._request()
        return self._painting.rows

    def segments(self, y: int) -> list[Segment]:
        """Return one painted line, with the picture over it."""
        painted = super().segments(y)
        place = self._painting.camera
        if place is None or not place.y <= y < place.bottom or not self._fits():
            return painted
        around, picture = Strip(painted, self.size.width), self._strips[y - place.y]
        return [*around.crop(0, place.x), *picture, *around.crop(place.right)]

    def notify_style_update(self) -> None:
        """Draw the picture for the new theme."""
        super().notify_style_update()
        self._render_picture()

    def watch_charset(self) -> None:
        """Paint in other glyphs."""
        self._render_picture()

    # the camera

    def _request(self) -> None:
        """Request the picture of the cursor's moment, unless the last request is too recent."""
        shot = self._shot()
        if shot is None or shot == self._requested or self._resting or self._failure:
            return
        if self._camera is None:
            self._camera = self._open_camera(self._take, self._report_loss)
        self._requested = shot
        self._camera.want(shot)
        self._resting = True
        self.set_timer(1 / PICTURES_A_SECOND, self._request_again)

    def _request_again(self) -> None:
        self._resting = False
        self._request()

    def _shot(self) -> Shot | None:
        """The request for the picture's region; poses that look the same are equal."""
        robot, plan, place = self.timeline.robot(self.now), self.timeline.arena, self._painting.camera
        if robot is None or plan is None or not place:
            return None
        pose = (round(robot.x, 3), round(robot.y, 3), round(robot.yaw, 3))
        return Shot(plan.walls, plan.sphere, *pose, place.width, 2 * place.height)

    def _take(self, picture: Picture) -> None:
        """Pass a picture from the camera's thread to the screen's."""
        self.post_message(self.PictureTaken(picture))

    def _report_loss(self, why: str) -> None:
        self.post_message(self.CameraLost(why))

    @on(PictureTaken)
    def _show_picture(self, message: PictureTaken) -> None:
        message.stop()
        before, fitted = self._strips, self._fits()
        self._picture = message.picture
        self._render_picture()
        place = self._painting.camera
        if place is None or not self._fits():
            return
        lines = [y for y, strip in enumerate(self._strips) if not fitted or strip != before[y]]
        if lines:
            self.refresh(*(Region(place.x, place.y + y, place.width, 1) for y in lines))

    @on(CameraLost)
    async def _show_why(self, message: CameraLost) -> None:
        message.stop()
        self._failure = message.why
        self._picture = None
        self._requested = None
        await self._close_camera()
        self.changed()

    async def on_unmount(self) -> None:
        """Close the camera, however the screen is left."""
        await self._close_camera()

    async def _close_camera(self) -> None:
        camera, self._camera = self._camera, None
        if camera is not None:
            await asyncio.to_thread(camera.stop)

    def _fits(self) -> bool:
        """Whether there is a picture of the size of its region."""
        place, picture = self._painting.camera, self._picture
        if place is None or picture is None:
            return False
        return (picture.width, picture.height) == (place.width, 2 * place.height)

    def _render_picture(self) -> None:
        """Render the picture as strips in the region's size."""
        if self._picture is None:
            self._strips = ()
        elif self.charset is Charset.ASCII or self.app.no_color:
            self._strips = ramp(self._picture, self.app.current_theme.dark, self.rich_style)
        else:
            self._strips = half_blocks(self._picture)


def scene_of(
    lesson: Lesson, timeline: Timeline, charset: Charset
) -> Callable[[Nanoseconds, int, int], Sequence[Sequence[TextRun]]]:
    """Return what paints a lesson's figures, or else its robot, at a moment in a width and a height."""
    if lesson.scene:
        return lambda now, width, height: paint_scene(lesson.scene, timeline, now, width, height, charset)
    return lambda now, width, height: RobotPainter(charset).paint(timeline, now, width, height).rows
