"""What an exception says, whatever it does when it is asked."""


def error_line(error: BaseException) -> str:
    """Return an exception as the trace has it: ``ValueError: no scan``."""
    return f"{type(error).__name__}: {error_text(error)}"


def error_text(error: BaseException) -> str:
    """Return an exception's text; for one that cannot give it, what Python prints in its place."""
    try:
        return str(error)
    except Exception:  # noqa: BLE001 -- programs make exceptions of their own, and mistakes in them
        return "<exception str() failed>"
