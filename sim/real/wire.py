"""The format of a probe: lines of JSON, each an array of events, some of which are translated later.

Times are nanoseconds of the machine's monotonic clock; ids differ between all processes of the machine.
"""

import math
import sys
from collections.abc import Callable
from functools import cache, reduce
from operator import or_
from typing import Any, TypeAlias

import msgspec

from sim.engine import commands
from sim.trace.events import (
    AnyEvent,
    ArenaShown,
    CommandGiven,
    RobotMoved,
    RunEnded,
    RunEnding,
    RunStarted,
    Scanned,
    TimePassed,
    VelocityCommanded,
)
from sim.trace.events.event import kinds


class Hello(msgspec.Struct, frozen=True, array_like=True, tag="hello"):
    """The first line: the description of the process."""

    t: int
    protocol: int
    process: int
    """Its process id."""
    python: str
    """Version of its Python."""
    distribution: str
    """The ROS distribution, if the environment names it."""
    command: list[str]
    epoch: int
    """Nanoseconds since 1970 at ``t``."""


class Sent(msgspec.Struct, frozen=True, array_like=True, tag="sent"):
    """A message was published."""

    t: int
    message: int
    topic: str
    node: int
    entity: int
    before: int
    """Nanoseconds since 1970 before the middleware had it."""
    after: int
    """Nanoseconds since 1970 once the middleware had it."""


class Called(msgspec.Struct, frozen=True, array_like=True, tag="called"):
    """A request was sent to a service."""

    t: int
    call: int
    service: str
    entity: int
    request: str
    before: int
    """Nanoseconds since 1970 before the middleware had it."""
    after: int
    """Nanoseconds since 1970 once the middleware had it."""


class MessageTaken(msgspec.Struct, frozen=True, array_like=True, tag="taken"):
    """A callback started with a message or a request."""

    t: int
    entity: int
    thread: int
    sent: int
    """Nanoseconds since 1970 at which the middleware sent it."""
    age: int
    """Nanoseconds since then."""


class At(msgspec.Struct, frozen=True, array_like=True, tag="at"):
    """Where a running callback is in the program's own code, or the main thread while nobody spins."""

    t: int
    entity: int
    """0 for the main thread."""
    thread: int
    frames: tuple[tuple[str, str, int], ...]
    """File, function and line, from the callback inwards."""
    instruction: tuple[int, int, int, int]
    """First and last line, first and last column in bytes, of what the innermost does; zeros if not known."""
    module: str
    """Module of the function that the innermost has called; "" if it has called none in Python."""
    function: str
    """That function's qualified name."""
    until: int = 0
    """When the timeout that this function was given is over; 0 for none."""
    is_simulated: bool = False
    """Whether it is a function of a clock that goes by simulated time."""
    holder: int = 0
    """The thread whose callback holds the lock for which it waits; 0: none is known to."""
    keeper: int = 0
    """The entity whose suspended callback does."""
    taken_at: tuple[str, int] = ("", 0)
    """Where that lock was taken."""
    taken_by: str = ""
    """The name of the thread that holds it, if it runs no callback."""
    job: tuple[str, str, int] = ("", "", 0)
    """File, function and line at which a job of a pool waits for another job, if this waits for a job."""


class Replied(msgspec.Struct, frozen=True, array_like=True, tag="replied"):
    """A service sent the reply to a request."""

    t: int
    entity: int
    sent: int
    """Nanoseconds since 1970 at which the middleware sent the request."""
    response: str


class Uncaught(msgspec.Struct, frozen=True, array_like=True, tag="uncaught"):
    """An exception ended the program's main thread, and soon the program."""

    t: int
    error: str
    """Its class and text."""
    file: str
    """Innermost file of the program's own code, or that of what made rclpy raise it."""
    line: int
    exception: str = ""
    """Its class."""
    advice: str = ""
    """What to do about it; "" if the probe does not know."""
    goes_on: bool = False
    """Whether there are other threads for which Python waits."""


class Left(msgspec.Struct, frozen=True, array_like=True, tag="left"):
    """The process ended by itself."""

    t: int


class ProgramWanted(msgspec.Struct, frozen=True, array_like=True, tag="start"):
    """A request of a ``ros2`` line to start a package's program or a launch file, whose package may be ""."""

    t: int
    line: int
    package: str
    file: str
    """The executable, or the launch file."""
    arguments: tuple[str, ...]
    is_launch: bool


class Interrupted(msgspec.Struct, frozen=True, array_like=True, tag="interrupt"):
    """A request of a ``ros2`` line to end what the run started for it."""

    t: int
    line: int


_Own: TypeAlias = (
    Hello | Sent | Called | MessageTaken | At | Replied | Uncaught | Left | ProgramWanted | Interrupted
)

ProbeLine: TypeAlias = _Own | AnyEvent

OF_THE_RUN = (
    *(RunStarted, RunEnding, RunEnded, CommandGiven, TimePassed),
    *(ArenaShown, RobotMoved, Scanned, VelocityCommanded),
)
"""Events that only the run itself or its robot may record."""


@cache
def _decoder() -> msgspec.json.Decoder[list[ProbeLine]]:
    line: Any = reduce(or_, kinds(), _Own)
    return msgspec.json.Decoder(list[line])


def decode_lines(data: bytes) -> list[ProbeLine]:
    """Decode whole lines.

    Raises:
        msgspec.DecodeError: they are not in a probe's format.
    """
    try:
        return [told for line in _decoder().decode_lines(data) for told in line]
    except (UnicodeDecodeError, RecursionError) as error:
        raise msgspec.DecodeError(str(error)) from None


class ProgramEnded(msgspec.Struct, frozen=True, tag="program_ended"):
    """The report that what was started for a ``ros2`` line has ended."""

    line: int
    status: int


class NodesKnown(msgspec.Struct, frozen=True, tag="nodes_known"):
    """Nodes of the run's programs, which discovery has yet to find."""

    names: tuple[str, ...]


LineRequest: TypeAlias = (
    commands.RunLine | commands.InterruptLine | commands.CompleteLine | ProgramEnded | NodesKnown
)
"""A request to the process that carries out ``ros2`` lines."""

decode_request: Callable[[bytes], LineRequest] = msgspec.json.Decoder(LineRequest).decode


def finite(event: AnyEvent) -> AnyEvent:
    """The event without infinite numbers, which JSON lacks; a robot with a free way ahead has them."""
    if isinstance(event, RobotMoved) and math.isinf(event.front):
        return msgspec.structs.replace(event, front=sys.float_info.max)
    return event


def infinite(event: AnyEvent) -> AnyEvent:
    """The event of which ``finite`` made this one."""
    if isinstance(event, RobotMoved) and event.front == sys.float_info.max:
        return msgspec.structs.replace(event, front=math.inf)
    return event
