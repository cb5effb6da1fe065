"""``message_filters``: synchronises messages of several topics by their stamps. As in 4.11.15."""

from collections.abc import Iterable, Sequence
from itertools import product
from threading import Lock
from typing import Any

from rclpy.clock import ROSClock
from rclpy.duration import Duration
from rclpy.logging import get_logger
from rclpy.time import Time

from sim.ros_packages.message_filters import following
from sim.ros_packages.message_filters.simple_filter import SimpleFilter

__all__ = [
    "ApproximateTimeSynchronizer",
    "Cache",
    "Chain",
    "SimpleFilter",
    "Subscriber",
    "TimeSynchronizer",
]


class Subscriber(SimpleFilter):
    """A subscription of a node, with the arguments of ``create_subscription`` except the callback.

    The executor runs it as any other, by default in the node's default group.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        self.node, msg_type, self.topic, *others = args
        kwargs.setdefault("qos_profile", 10)
        self.sub = self.node.create_subscription(msg_type, self.topic, self.callback, *others, **kwargs)

    def callback(self, msg: Any) -> None:
        """Pass on a message."""
        self.signalMessage(msg)

    def getTopic(self) -> str:
        """The topic's name as the program gave it."""
        return str(self.topic)

    def __getattr__(self, key: str) -> Any:
        if key == "sub":
            raise AttributeError(key)
        return getattr(self.sub, key)


