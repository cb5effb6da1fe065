"""Events of every kind: a story of them all, and any kind with all it can carry or as little as it may."""

from enum import Enum
from math import inf
from types import UnionType
from typing import Annotated, Any, get_args, get_origin

import msgspec

from sim.trace.events import (
    AnyEvent,
    ArenaShown,
    CallbackAt,
    CallbackEnded,
    CallbackFailed,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    CallBlocked,
    CallUnblocked,
    CommandGiven,
    ContentsLost,
    Doing,
    EntityAppeared,
    EntityGone,
    EntityId,
    EntityKind,
    EntityReady,
    EventsLost,
    ExceptionSurfaced,
    ExecutorAppeared,
    GroupAppeared,
    GroupKind,
    InputGiven,
    KeyboardAsked,
    LineCompleted,
    LineEnded,
    LineGiven,
    LineSaid,
    Logged,
    MessageDropped,
    MessageSent,
    NodeAppeared,
    Notice,
    OwnThreadAt,
    Printed,
    ProcessAppeared,
    ProcessEnded,
    ProgramAt,
    Published,
    QosMismatched,
    Reading,
    Reason,
    RequestLost,
    RobotMoved,
    RunEnded,
    RunEnding,
    RunStarted,
    Scanned,
    ServiceCalled,
    ServiceReplied,
    Severity,
    Shown,
    SpinClashed,
    SynchroniserJudged,
    ThreadAppeared,
    TimeHalted,
    TimePassed,
    TimerCancelled,
    TimerReset,
    TimesKept,
    TopicAppeared,
    Typed,
    VelocityCommanded,
    WaitEnded,
    WaitStarted,
)

