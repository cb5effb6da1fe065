"""The node's source, with what runs and waits marked in it."""

from cbtui.widgets.code.following import Step
from cbtui.widgets.code.marks import StandingThread
from cbtui.widgets.code.widget import CodeView

__all__ = ["CodeView", "StandingThread", "Step"]
