"""The log pane: what the program wrote, the lines that a filter lets through, and where it is typed."""

from cbtui.widgets.log.filter import Filter, FilterError, filter_of
from cbtui.widgets.log.line import line_of
from cbtui.widgets.log.lines import LogLines
from cbtui.widgets.log.pane import LogFilter, LogView

__all__ = ["Filter", "FilterError", "LogFilter", "LogLines", "LogView", "filter_of", "line_of"]
