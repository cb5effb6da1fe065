"""The pane of an exercise: its task, and its checks with their results."""

from cbtui.widgets.checks.sheet import CheckRow, ChecksSheet, CheckStatus
from cbtui.widgets.checks.widget import ChecksView

__all__ = ["ChecksView", "CheckRow", "ChecksSheet", "CheckStatus"]
