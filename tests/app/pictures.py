"""What is on a console's screen, as text."""

from textual.app import App


def lines_of(app: App[None]) -> list[str]:
    """Return the lines that the terminal would show."""
    return ["".join(segment.text for segment in strip) for strip in app.screen._compositor.render_strips()]


def text_of(app: App[None]) -> str:
    """Return the whole screen as text."""
    return "\n".join(lines_of(app))
