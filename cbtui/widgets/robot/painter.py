"""Paints the robot pane: a legend, the robot's world from above, room for a picture, and figures."""

from collections.abc import Sequence
from textwrap import wrap
from typing import NamedTuple

from textual.geometry import Region

from cbtui.looks.theme import GLYPHS, Charset, Ink, Role, TextRun
from cbtui.text.cells import CellRow
from cbtui.widgets.robot.extents import MapView, full_arena, robot_surroundings
from cbtui.widgets.robot.figures import figures
from cbtui.widgets.robot.pane_regions import PaneRegions, RobotViewMode, arrange
from cbtui.widgets.robot.scene import RobotScene
from sim.quantities.durations import duration
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_SAMPLES = {Charset.BRAILLE: ("⣿", "⢕"), Charset.BLOCK: ("█", "▚"), Charset.ASCII: (".", "x")}
_EDGE = {Charset.BRAILLE: "█", Charset.BLOCK: "█", Charset.ASCII: "!"}

_STALE: Nanoseconds = 500_000_000
_ROOMY_FROM = 40

FAINT = Ink(Role.FAINT)
PLAIN = Ink(Role.TEXT)
WARN = Ink(Role.WARN)

_STARTING = "no robot yet: the engine starts the program"


class RobotPainting(NamedTuple):
    """Painted rows, and the region of the camera's picture in them, if any."""

    rows: Sequence[Sequence[TextRun]]
    camera: Region | None = None


class RobotPainter:
    """Paints walls, sphere, robot, its trail, the true scan and the one that the node saw, at a moment.

    The scan that the node saw last is drawn from the robot's *current* position, as the node takes it. A
    fresh one lies under the true scan; an old one lies apart from it.

    When the robot hits something, rays flash around it and the picture gets coloured edges.
    """

    def __init__(self, charset: Charset = Charset.BRAILLE) -> None:
        self.charset = charset

    def paint(
        self,
        timeline: Timeline,
        now: Nanoseconds,
        width: int,
        height: int,
        look: RobotViewMode = RobotViewMode.MAP,
        note: str = "",
    ) -> RobotPainting:
        """Paint ``height`` rows of ``width`` columns; ``note`` replaces a picture that has not come yet."""
        robot, plan = timeline.robot(now), timeline.arena
        if robot is None or plan is None:
            is_there_none = plan is None and timeline.nodes
            return self._nothing("no robot in this run" if is_there_none else _STARTING, width, height)
        below = figures(robot, timeline.command(now), width, self.charset)
        places = arrange(Region(0, 1, width, max(0, height - len(below) - 1)), look)
        if places == PaneRegions():
            return RobotPainting([row.runs() for row in below[:height]])
        scene = RobotScene(plan, timeline, now, robot)
        canvas = [CellRow(width, self.charset) for _ in range(height - len(below))]
        views = self._draw_maps(canvas, places, scene)
        self._draw_lines(canvas, places.lines)
        self._legend(canvas[0], scene, views)
        picture = None
        if places.camera is not None:
            picture = places.camera.shrink((0, 1, 0, 1))
            self._write_note(canvas, picture, note)
            if scene.hit_age is not None:
                self._draw_edges(canvas, picture)
        return RobotPainting([row.runs() for row in (*canvas, *below)], picture)

    def _nothing(self, why: str, width: int, height: int) -> RobotPainting:
        rows = [CellRow(width, self.charset) for _ in range(height)]
        if rows:
            rows[height // 2].write(1, why, FAINT)
        return RobotPainting([row.runs() for row in rows])

    def _draw_maps(self, canvas: Sequence[CellRow], places: PaneRegions, scene: RobotScene) -> list[MapView]:
        """Draw the maps that have a region, and return their views."""
        extents = (
            (places.near, robot_surroundings(scene.plan, scene.robot)),
            (places.room, full_arena(scene.plan)),
        )
        views = []
        for place, extent in extents:
            if place is None:
                continue
            view = MapView.of(extent, place.width, place.height, self.charset)
            views.append(view)
            for row, line in zip(canvas[place.y :], scene.picture(view, self.charset), strict=False):
                row.cells[place.x : place.right] = line.cells
                row.inks[place.x : place.right] = line.inks
        return views

    def _draw_lines(self, canvas: Sequence[CellRow], lines: Sequence[Region]) -> None:
        glyphs = GLYPHS[self.charset]
        for line in lines:
            glyph = glyphs.frame if line.width == 1 else glyphs.line
            for row in canvas[line.y : line.bottom]:
                row.fill(line.x, line.right, glyph, FAINT)

    def _write_note(self, canvas: Sequence[CellRow], place: Region, note: str) -> None:
        words = wrap(note, max(1, place.width - 2))[: place.height]
        for row, text in zip(canvas[place.y + (place.height - len(words)) // 2 :], words, strict=False):
            row.write(place.x + 1, text, FAINT)

    def _draw_edges(self, canvas: Sequence[CellRow], picture: Region) -> None:
        for row in canvas[picture.y : picture.bottom]:
            for column in (picture.x - 1, picture.right):
                row.put(column, _EDGE[self.charset], WARN)

    def _legend(self, row: CellRow, scene: RobotScene, views: Sequence[MapView]) -> None:
        width = len(row.cells)
        pieces = [*self._meaning_of_dots(views[0], width)] if views else [("from behind  ", FAINT)]
        age = scene.seen_age
        stale = age is not None and age > _STALE
        words = "node saw none" if age is None else f"node saw {duration(age)} ago"
        pieces.append((words, WARN if stale else PLAIN))
        if sum(len(text) for text, _ in pieces) > width:
            del pieces[0]
        at = 0
        for text, ink in pieces:
            row.write(at, text, ink)
            at += len(text)

    def _meaning_of_dots(self, view: MapView, width: int) -> Sequence[tuple[str, Ink]]:
        true, seen = _SAMPLES[self.charset]
        return (
            (f"{view.metres_per_dot * 100:.0f} cm/dot  ", FAINT),
            (true, Ink(Role.TRUE_SCAN)),
            (" true scan  " if width >= _ROOMY_FROM else " true  ", PLAIN),
            (f"{seen} ", Ink(Role.SEEN_SCAN)),
        )