class Cache(SimpleFilter):
    """Caches the last ``cache_size`` messages, and passes each message on.

    With ``allow_headerless``, messages without a header are cached by their time of arrival.
    """

    def __init__(self, f: Any, cache_size: int = 1, allow_headerless: bool = False) -> None:
        super().__init__()
        self.cache_size = cache_size
        self.allow_headerless = allow_headerless
        self.cache_msgs: list[Any] = []
        self.cache_times: list[Any] = []
        self.connectInput(f)

    def connectInput(self, f: Any) -> None:
        """Connect to a filter."""
        self.incoming_connection = f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Cache a message, and pass it on."""
        stamp = _stamp(msg, self.allow_headerless, "message_filters_cache")
        if stamp is None:
            return
        self.cache_msgs.append(msg)
        self.cache_times.append(stamp)
        del self.cache_msgs[: -self.cache_size], self.cache_times[: -self.cache_size]
        self.signalMessage(msg)

    def getInterval(self, from_stamp: Any, to_stamp: Any) -> list[Any]:
        """The messages between two times, both included."""
        assert from_stamp <= to_stamp
        return [msg for msg, time in self._timed() if from_stamp <= time <= to_stamp]

    def getElemAfterTime(self, stamp: Any) -> Any:
        """The first message that is not older than a time, or None."""
        return next((msg for msg, time in self._timed() if time >= stamp), None)

    def getElemBeforeTime(self, stamp: Any) -> Any:
        """The last message that is not newer than a time, or None."""
        return next((msg for msg, time in reversed(self._timed()) if time <= stamp), None)

    def getLastestTime(self) -> Any:
        """The stamp of the latest message, or None. The package misspells the name."""
        return self.cache_times[-1] if self.cache_times else None

    getLatestTime = getLastestTime  # noqa: N815

    def getOldestTime(self) -> Any:
        """The stamp of the oldest message in the cache, or None."""
        return self.cache_times[0] if self.cache_times else None

    def getLast(self) -> Any:
        """The first message that is not older than the latest one, or None."""
        latest = self.getLastestTime()
        return None if latest is None else self.getElemAfterTime(latest)

    def _timed(self) -> Sequence[tuple[Any, Any]]:
        return list(zip(self.cache_msgs, self.cache_times, strict=True))


class Chain(SimpleFilter):
    """A sequence of filters as one filter: a message passes all of them in turn."""

    def __init__(self, message_filter: Any = None) -> None:
        super().__init__()
        self.incoming_connection: int | None = None
        self._filters: list[tuple[Any, int]] = []
        if message_filter is not None:
            self.connectInput(message_filter)

    def connectInput(self, message_filter: Any) -> None:
        """Connect to a filter; RuntimeError if the chain is connected already."""
        if self.incoming_connection is not None:
            raise RuntimeError("Already connected")
        self.incoming_connection = message_filter.registerCallback(self.add)

    def add(self, message: Any) -> None:
        """Pass a message through the filters."""
        enter = self._filters[0][0].add if self._filters else self.signalMessage
        enter(message)

    def addFilter(self, message_filter: Any) -> None:
        """Append a filter."""
        if self._filters:
            last, connection = self._filters[-1]
            last.unregisterCallback(connection)
            last.registerCallback(message_filter.add)
        self._filters.append((message_filter, message_filter.registerCallback(self.signalMessage)))

    def getFilter(self, index: int) -> Any:
        """The filter at an index; KeyError if there is no such filter."""
        if not 0 <= index < len(self._filters):
            raise KeyError(index)
        return self._filters[index][0]


class TimeSynchronizer(SimpleFilter):
    """Passes on one message of each filter together, once all messages of the same stamp have arrived.

    Each filter's last ``queue_size`` messages are kept until a newer set is complete. The callbacks run
    in the callback of the message that completes the set, one set at a time.
    """

    def __init__(self, fs: Iterable[Any], queue_size: int) -> None:
        super().__init__()
        self.queue_size = queue_size
        self.lock = Lock()
        self.connectInput(fs)

    def connectInput(self, fs: Iterable[Any]) -> None:
        """Connect to these filters only."""
        filters = list(fs)
        self.queues: list[dict[int, Any]] = [{} for _ in filters]
        self._follower = following.follow(self, [getattr(each, "topic_name", "") for each in filters])
        self.input_connections = [
            each.registerCallback(self.add, queue, index)
            for index, (each, queue) in enumerate(zip(filters, self.queues, strict=True))
        ]

    def add(self, msg: Any, my_queue: dict[int, Any], my_queue_index: int | None = None) -> None:
        """Keep a message. If it completes a set, pass the set on and drop older messages."""
        stamp = Time.from_msg(msg.header.stamp).nanoseconds
        with self.lock:
            self._remember(msg, stamp, my_queue, my_queue_index)
            if all(stamp in queue for queue in self.queues):
                self._hand_on([stamp] * len(self.queues))
                for queue in self.queues:
                    for older in [each for each in queue if each < stamp]:
                        del queue[older]

    def _remember(self, msg: Any, stamp: int, queue: dict[int, Any], index: int | None) -> None:
        if index is not None:
            self._follower.got(index, stamp)
        queue[stamp] = msg
        while len(queue) > self.queue_size:
            del queue[min(queue)]

    def _hand_on(self, stamps: Sequence[int]) -> None:
        """Pass on the messages of these stamps, one of each filter, and drop them."""
        self._follower.handed_on()
        chosen = list(zip(self.queues, stamps, strict=True))
        self.signalMessage(*(queue[stamp] for queue, stamp in chosen))
        for queue, stamp in chosen:
            del queue[stamp]


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """As `TimeSynchronizer`, for stamps that differ by less than ``slop`` seconds.

    With ``allow_headerless``, the stamp of a message without a header is its time of arrival.
    """

    def __init__(
        self, fs: Iterable[Any], queue_size: int, slop: float, allow_headerless: bool = False
    ) -> None:
        super().__init__(fs, queue_size)
        self.slop = Duration(seconds=slop)
        self.allow_headerless = allow_headerless

    def add(self, msg: Any, my_queue: dict[int, Any], my_queue_index: int | None = None) -> None:
        """Keep a message, and pass it on with the nearest message of each other filter within ``slop``."""
        time = _stamp(msg, self.allow_headerless, "message_filters_approx")
        if time is None:
            return
        stamp = time.nanoseconds
        with self.lock:
            self._remember(msg, stamp, my_queue, my_queue_index)
            if stamp not in my_queue:
                return  # the message is older than all that are kept
            others = [
                (stamp,) if index == my_queue_index else self._near(queue, stamp)
                for index, queue in enumerate(self.queues)
            ]
            for stamps in product(*others):
                if max(stamps) - min(stamps) < self.slop.nanoseconds:
                    self._hand_on(stamps)
                    return

    def _near(self, queue: dict[int, Any], stamp: int) -> Sequence[int]:
        near = (each for each in queue if abs(each - stamp) <= self.slop.nanoseconds)
        return sorted(near, key=lambda each: abs(each - stamp))


def _stamp(msg: Any, allow_headerless: bool, logger: str) -> Any:
    """The time of a message as an ``rclpy.time.Time``; None, and a warning, if it has no stamp."""
    if hasattr(msg, "header") and hasattr(msg.header, "stamp"):
        stamp = msg.header.stamp
        return stamp if hasattr(stamp, "nanoseconds") else Time.from_msg(stamp)
    if allow_headerless:
        return ROSClock().now()
    get_logger(logger).warning(
        "can not use message filters for messages without timestamp information when 'allow_headerless' is "
        "disabled. auto assign ROSTIME to headerless messages once enabling constructor option of "
        "'allow_headerless'."
    )
    return None
