"""The robot's world from above: what stands where, where the robot heads, and what its node believes."""

import math
import re

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.cells import cell_len
from textual.geometry import Region

from cbtui.looks.theme import Charset, Role
from cbtui.widgets.robot import RobotViewMode
from cbtui.widgets.robot.extents import Extent, MapView, full_arena, robot_surroundings
from cbtui.widgets.robot.painter import RobotPainter
from cbtui.widgets.robot.scene import RobotScene
from sim.trace.events import ArenaShown, RobotMoved, Scanned
from sim.trace.timeline import Timeline
from tests.support.properties import examples
from tests.support.runs import Run, ns, scan_from
from tests.widgets.pictures import plain, shared_group, split_groups, told

PLAN = ArenaShown(
    0,
    walls=((-6.5, -6.5, 6.5, -6.5), (6.5, -6.5, 6.5, 6.5), (6.5, 6.5, -6.5, 6.5), (-6.5, 6.5, -6.5, -6.5)),
    sphere=(0.95, 0.0, 0.2),
    robot_radius=0.105,
)
_METRES = re.compile(r"(-?[\d.]+) m(?![\w~])")


def robot_at(x: float, y: float, yaw: float) -> RobotMoved:
    return RobotMoved(0, x, y, yaw, 1.0, 0.0, 0.0, True, False, 0.0, 0.0)


def standing(yaw: float, scan: bytes = b"") -> Timeline:
    timeline = Timeline()
    timeline.extend([PLAN, robot_at(0.0, 0.0, yaw)])
    timeline.extend([Scanned(0, 1, scan)] if scan else [])
    return timeline


def map_of(timeline: Timeline, now: float, charset: Charset = Charset.ASCII) -> str:
    """Return the map alone, 30 columns wide, so that only the surroundings are shown."""
    return "\n".join(plain(RobotPainter(charset).paint(timeline, ns(now), 30, 20).rows).splitlines()[1:-6])


def test_the_sphere_lies_ahead_and_right_on_the_map() -> None:
    lines = map_of(standing(0.0), 0.0).splitlines()
    (line,) = (line for line in lines if "@" in line)
    assert line.index("@") < line.index("O")


@pytest.mark.parametrize(
    ("degrees", "arrow"),
    [(0, "▶"), (45, "◥"), (90, "▲"), (135, "◤"), (180, "◀"), (-135, "◣"), (-90, "▼"), (-45, "◢")],
)
def test_the_arrow_points_where_the_robot_heads(degrees: int, arrow: str) -> None:
    picture = plain(RobotPainter().paint(standing(math.radians(degrees)), 0, 80, 12).rows)
    assert arrow in picture


def test_a_fresh_scan_of_the_node_lies_under_the_true_one() -> None:
    picture = RobotPainter().paint(split_groups(9.4), ns(9.4), 80, 14).rows
    roles = [run.ink.role for row in picture[1:-2] for run in row]
    assert Role.TRUE_SCAN in roles
    assert Role.SEEN_SCAN not in roles


def test_a_stale_scan_of_the_node_stands_beside_the_true_one_and_its_age_is_told() -> None:
    picture = RobotPainter().paint(shared_group(), ns(9.25), 80, 14).rows
    assert Role.SEEN_SCAN in [run.ink.role for row in picture[1:-2] for run in row]
    assert "node saw 5.3 s ago" in "".join(run.text for run in picture[0])
    assert Role.WARN in [run.ink.role for run in picture[0]]


def test_true_and_believed_scan_differ_without_colours_too() -> None:
    signs = map_of(shared_group(), 9.25)
    assert "." in signs
    assert "x" in signs


def room_of(timeline: Timeline) -> list[str]:
    """Return the map of the whole room in ASCII, which stands right of the surroundings."""
    lines = plain(RobotPainter(Charset.ASCII).paint(timeline, 0, 80, 24).rows).splitlines()[1:-2]
    return [line.split("|", 1)[1] for line in lines]


def test_a_true_scan_taken_anywhere_falls_on_walls_and_sphere() -> None:
    bare, scanned = Timeline(), Timeline()
    bare.extend([PLAN, robot_at(1.0, -2.0, 0.7)])
    scanned.extend([PLAN, robot_at(1.0, -2.0, 0.7), Scanned(0, 1, scan_from(1.0, -2.0, 0.7))])
    things = room_of(bare)
    points = [(x, y) for y, line in enumerate(room_of(scanned)) for x, sign in enumerate(line) if sign == "."]
    assert len(points) > 50
    for x, y in points:
        around = "".join(line[max(x - 1, 0) : x + 2] for line in things[max(y - 1, 0) : y + 2])
        assert "#" in around or "O" in around


