"""Edge values of rclpy's public names, against what they did on rclpy 7.1.6, run from the wheels of Jazzy."""

import pytest

import sim.ros.rclpy as rclpy
from sim.ros.clocks.clock import Clock, ClockChange, JumpThreshold, ROSClock, TimeJump
from sim.ros.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    NotInitializedException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from sim.ros.logging.logger import get_logger, get_logging_severity_from_string
from sim.ros.parameters.parameter import Parameter
from sim.ros.time.clock_type import ClockType
from sim.ros.time.duration import Duration, Infinite
from sim.ros.time.time import Time

ANY_CHANGE = JumpThreshold(min_forward=None, min_backward=None, on_clock_change=True)


@pytest.mark.parametrize("other", [1, 1.0, None, Duration(seconds=1), Infinite, Time().to_msg(), "1"])
def test_a_time_equals_nothing_but_times(other: object) -> None:
    assert not Time(seconds=1) == other  # noqa: SIM201 -- each of the two is asked
    assert Time(seconds=1) != other


@pytest.mark.parametrize("other", [1, 1.0, None, Time(seconds=1), Duration().to_msg(), "1"])
def test_a_duration_equals_nothing_but_durations(other: object) -> None:
    assert not Duration(seconds=1) == other  # noqa: SIM201 -- as above
    assert Duration(seconds=1) != other


def test_what_leaves_the_range_of_times_is_told_by_what_did_it() -> None:
    with pytest.raises(OverflowError, match=r"^Addition leads to overflow in C storage\.$"):
        Infinite + Time(seconds=1)
    with pytest.raises(ValueError, match=r"^Subtraction leads to negative time\.$"):
        Time(seconds=1) - Duration(seconds=2)


def test_a_clock_of_ros_time_shows_itself_as_any_clock() -> None:
    assert repr(ROSClock()) == repr(Clock(clock_type=ClockType.ROS_TIME)) == "Clock(clock_type=ROS_TIME)"


def test_what_is_told_of_jumps_has_to_be_callable() -> None:
    with pytest.raises(ValueError, match=r"^pre_callback must be callable if given$"):
        Clock().create_jump_callback(ANY_CHANGE, pre_callback=5)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"^One of pre_callback or post_callback must be callable$"):
        Clock().create_jump_callback(ANY_CHANGE, post_callback=5)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^clock_change must be an instance of rclpy\.clock\.ClockChange$"):
        TimeJump(5, Duration())  # type: ignore[arg-type]
    assert TimeJump(ClockChange.ROS_TIME_ACTIVATED, Duration(seconds=1)).delta == Duration(seconds=1)


@pytest.mark.parametrize("severity", ["x", None, 7])
def test_a_severity_has_to_be_one(severity: object) -> None:
    with pytest.raises(ValueError, match="is not a valid LoggingSeverity"):
        get_logger("edges").is_enabled_for(severity)  # type: ignore[arg-type]
    with pytest.raises(RuntimeError, match=r"^Failed to get severity name$"):
        get_logging_severity_from_string("x")


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (NotInitializedException(), "rclpy.init() has not been called."),
        (NotInitializedException("why"), "rclpy.init() has not been called. msg:why"),
        (ParameterNotDeclaredException("x"), "Invalid access to undeclared parameter(s): x"),
        (ParameterAlreadyDeclaredException(["b"]), "Parameter(s) already declared: ['b']"),
        (ParameterUninitializedException("v"), "The parameter 'v' is not initialized: v"),
        (ParameterImmutableException("z"), "Attempted to modify read-only parameter: z"),
        (
            InvalidParameterValueException("w", 5, "too small"),
            "Invalid parameter value (5) for parameter. Reason: too small: w",
        ),
        (
            InvalidParameterTypeException(Parameter("x", value=1), "Type.STRING"),
            "Trying to set parameter 'x' to '1' of type 'INTEGER', expecting type 'Type.STRING': x",
        ),
    ],
)
def test_an_exception_is_one_sentence(error: Exception, text: str) -> None:
    assert error.args == (text,)


def test_a_list_of_several_types_is_shown() -> None:
    with pytest.raises(TypeError, match=r"^The given value is not a list of .* types '\[1, 'a'\]'\.$"):
        Parameter("e", value=[1, "a"])


def test_a_node_is_asked_with_what_it_cannot_take() -> None:
    rclpy.init()
    try:
        node = rclpy.create_node("edges")
        with pytest.raises(TypeError, match="Callback must be callable"):
            node.add_on_set_parameters_callback(5)  # type: ignore[arg-type]
    finally:
        rclpy.shutdown()
