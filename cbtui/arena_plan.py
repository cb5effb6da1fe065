"""The lessons' arena as the map draws it."""

from cbtui.widgets.arena_map import Plan
from sim.robot.arena import ARENA, ROBOT_RADIUS


def arena_plan() -> Plan:
    """Return what stands where."""
    return Plan(
        walls=tuple((wall.x0, wall.y0, wall.x1, wall.y1) for wall in ARENA.walls),
        sphere=(ARENA.sphere.x, ARENA.sphere.y, ARENA.sphere.radius),
        robot_radius=ROBOT_RADIUS,
    )
