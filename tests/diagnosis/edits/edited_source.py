"""A learner's source as text, and the lines that an edit of it changes."""

from collections.abc import Callable
from textwrap import dedent, indent

from sim.diagnosis.edits.code_edit import CodeEdit, diff

MARK = "# here"


def node(methods: str, imports: str = "import rclpy") -> str:
    """Return the source of a class with methods."""
    return f"{imports}\n\n\nclass Robot(Node):\n{indent(dedent(methods).strip(), '    ')}\n"


def edited(text: str, change: Callable[..., None], *more: object) -> str | None:
    """Return a text with an edit at the marked line; None if it is refused."""
    line = next(number for number, each in enumerate(text.splitlines(), 1) if MARK in each)
    return CodeEdit("node.py", "", change, (line, *more)).applied(text)


def changed(text: str, change: Callable[..., None], *more: object) -> list[str] | None:
    """Return the lines that an edit at the marked line takes away and brings; None if it is refused."""
    result = edited(text, change, *more)
    if result is None:
        return None
    return [each for each in diff("node.py", text, result).splitlines()[2:] if each[0] in "+-"]
