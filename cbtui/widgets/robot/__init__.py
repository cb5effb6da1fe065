"""The robot pane."""

from cbtui.widgets.robot.places import Look
from cbtui.widgets.robot.view import RobotView

__all__ = ["Look", "RobotView"]
