"""Loggers: levels, children, and lines that are held back."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sim.ros.clocks.clock import Clock
from sim.ros.logging import logger as logging
from sim.ros.logging.logger import LoggingSeverity, RcutilsLogger, get_logger
from sim.ros.time.clock_type import ClockType
from tests.support.simulation import Simulation, simulate


def said(lines: Callable[[RcutilsLogger, Simulation], object]) -> list[str]:
    return simulate(lambda simulation: lines(get_logger("a"), simulation)).said()


def each_second(count: int, **options: Any) -> list[str]:
    """Which of so many lines, one a second, get through the filters."""

    def lines(logger: RcutilsLogger, simulation: Simulation) -> None:
        for number in range(count):
            assert logger.info(str(number), **options) in {True, False}
            simulation.sleep(1.0)

    return said(lines)


def test_filters_hold_lines_back() -> None:
    assert each_second(5, once=True) == ["0"]
    assert each_second(5, skip_first=True) == ["1", "2", "3", "4"]
    assert each_second(5, throttle_duration_sec=2.0) == ["0", "2", "4"]


def test_a_throttle_counts_on_the_clock_it_is_given() -> None:
    def lines(logger: RcutilsLogger, simulation: Simulation) -> None:
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        for number in range(3):
            logger.info(str(number), throttle_duration_sec=1.5, throttle_time_source_type=steady)
            simulation.sleep(1.0)

    assert said(lines) == ["2"]


def test_filters_are_asked_in_rclpys_order() -> None:
    assert each_second(5, once=True, skip_first=True) == ["1"]
    # The throttle counts the skipped line as logged.
    assert each_second(5, skip_first=True, throttle_duration_sec=3.0) == ["3"]
    assert each_second(5, once=False, skip_first=False) == ["0", "1", "2", "3", "4"]


def test_every_place_has_filters_of_its_own() -> None:
    def lines(logger: RcutilsLogger, _: Simulation) -> None:
        _both = [logger.info("first", once=True), logger.info("second", once=True)]
        logger.info("third", once=True)

    assert said(lines) == ["first", "second", "third"]


@pytest.mark.parametrize(
    ("first", "second", "text"),
    [
        ({"severity": 20}, {"severity": 30}, "Logger severity cannot be changed between calls."),
        ({"name": "b"}, {"name": "c"}, "Logger name cannot be changed between calls."),
        ({}, {"once": True}, "Requested logging filters cannot be changed between calls."),
        (
            {"throttle_duration_sec": 1.0},
            {"throttle_duration_sec": 2.0},
            "Logging filter parameters cannot be changed between calls.",
        ),
    ],
)
def test_a_place_must_not_change_what_it_asks_for(first: Any, second: Any, text: str) -> None:
    def lines(logger: RcutilsLogger, _: Simulation) -> None:
        for options in (first, second):
            logger.log("x", **{"severity": 20, **options})

    with pytest.raises(ValueError, match=f"^{text}$"):
        said(lines)


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"foo": 1}, TypeError, 'parameter "foo" is not one of the recognized logging options'),
        ({"throttle_time_source_type": object()}, TypeError, 'required parameter "throttle_duration_sec"'),
        ({"throttle_duration_sec": 1, "throttle_time_source_type": 1}, ValueError, "is not a clock instance"),
    ],
)
def test_wrong_options_are_named(options: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        said(lambda logger, _: logger.info("x", **options))


def test_a_child_has_its_parents_level_until_it_has_one() -> None:
    def lines(logger: RcutilsLogger, _: Simulation) -> None:
        child = logger.get_child("b")
        assert child.name == get_logger("a.b").name == "a.b"
        assert child.get_effective_level() == LoggingSeverity.INFO
        assert (logging.get_logger_level(""), logging.get_logger_level("a")) == (20, 0)
        logging.set_logger_level("", LoggingSeverity.FATAL)
        assert child.get_effective_level() == LoggingSeverity.FATAL
        logger.set_level(LoggingSeverity.DEBUG)
        assert child.debug("heard")
        child.set_level(40)
        assert not child.warning("not heard")
        assert child.is_enabled_for(LoggingSeverity.ERROR)
        assert (logging.get_logger_level("a"), logging.get_logger_level("a.b.c")) == (10, 0)
        assert logging.get_logger_effective_level("a.b.c") == 40
        with pytest.raises(ValueError, match="Child logger name must not be empty"):
            logger.get_child("")
        with pytest.raises(ValueError, match="Logger name must not be empty"):
            get_logger("")

    assert said(lines) == ["heard"]


def test_severities_are_found_by_name() -> None:
    assert logging.get_logging_severity_from_string("Warn") is LoggingSeverity.WARN
    with pytest.raises(RuntimeError, match="Failed to get severity name"):
        logging.get_logging_severity_from_string("loud")


def test_the_directory_of_logs_is_ros_2s(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_LOG_DIR", raising=False)
    monkeypatch.setenv("ROS_HOME", "/ros")
    assert logging.get_logging_directory() == Path("/ros/log")
    monkeypatch.setenv("ROS_LOG_DIR", "/logs")
    assert logging.get_logging_directory() == Path("/logs")
