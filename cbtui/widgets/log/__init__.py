"""The log pane: the program's log and output, and a filter."""

from cbtui.widgets.log.filter import Filter, FilterError, filter_of
from cbtui.widgets.log.line import line_of
from cbtui.widgets.log.lines import LogLines
from cbtui.widgets.log.pane import LogFilter, LogView

__all__ = ["Filter", "FilterError", "LogFilter", "LogLines", "LogView", "filter_of", "line_of"]
