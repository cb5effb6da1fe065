"""Paints the robot's world from above, as a timeline knows it, and the robot's figures below."""

import math
from collections.abc import Sequence

import numpy as np

from cbtui.theme import GLYPHS, TRAIL_STEPS, Charset, Ink, Role, Run
from cbtui.widgets.arena_figures import figures
from cbtui.widgets.arena_view import View, near, whole
from cbtui.widgets.cells import Row
from cbtui.widgets.dots import Dots, Floats
from cbtui.widgets.durations import duration
from sim.trace.events import ArenaShown, RobotMoved, Scanned
from sim.trace.model import Nanoseconds, Window
from sim.trace.timeline import Timeline

_BLANK, _WALL, _TRAIL, _SEEN, _TRUE, _SPHERE, _ROBOT = 0, 1, 2, 6, 7, 8, 9
_INKS = (
    Ink(Role.TEXT),
    Ink(Role.WALL),
    *(Ink(Role.TRAIL, age) for age in range(TRAIL_STEPS)),
    Ink(Role.SEEN_SCAN),
    Ink(Role.TRUE_SCAN),
    Ink(Role.SPHERE),
    Ink(Role.ROBOT),
)
_SIGNS = " #,,,,x.O@"
_ARROWS = {Charset.ASCII: ">/^\\</v\\"}
_ARROWS_ROUND = "▶◥▲◤◀◣▼◢"
_SAMPLES = {Charset.BRAILLE: ("⣿", "⢕"), Charset.BLOCK: ("█", "▚"), Charset.ASCII: (".", "x")}

_TRAIL_LASTS: Nanoseconds = 60_000_000_000
_TRAIL_POINTS = 300
_STALE: Nanoseconds = 500_000_000
_BOTH_FROM = 40

FAINT = Ink(Role.FAINT)
PLAIN = Ink(Role.TEXT)
WARN = Ink(Role.WARN)


