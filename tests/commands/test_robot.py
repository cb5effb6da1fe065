"""``cbtui robot``: what it says, and where."""

import io
import sys
from pathlib import Path

import pytest

from cbtui import cli
from cbtui.commands import robot
from cbtui.runs.setup.shown_program import of_robot
from sim.engine.setup import RobotUse
from sim.trace.events import RobotMoved


class _Terminal(io.StringIO):
    encoding = "utf-8"

    def isatty(self) -> bool:
        return True


def moved(x: float, *, motors: bool = True, front: float = 1.5) -> RobotMoved:
    return RobotMoved(0, x, -0.0, 1.5708, front, 0.2, -0.001, motors, False, 0.0, 0.0)


@pytest.mark.parametrize(
    ("missing", "said"),
    [
        ("rclpy", "the robot needs a rclpy in cbtui's own Python: "),
    ],
)
def test_what_it_lacks_is_told_in_a_sentence(
    missing: str, said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(robot, "find_spec", lambda name: None if name == missing else name)
    with pytest.raises(SystemExit) as ended:
        cli.main(["robot"])
    assert ended.value.code == 2
    assert said in capsys.readouterr().err


def test_a_terminal_shows_where_it_is_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = _Terminal()
    monkeypatch.setattr(sys, "stdout", terminal)
    monkeypatch.setenv("COLUMNS", "70")
    monkeypatch.setattr(robot, "_PERIOD", 0.0)
    status = robot._Status()
    status.take(moved(10.0, motors=False))
    status.take(moved(2.0))
    status.take("something else")
    status.end()
    first = "at 10.00 0.00 m, 90 deg   0.20 m/s, 0.00 rad/s   1.50 m ahead   motor"
    second = "at 2.00 0.00 m, 90 deg   0.20 m/s, 0.00 rad/s   1.50 m ahead".ljust(len(first))
    assert terminal.getvalue() == f"\r{first}\r{second}\n"


def test_elsewhere_a_line_is_printed_when_it_differs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(robot, "_PERIOD", 0.0)
    status = robot._Status()
    for _ in range(3):
        status.take(moved(2.0, front=float("inf")))
    status.end()
    assert capsys.readouterr().out == "at 2.00 0.00 m, 90 deg   0.20 m/s, 0.00 rad/s   free ahead\n"


def test_its_console_is_on_the_users_graph_and_calls_its_motors() -> None:
    setup = of_robot(Path("/probes"), 5.0).set_up(None, None)
    assert setup.real is not None
    assert setup.real.watched == "/probes"
    assert (setup.robot, setup.sensor_rate) == (RobotUse.ALWAYS, 5.0)
    assert setup.service is not None
    assert setup.service.name == "/motor_power"