CAST: list[AnyEvent] = [
    RunStarted(0, "shared-group", "virtual", 1_631_462_000_000_000_000),
    ThreadAppeared(0, 1, "MainThread", 1),
    ExecutorAppeared(0, 1, "SingleThreadedExecutor", 1),
    NodeAppeared(0, 1, "/sub_node"),
    GroupAppeared(0, 1, 1, GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup"),
    EntityAppeared(0, 1, 1, 1, EntityKind.SUBSCRIPTION, "/odom", "odom_callback", "node.py", 58, 68, 10, 0),
    EntityAppeared(0, 2, 1, 1, EntityKind.TIMER, "", "timer_callback", "node.py", 120, 136, 0, 500_000_000),
]

FULL: list[AnyEvent] = [
    CAST[0],
    ProcessAppeared(0, 1, "talker-1"),
    *CAST[1:],
    Published(1_500_000_000, 7, "/odom", 0, 2),
    QosMismatched(1_500_000_000, "/odom", 1, 1, "RELIABILITY", ("node.py", 9), ("node.py", 12)),
    SynchroniserJudged(1_500_000_000, 1, ("node.py", 14), ("/odom",), (20,), (7,), 5, 9, 9, False),
    TopicAppeared(1_500_000_000, 1, "/odom", "std_msgs/msg/Bool", "bool data\n"),
    MessageSent(1_500_000_000, 7, 1, bytes([0, 1, 0, 0, 1])),
    EntityReady(1_502_000_000, 1, 1, 7),
    WaitStarted(1_502_000_000, 1, 1_502_000_000, Reason.GROUP_HELD, 2, True),
    MessageDropped(1_502_000_000, 1, 10, 6),
    TimerCancelled(1_502_000_000, 1),
    TimerReset(1_502_000_000, 1),
    WaitEnded(2_000_000_000, 1),
    CallbackStarted(2_000_000_000, 1, 1, 7, 500_000_000, 0),
    Logged(2_000_000_000, Severity.INFO, "sub_node", "Odom CallBack", 1, 1),
    CallbackSuspended(2_000_000_000, 1, 1),
    CallbackResumed(2_100_000_000, 1, 1),
    ServiceCalled(2_100_000_000, 1, "/motor_power", 1, "SetBool_Request(data=True)"),
    RequestLost(2_100_000_000, 2, "/motor_power"),
    CallBlocked(2_100_000_000, 1, 1, 1, "/motor_power"),
    ServiceReplied(2_200_000_000, 1, "/motor_power", "SetBool_Response(success=True, message='')"),
    CallUnblocked(2_200_000_000, 1, 1),
    CallbackAt(2_250_000_000, 1, 1, Doing.SLEEPS, "time.sleep", (("node.py", "odom_callback", 60),)),
    ProgramAt(2_250_000_000, Doing.CALLS_ROS, "spin", (("node.py", "main", 70),), ("node.py", 69)),
    OwnThreadAt(2_250_000_000, 0, "worker", Doing.WAITS, "Event.wait", (("node.py", "work", 40),)),
    SpinClashed(2_250_000_000, 1, 1, "spin_until_future_complete", "node.py", 60),
    TimesKept(2_250_000_000, 1, 8_000_000_000, ("done_at",)),
    CallbackFailed(2_250_000_000, 1, 1, "IndexError: no beam 720", "node.py", 60),
    CallbackEnded(2_250_000_000, 1, 1),
    ExceptionSurfaced(2_250_000_000, 1, "IndexError: no beam 720", "node.py", 60),
    Printed(2_300_000_000, "hello", True, 1),
    ArenaShown(2_350_000_000, ((0.0, 0.0, 1.0, 0.0),), (0.9, 0.0, 0.2), 0.1),
    RobotMoved(2_350_000_000, 0.5, 0.0, -0.1, inf, 0.08, 0.0, True, False, -0.1, 0.5),
    Scanned(2_350_000_000, 8, bytes([1, 0, 2, 0, 244, 1, 4, 0])),
    VelocityCommanded(2_400_000_000, 0.08, -0.2),
    CommandGiven(2_500_000_000, "/motor_power SetBool data=True"),
    InputGiven(2_500_000_000, '{"type":"call","name":"/motor_power","data":true}'),
    TimeHalted(2_500_000_000, "step"),
    TimePassed(2_500_000_000),
    RunEnding(2_500_000_000, "its time was up"),
    KeyboardAsked(2_500_000_000, Reading.RAW, "teleop.py"),
    Typed(2_500_000_000, "w"),
    LineGiven(2_500_000_000, 1, "ros2 topic list"),
    LineSaid(2_500_000_000, 1, "/odom", False),
    LineEnded(2_500_000_000, 1, 0),
    LineCompleted(2_500_000_000, 2, 5, ("list", "pub")),
    ProcessEnded(2_500_000_000, 1, "the program returned", 0),
    Notice(2_600_000_000, Severity.WARN, "The robot touches the wall.", 1),
    EventsLost(2_700_000_000, 12),
    ContentsLost(2_700_000_000, 3),
    EntityGone(2_800_000_000, 1),
    RunEnded(3_000_000_000, "its time was up", False),
]

BARE: list[AnyEvent] = [
    *CAST,
    EntityAppeared(0, 3, 1, 1, EntityKind.CLIENT, "/motor_power", "", "", 0, 0, 10, 0),
    Published(1_500_000_000, 7, "/odom", 0, 0),
    QosMismatched(1_500_000_000, "/odom", 0, 0, "RELIABILITY"),
    MessageSent(1_500_000_000, 7, 1, None),
    EntityReady(1_502_000_000, 3, 1, 0),
    WaitStarted(1_502_000_000, 3, 1_502_000_000, Reason.NO_FREE_WORKER, 0, True),
    MessageDropped(1_502_000_000, 3, 10, 0),
    TimerCancelled(1_502_000_000, 3),
    WaitEnded(2_000_000_000, 3),
    CallbackStarted(2_000_000_000, 3, 1, 0, 0, 0),
    Logged(2_000_000_000, Severity.INFO, "sub_node", "Odom CallBack", 0, 0),
    CallbackSuspended(2_000_000_000, 3, 1),
    CallbackResumed(2_100_000_000, 3, 1),
    ServiceCalled(2_100_000_000, 1, "/motor_power", 0, "SetBool_Request(data=True)"),
    RequestLost(2_100_000_000, 2, "/motor_power"),
    CallBlocked(2_100_000_000, 1, 1, 0, "/motor_power"),
    ServiceReplied(2_200_000_000, 1, "/motor_power", "SetBool_Response(success=True, message='')"),
    CallUnblocked(2_200_000_000, 1, 1),
    OwnThreadAt(2_250_000_000, 0, "worker", Doing.WAITS, "Event.wait", (("node.py", "work", 40),)),
    SpinClashed(2_250_000_000, 0, 0, "spin", "", 0),
    CallbackFailed(2_250_000_000, 3, 1, "IndexError: no beam 720", "node.py", 60),
    CallbackEnded(2_250_000_000, 3, 1),
    Printed(2_800_000_000, "hello", True),
    Notice(2_800_000_000, Severity.INFO, "The robot stands."),
    EntityGone(2_800_000_000, 3),
]


_SAMPLES = {int: 1, str: "text", float: 0.5, bool: True, bytes: bytes(8)}
_WITHOUT_CALLBACK = 3
"""The client of ``BARE``."""


def full(kind: type[AnyEvent]) -> AnyEvent:
    """An event of a kind with all it can carry; its ids are those of ``CAST``."""
    return kind(*(_value(field.type) for field in msgspec.structs.fields(kind)))


def bare(kind: type[AnyEvent]) -> AnyEvent:
    """An event of a kind with as little as it may carry; its entity has no callback."""
    least: dict[str, Any] = {}
    for name, annotated in ((field.name, field.type) for field in msgspec.structs.fields(kind)):
        marks = get_args(annotated)
        if annotated == EntityId:
            least[name] = _WITHOUT_CALLBACK
        elif Shown.IF_ANY in marks:
            several = () if ... in get_args(marks[0]) else ("", 0)
            least[name] = {int: 0, str: ""}.get(marks[0], several)
        elif name == "callback":
            least[name] = ""
        elif get_origin(marks[:1] and marks[0]) is UnionType:
            least[name] = None
    return msgspec.structs.replace(full(kind), **least)


def _value(annotated: Any) -> Any:
    """A value of a field's type."""
    arguments = get_args(annotated)
    match get_origin(annotated):
        case origin if origin is Annotated or origin is UnionType:
            return _value(arguments[0])
        case origin if origin is tuple:
            return tuple(_value(each) for each in arguments if each is not ...)
    return next(iter(annotated)) if issubclass(annotated, Enum) else _SAMPLES[annotated]
