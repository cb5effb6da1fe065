"""Values of options as people write them; what cannot be one raises argparse's ``ArgumentTypeError``."""

import argparse
import math
from typing import TYPE_CHECKING, Any

from cbtui.runs.setup.quantities import PERIOD, SENSOR_RATE, BadQuantityError, Quantity
from cbtui.text.output import is_text
from sim.units import nearest_ns

if TYPE_CHECKING:
    from cbtui.runs.setup.changes import Place

_MAX_THREADS = 64
_LONGEST = 1e9
"""Seconds; over thirty years. A run's clock, in whole nanoseconds, holds some ten times that."""
_SLOWEST = 0.001
_MAX_ORDERS = 100_000
"""All of them are kept, as is what came of each."""
_MAX_SEED = 10**18
"""As many as can be handed to an engine, with those after it that are tried too."""


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
    return _bounded(seconds, text)


def moment(text: str) -> float:
    """Read a time since a run began, in seconds."""
    seconds = _number(text, "seconds, such as 2.55")
    if seconds < 0:
        raise argparse.ArgumentTypeError(f"{text} s is before the run begins; give 0 or more")
    return _bounded(seconds, text)


def _bounded(seconds: float, text: str) -> float:
    if seconds > _LONGEST:
        raise argparse.ArgumentTypeError(f"no run lasts {text} s; give {_LONGEST:.0f} or less")
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


def count(text: str) -> int:
    """Read how many orders of threads are wanted."""
    number = whole(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} are too few; give 1 or more")
    if number > _MAX_ORDERS:
        raise argparse.ArgumentTypeError(f"{text} are too many at once; give {_MAX_ORDERS} or fewer")
    return number


def seed(text: str) -> int:
    """Read which order of threads is meant."""
    number = whole(text)
    if number < 0:
        raise argparse.ArgumentTypeError(f"a seed cannot be {text}; give 0, the usual order, or more")
    if number > _MAX_SEED:
        raise argparse.ArgumentTypeError(f"there is no seed {text}; give {_MAX_SEED} or less")
    return number


def whole(text: str) -> int:
    """Read a whole number."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number; give one such as 17") from None


def speed(text: str) -> float:
    """Read how many seconds of a run pass per real second; infinite for ``max``."""
    if text == "max":
        return math.inf
    factor = _number(text, "a factor such as 2, or max")
    if factor < _SLOWEST:
        raise argparse.ArgumentTypeError(
            f"time cannot pass {text} times as fast; give {_SLOWEST:g} or more, or max"
        )
    return factor


def group_change(text: str) -> "tuple[Place, str]":
    """Read which callback gets which group, such as ``odom_callback=own``."""
    from cbtui.runs.setup.changes import WISHES  # with what a set-up is made of

    place, group = _place_and_value(text, "a group, such as odom_callback=own")
    if group not in WISHES:
        sentence = f"{group!r} is no group; give {', '.join(WISHES[:-1])} or {WISHES[-1]}"
        raise argparse.ArgumentTypeError(sentence)
    return place, group


def period_change(text: str) -> "tuple[Place, int]":
    """Read which timer's callback gets which period, such as ``timer_callback=0.2``; nanoseconds."""
    place, seconds = _place_and_value(text, "seconds, such as timer_callback=0.2")
    return place, nearest_ns(_quantity(PERIOD, seconds))


def sensor_rate(text: str) -> float:
    """Read how often a second sensors measure."""
    return _quantity(SENSOR_RATE, text)


def _text(word: str) -> str:
    if not is_text(word):
        raise argparse.ArgumentTypeError(f"{word!r} is no text in UTF-8")
    return word


def _place_and_value(text: str, what: str) -> "tuple[Place, str]":
    """Take ``NODE:CALLBACK=VALUE`` apart; without a node, any node is meant."""
    name, equals, value = text.rpartition("=")
    node, colon, callback = name.rpartition(":")
    if not (equals and callback and value and is_text(text)) or (colon and not node):
        raise argparse.ArgumentTypeError(f"{text!r} is not a callback and its value; give {what}")
    return ("/" + node.lstrip("/") if node else "", callback), value


def _quantity(quantity: Quantity, text: str) -> float:
    try:
        return quantity.read(text)
    except BadQuantityError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _keys(word: str) -> str:
    """Read what is typed, with ``\\n`` for enter and ``\\x03`` for ctrl+c, as Python writes them."""
    try:
        return _text(word).encode("latin-1", "backslashreplace").decode("unicode_escape")
    except UnicodeDecodeError:
        raise argparse.ArgumentTypeError(
            rf"{word!r} ends in the middle of a sign; write a backslash as \\"
        ) from None


class TimedLine(argparse.Action):
    """Takes a moment in seconds and a ``ros2`` line."""

    read = staticmethod(_text)

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
            pair = (moment(text), self.read(line))
        except argparse.ArgumentTypeError as error:
            raise argparse.ArgumentError(self, str(error)) from None
        setattr(namespace, self.dest, [*getattr(namespace, self.dest), pair])


class TimedKeys(TimedLine):
    """Takes a moment in seconds and text to be typed."""

    read = staticmethod(_keys)
