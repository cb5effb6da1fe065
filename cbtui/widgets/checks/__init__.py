"""The pane of an exercise: its task, and its checks with their results."""

from cbtui.widgets.checks.sheet import Row, Sheet, Standing
from cbtui.widgets.checks.widget import ChecksView

__all__ = ["ChecksView", "Row", "Sheet", "Standing"]
