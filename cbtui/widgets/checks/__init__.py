"""The pane of an exercise: its checks with what came of them, and what is asked."""

from cbtui.widgets.checks.sheet import Row, Sheet, Standing
from cbtui.widgets.checks.widget import ChecksView

__all__ = ["ChecksView", "Row", "Sheet", "Standing"]
