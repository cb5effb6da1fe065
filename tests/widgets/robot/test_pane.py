"""The robot pane as text: maps, where the picture goes, and what shows that the robot ran into something."""

from collections.abc import Iterator
from functools import cache

import msgspec
import pytest
from textual.geometry import Region

from cbtui.looks.theme import Charset, Role
from cbtui.widgets.robot import RobotViewMode
from cbtui.widgets.robot.painter import RobotPainter
from cbtui.widgets.robot.pane_regions import PaneRegions, arrange
from cbtui.widgets.robot.scene import since_hit
from sim.trace.events import AnyEvent, RobotMoved
from sim.trace.timeline import Timeline
from tests.support.runs import ns, shared_group_run
from tests.widgets.pictures import drawn, plain, shared_group


@cache
def touching(start: float, end: float) -> Timeline:
    """The run with a robot that touches something for a while."""

    def events() -> Iterator[AnyEvent]:
        for event in shared_group_run().events:
            hit = isinstance(event, RobotMoved) and ns(start) <= event.t < ns(end)
            yield msgspec.structs.replace(event, touching=True) if hit else event

    timeline = Timeline()
    timeline.extend(events())
    return timeline


MAPS = r"""
    |12 cm/dot  . true scan  x node saw 5.3 s ago|
    |1 m +        +       +|#....................|
    |                      |#. x             x  .|
    |                      |x.                x .|
    |                      |#.                 x.|
    |          .OOOO       |#.         .        x|
    |0 m ',,\  .OOOO      +|.x        \@        #|
    |        @ x           |. x         @      .#|
    |                      |.  x               .#|
    |                      |.   x             x.#|
    |    0 m      1 m     +|....................#|
    |pose  0.28  0.00 m  -60 deg   front  7.49 m |
    |told  0.00 m/s -0.20 rad/s   motors on      |
    |real  0.00 m/s -0.20 rad/s   touching no    |
"""
BOTH = r"""
    |12 cm/dot  . true scan  x node saw 5.3 s ago|
    |1 m +        +       +|                     |
    |                      |                     |
    |                      |                     |
    |                      |                     |
    |          .OOOO       |  The camera         |
    |0 m ',,\  .OOOO      +|  starts.            |
    |        @ x           |                     |
    |                      |                     |
    |                      |                     |
    |    0 m      1 m     +|                     |
    |pose  0.28  0.00 m  -60 deg   front  7.49 m |
    |told  0.00 m/s -0.20 rad/s   motors on      |
    |real  0.00 m/s -0.20 rad/s   touching no    |
"""
HIT_BOTH = r"""
    |. true scan  x node saw 245 ms ago          |
    |1 m +        +       +|!                   !|
    |                      |!                   !|
    |     *  *             |!                   !|
    |      * *             |!                   !|
    |  ***    ***OOO       |! The camera        !|
    |  ***:;>!***OOO      +|! starts.           !|
    |      * *             |!                   !|
    |     *  *             |!                   !|
    |                      |!                   !|
    |    0 m      1 m     +|!                   !|
    |pose  0.28  0.00 m   -2 deg   front  0.47 m |
    |told  0.00 m/s -0.20 rad/s   motors on      |
    |real  0.00 m/s -0.20 rad/s   touching YES   |
"""


def text(
    timeline: Timeline, now: float, width: int, height: int, look: RobotViewMode = RobotViewMode.MAP
) -> str:
    return plain(
        RobotPainter(Charset.ASCII).paint(timeline, ns(now), width, height, look, "The camera starts.").rows
    )


def test_surroundings_and_room_stand_side_by_side() -> None:
    assert text(shared_group(), 9.25, 44, 14) == drawn(MAPS)


def test_map_and_picture_stand_side_by_side() -> None:
    assert text(shared_group(), 9.25, 44, 14, RobotViewMode.BOTH) == drawn(BOTH)


def test_a_hit_shows_as_rays_a_changed_robot_and_edges_of_the_picture() -> None:
    assert text(touching(4.0, 6.0), 4.2, 44, 14, RobotViewMode.BOTH) == drawn(HIT_BOTH)


def test_only_the_hit_flashes_and_not_the_touching_that_follows() -> None:
    ages = {now: since_hit(touching(4.0, 6.0), ns(now)) for now in (3.9, 4.0, 4.2, 4.55, 4.7, 5.9, 6.1)}
    told_ages = [ages[now] for now in (4.0, 4.2, 4.55)]
    assert told_ages == [ns(0), ns(0.2), ns(0.55)]
    assert {ages[now] for now in (3.9, 4.7, 5.9, 6.1)} == {None}


def test_a_robot_that_touches_is_drawn_as_a_warning_while_it_does() -> None:
    def warned(now: float) -> bool:
        rows = RobotPainter().paint(touching(4.0, 6.0), ns(now), 44, 14).rows
        return any(run.ink.role is Role.WARN and run.text.strip() for row in rows[1:11] for run in row)

    assert [warned(now) for now in (3.9, 4.2, 5.5, 6.5)] == [False, True, True, False]


def test_the_rays_turn_with_the_runs_time_and_stand_still_without_it() -> None:
    assert text(touching(4.0, 6.0), 4.05, 80, 20) == text(touching(4.0, 6.0), 4.05, 80, 20)
    assert text(touching(4.0, 6.0), 4.05, 80, 20).count("*") > 8
    assert text(touching(4.0, 6.0), 4.05, 80, 20) != text(touching(4.0, 6.0), 4.2, 80, 20)


def test_where_nothing_fits_the_figures_stand_alone() -> None:
    assert arrange(Region(0, 1, 80, 2), RobotViewMode.BOTH) == PaneRegions()
    assert "motors" in text(shared_group(), 9.25, 80, 4)


@pytest.mark.parametrize("look", RobotViewMode)
@pytest.mark.parametrize(("width", "height"), [(12, 3), (44, 10), (44, 40), (78, 6), (138, 27), (250, 60)])
def test_what_is_shown_lies_in_the_pane_and_nothing_lies_on_another(
    width: int, height: int, look: RobotViewMode
) -> None:
    body = Region(0, 1, width, height)
    places = arrange(body, look)
    shown = [each for each in (*places[:3], *places.lines) if isinstance(each, Region)]
    assert sum(each.area for each in shown) == body.area
    assert all(body.contains_region(each) for each in shown)
    assert not any(one.overlaps(other) for one in shown for other in shown if one is not other)


def test_a_narrow_pane_has_map_and_picture_above_each_other() -> None:
    places = arrange(Region(0, 1, 44, 40), RobotViewMode.BOTH)
    assert places.near is not None
    assert places.camera is not None
    assert places.near.width == places.camera.width == 44


def test_the_looks_go_round() -> None:
    assert [look.following for look in (RobotViewMode.MAP, RobotViewMode.CAMERA, RobotViewMode.BOTH)] == [
        RobotViewMode.CAMERA,
        RobotViewMode.BOTH,
        RobotViewMode.MAP,
    ]
