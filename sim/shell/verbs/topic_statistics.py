"""``ros2 topic hz``, ``bw`` and ``delay``: the rate, bandwidth and delay of messages."""

from __future__ import annotations

import math
from argparse import Namespace
from collections import deque
from collections.abc import Iterable
from typing import Any

from sim.interfaces import Message
from sim.quantities.nanoseconds import SECOND
from sim.ros.qos.qos import qos_profile_sensor_data
from sim.shell.filters import add_filter_option, compiled_filter
from sim.shell.graph import known_topics, topic_type
from sim.shell.messages import message_class
from sim.shell.parser import LineParser, positive_int
from sim.shell.session import CommandFailed, ShellSession
from sim.shell.verbs.verb import Verb, add_graph_options

_TYPE_POLL = 0.1
_WINDOW = 10_000
_BANDWIDTH_WINDOW = 100
_KILO, _MEGA = 1_000, 1_000_000


def spread(values: Iterable[float]) -> tuple[float, float, float, float, int]:
    """Return mean, minimum, maximum, population standard deviation and number of one or more values."""
    every = list(values)
    mean = math.fsum(every) / len(every)
    deviation = math.sqrt(math.fsum((each - mean) ** 2 for each in every) / len(every))
    return mean, min(every), max(every), deviation, len(every)


def _spread_text(lengths: Iterable[int]) -> tuple[float, str]:
    """Return the mean of nanoseconds, in seconds, and a line with the rest of their spread."""
    mean, least, greatest, deviation, count = spread(length / SECOND for length in lengths)
    text = f"\tmin: {least:.3f}s max: {greatest:.3f}s std dev: {deviation:.5f}s window: {count}"
    return mean, text


class RateMeter:
    """The time between messages, the last ``window`` of them. Times are nanoseconds."""

    def __init__(self, window: int) -> None:
        self._gaps: deque[int] = deque(maxlen=window)
        self._last: int | None = None
        self._reported: int | None = None

    def message(self, now: int) -> None:
        """Add a message."""
        if self._last is not None:
            self._gaps.append(now - self._last)
        self._last = now

    def report(self) -> str | None:
        """Return the text to print after a message, once a second, from the second second on; else None."""
        if self._last is None or not self._gaps:
            return None
        if self._reported is None:
            self._reported = self._last
            return None
        if self._last < self._reported + SECOND:
            return None
        self._reported = self._last
        mean, text = _spread_text(self._gaps)
        return f"average rate: {1.0 / mean if mean > 0 else 0.0:.3f}\n{text}"


class Bandwidth:
    """The sizes (bytes) and times (nanoseconds) of the last ``window`` messages."""

    def __init__(self, window: int) -> None:
        self._came: deque[tuple[int, int]] = deque(maxlen=window)

    def message(self, now: int, size: int) -> None:
        """Add a message."""
        self._came.append((now, size))

    def report(self, now: int) -> str | None:
        """Return the text to print once a second; None for fewer than two messages."""
        if len(self._came) < 2 or now <= self._came[0][0]:
            return None
        sizes = [size for _, size in self._came]
        a_second = sum(sizes) * SECOND / (now - self._came[0][0])
        mean, least, greatest = (as_bytes(each) for each in spread(sizes)[:3])
        return (
            f"{as_bytes(a_second)}/s from {len(sizes)} messages\n"
            f"\tMessage size mean: {mean} min: {least} max: {greatest}"
        )


class Delay:
    """The ages of the last ``window`` messages by their stamps. Times are nanoseconds."""

    def __init__(self, window: int) -> None:
        self._delays: deque[int] = deque(maxlen=window)
        self._reported = 0

    def message(self, now: int, stamp: int) -> None:
        """Add a message."""
        self._delays.append(now - stamp)
        self._last = now

    def report(self) -> str | None:
        """Return the text to print once a second; None if no message came since."""
        if not self._delays or self._last == self._reported:
            return None
        self._reported = self._last
        mean, text = _spread_text(self._delays)
        return f"average delay: {mean:.3f}\n{text}"


def as_bytes(size: float) -> str:
    """Return a size as ``ros2 topic bw`` writes it."""
    if size < _KILO:
        return f"{size:.0f} B"
    return f"{size / _KILO:.2f} KB" if size < _MEGA else f"{size / _MEGA:.2f} MB"


def _add_topic(parser: LineParser, what: str, window: int) -> None:
    parser.argument("topic_name", help=f"Name of the ROS topic to {what}", completer=known_topics)
    parser.add_argument(
        "--window",
        "-w",
        type=positive_int,
        default=window,
        help=f"window size, in number of messages (default: {window})",
        metavar="WINDOW",
    )
    add_graph_options(parser)


def _class_once_known(session: ShellSession, topic: str) -> type[Message]:
    kind = topic_type(session, topic)
    if kind is None:
        session.say(f"WARNING: topic [{topic}] does not appear to be published yet")
        session.wait_until(lambda: topic_type(session, topic) is not None, _TYPE_POLL)
        kind = topic_type(session, topic)
    assert kind is not None
    return message_class(session.ground, kind)


def _add_hz(parser: LineParser) -> None:
    _add_topic(parser, "listen to (e.g. '/chatter')", _WINDOW)
    add_filter_option(parser, "count")
    parser.flag("--wall-time", help="Calculates rate using wall time, which is the same here")


def _hz(session: ShellSession, arguments: Namespace) -> None:
    passes = compiled_filter(arguments.filter)
    rate = RateMeter(arguments.window)
    cls = _class_once_known(session, arguments.topic_name)

    def hear(message: Any) -> None:
        if passes is None or passes(message):
            rate.message(session.ground.now())
            _say(session, rate.report())

    session.node.create_subscription(cls, arguments.topic_name, hear, qos_profile_sensor_data)
    session.spin()


def _add_bw(parser: LineParser) -> None:
    _add_topic(parser, "monitor for bandwidth utilization", _BANDWIDTH_WINDOW)


def _bw(session: ShellSession, arguments: Namespace) -> None:
    now = session.ground.now
    bandwidth = Bandwidth(arguments.window)
    cls = _class_once_known(session, arguments.topic_name)

    def hear(message: bytes) -> None:
        bandwidth.message(now(), len(message))

    session.node.create_subscription(cls, arguments.topic_name, hear, qos_profile_sensor_data, raw=True)
    session.say(f"Subscribed to [{arguments.topic_name}]")
    session.node.create_timer(1.0, lambda: _say(session, bandwidth.report(now())))
    session.spin()


def _add_delay(parser: LineParser) -> None:
    _add_topic(parser, "calculate the delay for", _WINDOW)


def _delay(session: ShellSession, arguments: Namespace) -> None:
    clock = session.node.get_clock()
    delay = Delay(arguments.window)
    cls = _class_once_known(session, arguments.topic_name)
    if "header" not in cls.get_fields_and_field_types():
        raise CommandFailed("msg does not have header")

    def hear(message: Any) -> None:
        stamp = message.header.stamp
        delay.message(clock.now().nanoseconds, stamp.sec * SECOND + stamp.nanosec)

    session.node.create_subscription(cls, arguments.topic_name, hear, qos_profile_sensor_data)
    session.node.create_timer(1.0, lambda: _say(session, delay.report()))
    session.spin()


def _say(session: ShellSession, report: str | None) -> None:
    if report is not None:
        session.say(report)


BW = Verb("bw", "Display bandwidth used by topic", _add_bw, _bw)
DELAY = Verb("delay", "Display delay of topic from timestamp in header", _add_delay, _delay)
HZ = Verb("hz", "Print the average publishing rate to screen", _add_hz, _hz)
