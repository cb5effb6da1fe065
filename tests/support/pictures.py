"""What is on a console's screen, as text."""

from textual.app import App
from textual.widget import Widget


def lines_of(app: App[None]) -> list[str]:
    """Return the lines that the terminal would show."""
    return ["".join(segment.text for segment in strip) for strip in app.screen._compositor.render_strips()]


def text_of(app: App[None]) -> str:
    """Return the whole screen as text."""
    return "\n".join(lines_of(app))


def picture_of(app: App[None], widget: Widget) -> str:
    """Return what is to be seen of a widget, with its frame, and without blanks at the ends of its lines."""
    left, top, width, height = widget.region
    strips = app.screen._compositor.render_strips()[top : top + height]
    return "".join(f"{strip.crop(left, left + width).text.rstrip()}\n" for strip in strips)
