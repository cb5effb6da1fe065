"""Parsers of option values; an invalid value raises argparse's ``ArgumentTypeError``."""

import argparse
import math
from typing import TYPE_CHECKING, Any

from cbtui.runs.setup.quantities import PERIOD, SENSOR_RATE, BadQuantityError, Quantity
from cbtui.text.output import is_text
from sim.quantities.nanoseconds import nearest_ns

if TYPE_CHECKING:
    from cbtui.runs.setup.changes import CallbackPlace
    from sim.clock.schedule import Seed

_MAX_THREADS = 64
_LONGEST = 1e9
"""Seconds, over thirty years; a clock of 64-bit nanoseconds holds ten times that."""
_SLOWEST = 0.001
_MAX_ORDERS = 100_000
"""All seeds and their results are kept in memory."""
_MAX_SEED = 10**18
"""Leaves room in 64 bits for the seeds that ``explore`` tries after it."""


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


def distro(text: str) -> str:
    """Read a release of rclpy; returns its name with the patch."""
    from sim.releases.distros import UnknownProfileError
    from sim.releases.profile import Profile

    try:
        return str(Profile.named(text))
    except UnknownProfileError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def threads(text: str) -> int:
    """Read a number of threads of an executor."""
    number = whole_number(text, f"1 to {_MAX_THREADS}")
    if not 1 <= number <= _MAX_THREADS:
        raise argparse.ArgumentTypeError(
            f"an executor cannot have {number} threads here; give 1 to {_MAX_THREADS}"
        )
    return number


def count(text: str) -> int:
    """Read a number of schedules."""
    number = whole_number(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} are too few; give 1 or more")
    if number > _MAX_ORDERS:
        raise argparse.ArgumentTypeError(f"{text} are too many at once; give {_MAX_ORDERS} or fewer")
    return number


def bound(text: str) -> int:
    """Read how often something may happen at most."""
    number = whole_number(text)
    if number < 0:
        raise argparse.ArgumentTypeError(f"{text} is less than none; give 0 or more")
    return number


def shard(text: str) -> tuple[int, int]:
    """Read a part of a whole: ``2/4``."""
    part, _, parts = text.partition("/")
    try:
        number, whole = int(part), int(parts)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a part; give one such as 2/4") from None
    if not 1 <= number <= whole:
        raise argparse.ArgumentTypeError(f"there is no part {number} of {whole}; they are counted from 1")
    return number, whole


def schedule(text: str) -> "Seed":
    """Read the name of a schedule: a seed, a strategy with a seed (``pct:5``), or moves."""
    from sim.clock.moves import moves_of
    from sim.clock.strategies import STRATEGIES

    strategy, colon, choices = text.partition(":")
    if not colon:
        return seed(text)
    if strategy in STRATEGIES:
        seed(choices)
        return text
    try:
        if strategy == "moves" and all(min(move) >= 0 for move in moves_of(choices).items()):
            return text
    except ValueError:
        pass
    known = ", ".join(f"{each}:5" for each in STRATEGIES)
    raise argparse.ArgumentTypeError(f"no schedule is called {text}; give a seed, {known}, or moves:3=1,9=2")


def seed(text: str) -> int:
    """Read the seed of a schedule."""
    number = whole_number(text)
    if number < 0:
        raise argparse.ArgumentTypeError(f"a seed cannot be {text}; give 0, the usual order, or more")
    if number > _MAX_SEED:
        raise argparse.ArgumentTypeError(f"there is no seed {text}; give {_MAX_SEED} or less")
    return number


def whole_number(text: str, give: str = "one such as 17") -> int:
    """Read a whole number."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number; give {give}") from None


def port(text: str) -> int:
    """Read a port that a program may listen on."""
    number = whole_number(text)
    if not 1024 <= number <= 65_525:
        raise argparse.ArgumentTypeError(f"{text} is not a port for a program: give one from 1024 to 65525")
    return number


def process_or_address(text: str) -> int | tuple[str, int]:
    """Read a process's number, or host and port."""
    host, colon, number = text.rpartition(":")
    return (host, port(number)) if colon else whole_number(text)


def chain(text: str) -> tuple[str, ...]:
    """Read the topics and services of a chain: ``/scan:/cmd_vel``."""
    names = tuple(name if name.startswith("/") else f"/{name}" for name in text.split(":"))
    if len(names) < 2 or "/" in names:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a chain; give a first and a last topic: /scan:/cmd_vel"
        )
    return names


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


def group_change(text: str) -> "tuple[CallbackPlace, str]":
    """Read a callback and its new group, such as ``odom_callback=own``."""
    from cbtui.runs.setup.changes import GROUP_CHOICES  # imported late: it needs the engine's set-up

    place, group = _place_and_value(text, "a group, such as odom_callback=own")
    if group not in GROUP_CHOICES:
        sentence = f"{group!r} is not a group; give {', '.join(GROUP_CHOICES[:-1])} or {GROUP_CHOICES[-1]}"
        raise argparse.ArgumentTypeError(sentence)
    return place, group


def period_change(text: str) -> "tuple[CallbackPlace, int]":
    """Read a timer's callback and its new period, such as ``timer_callback=0.2``; returns nanoseconds."""
    place, seconds = _place_and_value(text, "seconds, such as timer_callback=0.2")
    return place, nearest_ns(_quantity(PERIOD, seconds))


def sensor_rate(text: str) -> float:
    """Read a sensor rate in Hz."""
    return _quantity(SENSOR_RATE, text)


def _text(word: str) -> str:
    if not is_text(word):
        raise argparse.ArgumentTypeError(f"{word!r} is not UTF-8 text")
    return word


def _place_and_value(text: str, what: str) -> "tuple[CallbackPlace, str]":
    """Split ``NODE:CALLBACK=VALUE``; without a node, any node is meant."""
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
    """Read typed text with Python's escapes: ``\\n`` for enter, ``\\x03`` for ctrl+c."""
    try:
        return _text(word).encode("latin-1", "backslashreplace").decode("unicode_escape")
    except UnicodeDecodeError:
        raise argparse.ArgumentTypeError(
            rf"{word!r} ends in the middle of an escape; write a backslash as \\"
        ) from None


class TimedLineOption(argparse.Action):
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


class TimedKeysOption(TimedLineOption):
    """Takes a moment in seconds and text to be typed."""

    read = staticmethod(_keys)
