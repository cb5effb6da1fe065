"""An exception as text, also when its own ``__str__`` fails."""

UNREADABLE = ("SyntaxError", "IndentationError", "TabError")
"""The exceptions that come before a file runs."""


def error_line(error: BaseException) -> str:
    """Return an exception as the trace has it: ``ValueError: no scan``, or ``ValueError`` without a text."""
    return ": ".join(filter(None, (type(error).__name__, error_text(error))))


def error_text(error: BaseException) -> str:
    """Return an exception's text; if ``__str__`` fails, what Python prints in its place."""
    try:
        return str(error)
    except Exception:  # noqa: BLE001 -- a program's own exceptions may have faults
        return "<exception str() failed>"
