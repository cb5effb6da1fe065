"""Log lines on a terminal: their format, their colours and where they go."""

import io
import re

import pytest

import sim.ros.rclpy as rclpy
from sim.ros.logging import logger as logging
from sim.ros.logging.console import LogConsole
from sim.ros.logging.filters import CallSite
from sim.ros.logging.logger import LoggingSeverity, get_logger
from sim.ros.logging.record import LogRecord
from tests.support.simulation import Simulation, simulate

RECORD = LogRecord(
    LoggingSeverity.WARN, "sub_node", "Odom", 1_631_462_014_163_838_534, CallSite("tick", "/a/node.py", 7, 0)
)


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def line(text: str) -> str:
    return LogConsole({"RCUTILS_CONSOLE_OUTPUT_FORMAT": text}).line(RECORD)


def test_a_line_is_as_ros_prints_it() -> None:
    assert LogConsole({}).line(RECORD) == "[WARN] [1631462014.163838534] [sub_node]: Odom"


def test_the_format_may_be_another() -> None:
    assert line("{message} {name} {severity}") == "Odom sub_node WARN"
    assert line("{function_name}@{file_name}:{line_number}") == "tick@/a/node.py:7"
    assert line("{time}|{time_as_nanoseconds}") == "1631462014.163838534|1631462014163838534"
    assert re.fullmatch(r"2021-09-1\d \d\d:\d\d:34.163", line("{date_time_with_ms}"))
    assert line(r"{nothing}{}\t{message\n") == "{nothing}{}\t{message\n"
    assert line("") == LogConsole({}).line(RECORD)


@pytest.mark.parametrize(
    ("setting", "on_terminal", "start", "end"),
    [
        ({}, False, "", ""),
        ({}, True, "\033[33m", "\033[0m"),
        ({"RCUTILS_COLORIZED_OUTPUT": "1"}, False, "\033[33m", "\033[0m"),
        ({"RCUTILS_COLORIZED_OUTPUT": "0"}, True, "", ""),
    ],
)
def test_colours_come_on_a_terminal_or_as_the_environment_says(
    monkeypatch: pytest.MonkeyPatch, setting: dict[str, str], on_terminal: bool, start: str, end: str
) -> None:
    stream = Terminal() if on_terminal else io.StringIO()
    monkeypatch.setattr("sys.stderr", stream)
    console = LogConsole(setting)
    console.write(RECORD)
    assert stream.getvalue() == f"{start}{console.line(RECORD)}{end}\n"


def test_lines_may_go_to_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    LogConsole({"RCUTILS_LOGGING_USE_STDOUT": "1"}).write(RECORD)
    LogConsole({"RCUTILS_LOGGING_USE_STDOUT": "0"}).write(RECORD)
    out, err = capsys.readouterr()
    assert out == err == "[WARN] [1631462014.163838534] [sub_node]: Odom\n"


def test_a_wrong_setting_is_told_and_does_not_count(capsys: pytest.CaptureFixture[str]) -> None:
    console = LogConsole({"RCUTILS_LOGGING_USE_STDOUT": "yes"})
    console.write(RECORD)
    out, err = capsys.readouterr()
    assert not out
    assert err.splitlines()[0] == "RCUTILS_LOGGING_USE_STDOUT is 'yes': the valid values are 1 and 0"


def test_lines_may_be_kept_from_the_console() -> None:
    def program(_: Simulation) -> None:
        for switch in ("--disable-stdout-logs", "--enable-stdout-logs"):
            context = rclpy.Context()
            context.init(["--ros-args", switch])
            get_logger("a").info(switch)

    assert simulate(program).said() == ["--enable-stdout-logs"]


def test_a_log_file_is_refused_by_name() -> None:
    def program(_: Simulation) -> None:
        with pytest.raises(NotImplementedError, match="--log-file-name"):
            rclpy.Context().init(["--ros-args", "--log-file-name", "x"])

    simulate(program)


def test_the_root_logger_has_no_name_and_places_of_its_own() -> None:
    def program(_: Simulation) -> None:
        root = logging._root_logger
        assert root.name == ""
        for logger in (root, get_logger("a")):
            for number in range(2):
                assert logger.info("once", once=True) == (number == 0)
        logging.set_logger_level("a", LoggingSeverity.ERROR)
        logging.clear_config()
        assert logging.get_logger_effective_level("a") == LoggingSeverity.INFO

    simulate(program)
