"""A line of the log as ROS prints it, safe to send to a terminal."""

from rich.cells import cell_len

from cbtui.looks.theme import Charset
from cbtui.text.cells import visible
from sim.trace.events import Logged, Printed


def line_of(event: Logged | Printed) -> str:
    """Return a line as ROS prints it, with seconds of run time as its stamp; safe to send to a terminal."""
    return visible(_text_of(event), Charset.BRAILLE)


def width_of(event: Logged | Printed) -> int:
    """Return the columns of a line; plain text has one for each character, however that is displayed."""
    text = _text_of(event)
    return len(text) if text.isascii() else cell_len(visible(text, Charset.BRAILLE))


def _text_of(event: Logged | Printed) -> str:
    if isinstance(event, Printed):
        return event.text
    return f"[{event.severity}] [{event.t / 1e9:.3f}] [{event.logger}]: {event.text}"