class ArenaPainter:
    """Paints the arena at a moment: walls, sphere, robot, its trail, the true scan and the one the node saw.

    The scan that the node saw last is drawn as the node believes it: from where the robot is *now*. While it
    is fresh it lies under the true one; the older it is, the further the two come apart.
    """

    def __init__(self, charset: Charset = Charset.BRAILLE) -> None:
        self.charset = charset

    def text(self, timeline: Timeline, now: Nanoseconds, width: int, height: int) -> str:
        """Return the picture of ``paint`` as plain text."""
        rows = self.paint(timeline, now, width, height)
        return "\n".join("".join(run.text for run in row) for row in rows)

    def paint(self, timeline: Timeline, now: Nanoseconds, width: int, height: int) -> list[list[Run]]:
        """Paint ``height`` rows of ``width`` columns: legend, map, figures."""
        robot, plan = timeline.robot(now), timeline.arena
        if robot is None or plan is None:
            return self._nothing(width, height)
        below = figures(robot, timeline.command(now), width, self.charset)
        room = height - len(below) - 1
        if room < 3 or width < 12:
            return [row.runs() for row in below[:height]]
        scene = _Scene(plan, timeline, now, robot)
        narrow = width < _BOTH_FROM
        views = (near(plan, robot),) if narrow else (near(plan, robot), whole(plan))
        widths = (width,) if narrow else (width // 2, width - width // 2 - 1)
        scales = [
            View.of(extent, cells, room, self.charset) for extent, cells in zip(views, widths, strict=True)
        ]
        pictures = [scene.picture(view, self.charset) for view in scales]
        maps = [self._beside([picture[line] for picture in pictures]) for line in range(room)]
        return [self._legend(scene, scales[0], width).runs(), *maps, *(row.runs() for row in below)]

    def _nothing(self, width: int, height: int) -> list[list[Run]]:
        rows = [Row(width, self.charset) for _ in range(height)]
        if rows:
            rows[height // 2].write(1, "no robot in this run", FAINT)
        return [row.runs() for row in rows]

    def _beside(self, rows: Sequence[Row]) -> list[Run]:
        first, *others = (row.runs() for row in rows)
        frame = Run(GLYPHS[self.charset].frame, FAINT)
        return first + [run for other in others for run in (frame, *other)]

    def _legend(self, scene: "_Scene", view: View, width: int) -> Row:
        true, seen = _SAMPLES[self.charset]
        row = Row(width, self.charset)
        age = scene.seen_age
        stale = age is not None and age > _STALE
        words = "node saw none" if age is None else f"node saw {duration(age)} ago"
        pieces = [
            (f"{view.metres_per_dot * 100:.0f} cm/dot  ", FAINT),
            (true, Ink(Role.TRUE_SCAN)),
            (" true scan  " if width >= _BOTH_FROM else " true  ", PLAIN),
            (seen, Ink(Role.SEEN_SCAN)),
            (f" {words}", WARN if stale else PLAIN),
        ]
        if sum(len(text) for text, _ in pieces) > width:
            del pieces[0]
        at = 0
        for text, ink in pieces:
            row.write(at, text, ink)
            at += len(text)
        return row


class _Scene:
    """All that is to be seen at one moment."""

    def __init__(self, plan: ArenaShown, timeline: Timeline, now: Nanoseconds, robot: RobotMoved) -> None:
        self._plan = plan
        self._robot = robot
        self._true = timeline.scan(now)
        self._seen = timeline.scan_seen(now)
        self.seen_age = None if self._seen is None else now - self._seen.t
        trail = timeline.trail(Window(max(0, now - _TRAIL_LASTS), now + 1))
        step = max(1, len(trail) // _TRAIL_POINTS)
        self._trail = [trail[place] for place in range(0, len(trail), step)]

    def picture(self, view: View, charset: Charset) -> list[Row]:
        """Draw everything as one view shows it."""
        dots = Dots(view.columns, view.lines, charset)
        for x0, y0, x1, y1 in self._plan.walls:
            dots.line(view.dot(x0, y0), view.dot(x1, y1), _WALL)
        self._draw_trail(dots, view)
        if self._seen is not None:
            dots.plot_sparsely(*view.dots(*self._points(self._seen, self._robot)), _SEEN)
        if self._true is not None:
            dots.plot(*view.dots(*self._points(self._true, self._robot)), _TRUE)
        x, y, radius = self._plan.sphere
        dots.plot(*view.dots(*_disc(x, y, radius, view.metres_per_dot / 2)), _SPHERE)
        self._draw_robot(dots, view)
        rows = dots.rows(_INKS, _SIGNS)
        column, line = view.cell(self._robot.x, self._robot.y)
        if not view.shows_size(self._plan.robot_radius) and 0 <= line < len(rows):
            rows[line].put(column, _arrow(self._robot.yaw, charset), _INKS[_ROBOT])
        return rows

    def _draw_trail(self, dots: Dots, view: View) -> None:
        parts = np.array_split(
            np.array([(moved.x, moved.y) for moved in self._trail]).reshape(-1, 2), TRAIL_STEPS
        )
        for age, part in enumerate(parts):
            dots.plot(*view.dots(part[:, 0], part[:, 1]), _TRAIL + age)

    def _draw_robot(self, dots: Dots, view: View) -> None:
        robot, radius = self._robot, self._plan.robot_radius
        if view.shows_size(radius):
            dots.plot(*view.dots(*_circle(robot.x, robot.y, radius, view.metres_per_dot / 2)), _ROBOT)
        ahead = max(2.2 * radius, 3 * view.metres_per_dot)
        tip = (robot.x + ahead * math.cos(robot.yaw), robot.y + ahead * math.sin(robot.yaw))
        dots.line(view.dot(robot.x, robot.y), view.dot(*tip), _ROBOT)

    def _points(self, scan: Scanned, robot: RobotMoved) -> tuple[Floats, Floats]:
        """Return where a scan's beams end, in metres, taken from where the robot stands."""
        ranges = np.frombuffer(scan.ranges, dtype="<u2") / 1000.0
        angles = robot.yaw - math.pi + np.arange(len(ranges)) * (2 * math.pi / max(1, len(ranges)))
        hit = ranges > 0
        return robot.x + ranges[hit] * np.cos(angles[hit]), robot.y + ranges[hit] * np.sin(angles[hit])


def _circle(x: float, y: float, radius: float, step: float) -> tuple[Floats, Floats]:
    angles = np.arange(0, 2 * math.pi, min(1.0, step / radius))
    return x + radius * np.cos(angles), y + radius * np.sin(angles)


def _disc(x: float, y: float, radius: float, step: float) -> tuple[Floats, Floats]:
    steps = np.arange(-radius, radius + step, step)
    across, along = np.meshgrid(steps, steps)
    inside = across**2 + along**2 <= radius**2
    return x + across[inside], y + along[inside]


def _arrow(yaw: float, charset: Charset) -> str:
    eighth = round(yaw / (math.pi / 4)) % 8
    return _ARROWS.get(charset, _ARROWS_ROUND)[eighth]