def test_the_figures_tell_pose_command_velocity_range_and_motors() -> None:
    text = plain(RobotPainter().paint(shared_group(), ns(9.25), 80, 14).rows)
    for words in (
        "pose  0.28  0.00 m  -60°",
        "told  0.00 m/s -0.20 rad/s",
        "real  0.00 m/s -0.20 rad/s",
        "motors on",
    ):
        assert words in text


def test_no_figure_is_minus_zero() -> None:
    assert "pose  0.00  0.00 m    0°" in plain(RobotPainter().paint(standing(-0.002), 0, 80, 14).rows)


def test_motors_off_and_touching_are_said_in_words() -> None:
    timeline = Timeline()
    timeline.extend([PLAN, RobotMoved(0, 0.0, 0.0, 0.0, math.inf, 0.0, 0.0, False, True, 0.0, 0.0)])
    text = plain(RobotPainter().paint(timeline, 0, 80, 14).rows)
    assert "motors OFF" in text
    assert "touching YES" in text
    assert "front    free" in text


@pytest.mark.parametrize("width", [34, 40, 44, 80])
def test_the_age_of_the_nodes_scan_is_told_at_every_width(width: int) -> None:
    assert "node saw 10.2 s ago" in plain(RobotPainter().paint(shared_group(), ns(14.2), width, 16).rows)


def test_a_run_without_a_robot_says_so_and_one_that_starts_says_that() -> None:
    run = Run()
    assert "no robot yet: the engine starts" in plain(RobotPainter().paint(told(run), 0, 44, 10).rows)
    run.node("/n")
    assert "no robot in this run" in plain(RobotPainter().paint(told(run), 0, 44, 10).rows)


@settings(max_examples=examples(40), deadline=None)
@given(
    st.floats(-30, 30),
    st.floats(-30, 30),
    st.floats(-4, 4),
    st.integers(1, 120),
    st.integers(0, 40),
    st.sampled_from(Charset),
    st.sampled_from(RobotViewMode),
)
def test_the_pane_has_the_size_that_was_asked_for_wherever_the_robot_is(
    x: float, y: float, yaw: float, width: int, height: int, charset: Charset, look: RobotViewMode
) -> None:
    timeline = Timeline()
    hit = msgspec.structs.replace(robot_at(x, y, yaw), touching=True)
    timeline.extend([PLAN, hit, Scanned(0, 1, scan_from(0.0, 0.0, yaw))])
    rows, picture = RobotPainter(charset).paint(timeline, 0, width, height, look, "The camera starts.")
    texts = ["".join(run.text for run in row) for row in rows]
    assert len(texts) <= height
    assert all(cell_len(text) == width for text in texts)
    assert charset is not Charset.ASCII or all(text.isascii() for text in texts)
    assert picture is None or Region(0, 0, width, height).contains_region(picture)


@given(st.integers(4, 100), st.integers(3, 60), st.sampled_from(Charset))
def test_the_whole_extent_is_on_the_map_and_not_distorted(columns: int, lines: int, charset: Charset) -> None:
    view = MapView.of(full_arena(PLAN), columns, lines, charset)
    for x, y in ((-6.5, -6.5), (6.5, 6.5)):
        column, line = view.cell(x, y)
        assert 0 <= column < columns
        assert 0 <= line < lines
    assert view.metres_down * view.down == pytest.approx(2 * view.metres_across * view.across)


@given(st.floats(-6, 6), st.floats(-6, 6), st.integers(12, 90), st.integers(6, 30), st.sampled_from(Charset))
@settings(max_examples=examples(100))
def test_a_coordinate_on_the_map_stands_where_it_is(
    x: float, y: float, columns: int, lines: int, charset: Charset
) -> None:
    robot = robot_at(x, y, 0.0)
    timeline = Timeline()
    timeline.extend([PLAN, robot])
    view = MapView.of(robot_surroundings(PLAN, robot), columns, lines, charset)
    rows = ["".join(row.cells) for row in RobotScene(PLAN, timeline, 0, robot).picture(view, charset)]
    along_bottom = {match.start(): float(match[1]) for match in _METRES.finditer(rows[-1])}
    assert all(view.cell(metres, 0)[0] == column for column, metres in along_bottom.items())
    along_side = {
        row: float(match[1]) for row, text in enumerate(rows[:-1]) if (match := _METRES.match(text))
    }
    assert all(view.cell(0, metres)[1] == row for row, metres in along_side.items())


def test_the_surroundings_stand_still_while_the_robot_creeps() -> None:
    assert robot_surroundings(PLAN, robot_at(0.05, 0.0, 0.0)) == robot_surroundings(
        PLAN, robot_at(0.15, 0.02, 1.0)
    )


def test_far_from_the_sphere_the_map_follows_the_robot() -> None:
    around = robot_surroundings(PLAN, robot_at(-5.0, 4.0, 0.0))
    assert around.left < -5.0 < around.right < 0.0
    assert isinstance(around, Extent)
