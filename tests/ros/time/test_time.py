"""Arithmetic of times and lengths of time."""

import operator
from collections.abc import Callable
from typing import Any

import pytest

from sim.ros.time.clock_type import ClockType
from sim.ros.time.duration import Duration, Infinite
from sim.ros.time.time import Time

LIMIT = 2**63


def at(nanoseconds: int) -> Time:
    return Time(nanoseconds=nanoseconds)


def length(nanoseconds: int) -> Duration:
    return Duration(nanoseconds=nanoseconds)


def test_seconds_and_nanoseconds_add_up_to_whole_nanoseconds() -> None:
    assert Time(seconds=1.5, nanoseconds=3) == at(1_500_000_003)
    assert at(1_500_000_003).seconds_nanoseconds() == (1, 500_000_003)
    assert Duration(seconds=0.5) == length(500_000_000)
    assert Duration(seconds=1, nanoseconds=1e6) == length(1_001_000_000)  # type: ignore[arg-type]
    assert Duration(seconds=-1).nanoseconds == -1_000_000_000


@pytest.mark.parametrize(
    ("make", "error"),
    [
        (lambda: at(LIMIT), OverflowError),
        (lambda: Time(seconds=-1), ValueError),
        (lambda: at(-1), ValueError),
        (lambda: Time(clock_type="SYSTEM_TIME"), TypeError),  # type: ignore[arg-type]
        (lambda: length(LIMIT), OverflowError),
        (lambda: length(-LIMIT - 1), OverflowError),
        (lambda: at(0) - length(1), ValueError),
        (lambda: at(LIMIT - 1) + length(1), OverflowError),
    ],
)
def test_what_does_not_fit_is_refused(make: Callable[[], object], error: type[Exception]) -> None:
    with pytest.raises(error):
        make()


def test_times_and_lengths_add_and_subtract_to_what_makes_sense() -> None:
    assert at(10) + length(5) == length(5) + at(10) == at(15)
    assert at(10) - length(4) == at(6)
    assert at(10) - at(4) == length(6)
    assert at(4) - at(10) == length(-6)


@pytest.mark.parametrize(
    ("left", "right", "operation"),
    [
        (at(1), at(1), operator.add),
        (length(1), at(1), operator.sub),
        (at(1), 1, operator.add),
        (at(1), length(1), operator.lt),
        (length(1), at(1), operator.gt),
        (length(1), 1, operator.le),
        (at(1), "1", operator.ge),
    ],
)
def test_other_operations_are_type_errors(left: Any, right: Any, operation: Callable[..., Any]) -> None:
    with pytest.raises(TypeError):
        operation(left, right)


@pytest.mark.parametrize("make", [at, length])
def test_both_are_ordered_and_can_be_keys(make: Callable[[int], Any]) -> None:
    assert make(1) < make(2) <= make(2)
    assert make(2) > make(1) >= make(1)
    assert make(1) != make(2)
    assert len({make(1), make(1), make(2)}) == 2


@pytest.mark.parametrize("operation", [operator.eq, operator.ne, operator.lt, operator.ge, operator.sub])
def test_times_of_different_clocks_do_not_mix(operation: Callable[..., Any]) -> None:
    with pytest.raises(TypeError, match="different clock types"):
        operation(at(1), Time(nanoseconds=1, clock_type=ClockType.STEADY_TIME))


def test_both_tell_what_they_are() -> None:
    assert repr(at(1)) == "Time(nanoseconds=1, clock_type=SYSTEM_TIME)"
    assert repr(length(1)) == "Duration(nanoseconds=1)"
    assert str(length(1)) == "1 nanoseconds"
    assert str(Infinite) == "Infinite"


def test_messages_keep_seconds_and_nanoseconds_apart() -> None:
    message = at(1_000_000_002).to_msg()
    assert (message.sec, message.nanosec) == (1, 2)
    assert Time.from_msg(message).clock_type is ClockType.ROS_TIME
    assert Time.from_msg(message, clock_type=ClockType.SYSTEM_TIME) == at(1_000_000_002)
    negative = length(-1).to_msg()
    assert (negative.sec, negative.nanosec) == (-1, 999_999_999)
    assert Duration.from_msg(negative) == length(-1)


def test_times_are_made_of_their_own_messages_only() -> None:
    with pytest.raises(TypeError, match=r"^Must pass a builtin_interfaces.msg.Time object$"):
        Time.from_msg(length(1).to_msg())
    with pytest.raises(TypeError, match=r"^Must pass a builtin_interfaces.msg.Duration object$"):
        Duration.from_msg(at(1).to_msg())
