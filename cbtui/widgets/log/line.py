"""A line of the log as ROS prints it, safe to send to a terminal."""

from cbtui.theme import Charset
from cbtui.widgets.cells import visible
from sim.trace.events import Logged, Printed


def line_of(event: Logged | Printed) -> str:
    """Return a line as ROS prints it, with seconds of run time as its stamp; safe to send to a terminal."""
    if isinstance(event, Printed):
        return visible(event.text, Charset.BRAILLE)
    head = f"[{event.severity}] [{event.t / 1e9:.3f}] [{event.logger}]: "
    return visible(head + event.text, Charset.BRAILLE)
