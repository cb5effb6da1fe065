"""The robot pane."""

from cbtui.widgets.robot.pane_regions import RobotViewMode
from cbtui.widgets.robot.view import RobotView, scene_of

__all__ = ["RobotViewMode", "RobotView", "scene_of"]
