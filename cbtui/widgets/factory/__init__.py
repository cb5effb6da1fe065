"""The factory: threads as workers, callback groups as areas with seats, queues as belts."""

from cbtui.widgets.factory.painter import FactoryPainter
from cbtui.widgets.factory.widget import FactoryView

__all__ = ["FactoryPainter", "FactoryView"]
