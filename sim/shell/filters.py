"""``--filter``: a Python expression that selects messages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from sim.shell.parser import LineParser
from sim.shell.session import CommandFailed


def add_filter_option(parser: LineParser, purpose: str) -> None:
    """Add the option."""
    parser.add_argument(
        "--filter",
        metavar="PY_EXPR",
        help=f"Python expression to filter messages that are to be {purpose}ed: a function of m, the message",
    )


def compiled_filter(expression: str | None) -> Callable[[Any], object] | None:
    """Return the function of an expression, None without one; raise CommandFailed if it is not valid."""
    if expression is None:
        return None
    try:
        code = compile(expression, "<filter>", "eval")
    except SyntaxError as error:
        raise CommandFailed(f"Invalid filter expression '{expression}': {error.msg}") from None

    def decide(message: Any) -> object:
        try:
            # The run's programs already execute Python of the same author in this process.
            return eval(code, {"m": message})
        except Exception as error:
            raise CommandFailed(
                f"The filter '{expression}' raised {type(error).__name__}: {error}"
            ) from error

    return decide
