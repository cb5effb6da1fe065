"""Values of options as people write them; what cannot be one raises argparse's ``ArgumentTypeError``."""

import argparse
import math
from typing import Any

_MAX_THREADS = 64


def _number(text: str, what: str) -> float:
    try:
        number = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number; give {what}") from None
    if not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"{text!r} is not a finite number; give {what}")
    return number


def duration(text: str) -> float:
    """Read how long something lasts, in seconds."""
    seconds = _number(text, "seconds, such as 60")
    if seconds <= 0:
        raise argparse.ArgumentTypeError(f"a run cannot last {text} seconds; give more than 0")
    return seconds


def moment(text: str) -> float:
    """Read a time since a run began, in seconds."""
    seconds = _number(text, "seconds, such as 2.55")
    if seconds < 0:
        raise argparse.ArgumentTypeError(f"{text} s is before the run begins; give 0 or more")
    return seconds


def threads(text: str) -> int:
    """Read a number of threads of an executor."""
    try:
        number = int(text)
    except ValueError:
        sentence = f"{text!r} is not a whole number; give 1 to {_MAX_THREADS}"
        raise argparse.ArgumentTypeError(sentence) from None
    if not 1 <= number <= _MAX_THREADS:
        raise argparse.ArgumentTypeError(
            f"an executor cannot have {number} threads here; give 1 to {_MAX_THREADS}"
        )
    return number


def speed(text: str) -> float:
    """Read how many seconds of a run pass per real second; infinite for ``max``."""
    if text == "max":
        return math.inf
    factor = _number(text, "a factor such as 2, or max")
    if factor <= 0:
        raise argparse.ArgumentTypeError(f"time cannot pass {text} times as fast; give more than 0, or max")
    return factor


class TimedLine(argparse.Action):
    """Takes a moment in seconds and a ``ros2`` line."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        """Add the pair to those given before."""
        text, line = values
        try:
            pair = (moment(text), line)
        except argparse.ArgumentTypeError as error:
            raise argparse.ArgumentError(self, str(error)) from None
        setattr(namespace, self.dest, [*getattr(namespace, self.dest), pair])
