"""Exercises are judged on real ROS 2 as on the model."""

import re
from pathlib import Path
from threading import Event

import pytest

from cbtui import cli
from cbtui.commands.grade import SUSPICIOUS
from cbtui.commands.options import changes
from cbtui.learning.outcome import OutcomeRun
from cbtui.runs.judged.checking import ObservedRun, real_limit
from cbtui.runs.setup.lesson_setup import setup_to_judge
from cbtui.runs.setup.shown_program import of_exercise
from lessons.catalogue import find
from sim.engine.setup import RealRos, RunSetup
from sim.trace.timeline import Timeline
from tests.real.programs import needs_ros


@pytest.fixture
def lesson(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A lesson of a few seconds, in the current folder; a busy machine may let one call in two fall out."""
    monkeypatch.chdir(tmp_path)
    assert cli.main(["new-lesson", "blinker"]) == 0
    description = tmp_path / "blinker" / "lesson.toml"
    description.write_text(description.read_text().replace("seconds = 10", "seconds = 6.5"))
    checks = tmp_path / "blinker" / "checks.py"
    checks.write_text(checks.read_text().replace("at_least=1.5", "at_least=1"))
    monkeypatch.setenv("CBTUI_LESSONS", str(tmp_path))
    return tmp_path / "blinker"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--on", "ros2", "--seed", "3"], "real ROS 2 runs on the real clock and in its own order"),
        (["--on", "ros2"], "has no rclpy; name a Python that has it with --python"),
        (["--on", "ros2", "--python", "no-such"], "--python no-such: there is no such program"),
        (["--python", "python3"], "--python names the Python of a real ROS 2: give --on ros2 with it"),
        (["--on", "ros1"], "argument --on: invalid choice: 'ros1'"),
    ],
)
def test_what_cannot_be_checked_on_real_ros_is_refused_in_a_sentence(
    words: list[str], said: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(changes, "_wheels_of", lambda _: None)
    with pytest.raises(SystemExit) as ended:
        cli.main(["check", "split-groups", __file__, *words])
    told = capsys.readouterr()
    assert (ended.value.code, told.out) == (2, "")
    assert said in told.err
    assert len(told.err.splitlines()) == 1


def test_on_the_real_clock_a_run_may_take_its_length_and_the_limit() -> None:
    lesson = find("split-groups")
    assert real_limit(setup_to_judge(lesson), 20) == 20
    assert real_limit(setup_to_judge(lesson, real=RealRos()), 20) == 20 + lesson.run.seconds


FORGED = """
import gc
import threading
import time
import cbtui_probe
import rclpy

def lie(recorder):
    while True:
        recorder.put("cmd_vel", time.monotonic_ns(), 0.0, 0.5)
        time.sleep(0.1)

recorder = next(each for each in gc.get_objects() if type(each).__name__ == "Recorder")
threading.Thread(target=lie, args=(recorder,), daemon=True).start()
"""


def test_a_lessons_answers_are_read_off_a_run_on_the_ros_that_it_runs_on() -> None:
    asked: list[RunSetup] = []

    def observe(setup: RunSetup, _name: str, _given_up: Event) -> ObservedRun:
        asked.append(setup)
        return ObservedRun(Timeline(), "it was broken off", broken_off=True)

    lesson = find("reentrant-1-thread")
    for real in (None, RealRos("python3")):
        assert OutcomeRun(lesson, observe, real).run().trouble == "it was broken off"
    assert [setup.real for setup in asked] == [None, RealRos("python3")]
    assert asked[1].calls == asked[0].calls
    assert asked[1].until == asked[0].until


def test_an_exercise_on_screen_runs_as_it_is_judged_on_real_ros() -> None:
    lesson, real = find("split-groups"), RealRos()
    shown = of_exercise(lesson, [lesson], Path(__file__), real)
    assert shown.set_up(None, None) == setup_to_judge(lesson, Path(__file__), real=real)


@needs_ros
@pytest.mark.slow
def test_submissions_are_graded_on_real_ros_and_liars_are_found(
    lesson: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    solution = (lesson / "solution.py").read_text()
    starter = (lesson / "starter.py").read_text()
    for learner, text in (("ann", solution), ("bob", starter), ("eve", FORGED + solution)):
        (tmp_path / "homework" / learner).mkdir(parents=True)
        (tmp_path / "homework" / learner / "blinker.py").write_text(text)
    capsys.readouterr()
    assert cli.main(["grade", "homework", "--on", "ros2"]) == SUSPICIOUS
    ann, bob, eve, *missed = capsys.readouterr().out.splitlines()
    assert ann == "1/1  ann  blinker"
    assert bob == "0/1  bob  blinker"
    assert eve.startswith("0/1  eve  blinker  suspicious: blinker.py:5 imports cbtui_probe")
    assert "the program tells, as if it were the run, of the run or of the robot" in eve
    assert missed[1] == "Missed most:"
    assert missed[2].startswith("  1 of 2  blinker: ")


@needs_ros
@pytest.mark.bulk
def test_a_lesson_is_compared_with_itself_on_real_ros(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["reentrant-2-threads"] * 2 + ["--text", "--on-b", "ros2", "--to", "4.9", "--call", "1.2"]
    assert cli.main(["compare", *words]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[:2] == ["run A  reentrant-2-threads", "run B  reentrant-2-threads, on real ROS 2"]
    rows = lines[lines.index("timer_callback") + 1 :]
    assert rows[0].split() == ["calls", "4", "4", "same"]


@needs_ros
@pytest.mark.slow
@pytest.mark.parametrize(("file", "code"), [("solution.py", 0), ("starter.py", 1)])
def test_a_file_is_checked_on_real_ros(
    lesson: Path, file: str, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    ended = cli.main(["check", "blinker", str(lesson / file), "--on", "ros2"])
    told = capsys.readouterr()
    assert ended == code, told.out
    assert ("1 of 1 checks passed" in told.out) is (code == 0)
    assert re.fullmatch(rf"({re.escape(file)} runs: .* of 6\.5 s\n)*", told.err), "progress and nothing else"
