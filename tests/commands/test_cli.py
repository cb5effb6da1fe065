"""The command line: what it lists, runs and refuses, each refusal in one sentence."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from cbtui import cli
from cbtui.commands.options.targets import targets_of
from lessons.catalogue import find, lessons
from lessons.progress import Progress
from lessons.puzzles import puzzles_of
from sim.engine.setup import RunSetup
from tests.support.commands import cbtui


@pytest.fixture
def no_progress(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody has opened a lesson, in this process's other tests either."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))


@pytest.mark.usefixtures("no_progress")
def test_list_names_every_lesson_in_order(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    units = {line.partition(": ")[0]: line for line in lines if not line.startswith(" ")}
    assert units.keys() == {lesson.unit for lesson in lessons()}
    assert units[lessons()[0].unit].endswith(": 0 of 8 done")
    told = [line.split() for line in lines if line.startswith(" ")]
    ids = [words[1] if words[0].isdecimal() else words[0] for words in told]
    assert ids == [
        name for lesson in lessons() for name in (lesson.id, *(puzzle.id for puzzle in puzzles_of(lesson.id)))
    ]
    assert ids[:3] == ["single-thread", "shared-group", "split-groups"]


@pytest.mark.usefixtures("no_progress")
def test_list_tells_how_far_one_is(capsys: pytest.CaptureFixture[str]) -> None:
    done, begun = lessons()[0], lessons()[1]
    store = Progress()
    for place in range(len(done.predictions)):
        store.answer(done.id, place, 0)
    store.answer(begun.id, 0, 0)
    store.see(done.id)
    store.explain(done.id)
    assert cli.main(["list"]) == 0
    told = capsys.readouterr().out
    assert f"{done.unit}: 1 of 8 done\n ✓  1  {done.id} " in told
    assert f"\n ◐  2  {begun.id} " in told
    assert f"{begun.executor}; predicted, not watched yet: run it for 30 s or to its end" in told


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["run", "split-group"], "the nearest is 'split-groups'"),
        (["open", "nonsense"], "no lesson is called 'nonsense'; cbtui list shows all"),
        (["run", "999"], " lessons, and none is number 999"),
        (["run", "single-thread", "--threads", "0"], "an executor cannot have 0 threads here; give 1 to 64"),
        (["run", "single-thread", "--threads", "two"], "'two' is not a whole number; give 1 to 64"),
        (["run", "single-thread", "--for", "-1"], "a run cannot last -1 seconds; give more than 0"),
        (["run", "single-thread", "--for", "nan"], "'nan' is not a finite number"),
        (["run", "single-thread", "--call", "-2"], "-2 s is before the run begins"),
        (
            ["run", "single-thread", "--for", "5", "--call", "5"],
            "a call at 5 s comes when the run of 5 s is over",
        ),
        (["run", "single-thread", "--speed", "0"], "time cannot pass 0 times as fast"),
        (["run", "single-thread", "--call-data", "perhaps"], "invalid choice: 'perhaps'"),
        (["run", "single-thread", "--events", "/no/such/folder/x.jsonl"], "there is no folder /no/such"),
        (["run", "single-thread", "--call"], "argument --call: give SECONDS (see cbtui run --help)"),
        (
            ["run", "single-thread", "--at", "2"],
            "argument --at: give SECONDS and LINE (see cbtui run --help)",
        ),
        (["run", "nothing_here.py"], "there is no file nothing_here.py"),
        (["run", __file__.replace("cli.py", "cly.py")], "; the nearest is test_cli.py; give a Python file"),
        (["run", __file__, "mine"], "there is no file mine; for an argument of the program, put -- before"),
        (["run", "my_package", "talker"], "no lesson is called 'my_package'; cbtui list shows all"),
        (["rnu"], "cbtui: there is no command 'rnu'; did you mean run? (see cbtui --help)"),
        (["run", "./"], "is a folder; name the file in it to run"),
        (["run", "single-thread", "--", "-x"], "a lesson has its own arguments"),
        (["run"], "LESSON"),
        (["fly"], "cbtui: there is no command 'fly' (see cbtui --help)"),
        (["open", "single-thread"], "the console needs a terminal"),
        ([], "the console needs a terminal"),
    ],
)
def test_a_wrong_command_is_refused_in_one_line(arguments: list[str], sentence: str) -> None:
    done = cbtui(*arguments)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert sentence in done.stderr


@pytest.mark.parametrize("command", [["run"], ["explore"], ["open"], ["prove"], ["compare", "single-thread"]])
@pytest.mark.parametrize(
    ("target", "sentence"),
    [
        ("notes.txt", "notes.txt is no program, by its name; give a Python file (.py) or a launch file"),
        ("./notes.txt", "./notes.txt is no program, by its name; give a Python file (.py) or a launch file"),
        ("folder", "folder is a folder; name the file in it to run"),
    ],
)
def test_a_file_that_is_no_program_is_refused_as_a_file(
    command: list[str],
    target: str,
    sentence: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "notes.txt").write_text("plain words")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit, match="2"):
        cli.main([*command, target])
    assert capsys.readouterr() == ("", f"cbtui: {sentence}\n")


def test_a_lesson_takes_precedence_over_a_folder_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "single-thread").mkdir()
    monkeypatch.chdir(tmp_path)
    assert targets_of(["single-thread"]).lesson is find("single-thread")


@pytest.mark.parametrize(
    ("arguments", "clock"),
    [
        (["single-thread"], "virtual"),
        (["single-thread", "--clock", "real"], "real"),
        (["two-threads-no-faster"], "real"),
        (["two-threads-no-faster", "--clock", "virtual"], "virtual"),
        ([__file__], "real"),
        ([__file__, "--clock", "virtual"], "virtual"),
    ],
)
def test_run_takes_the_clock_that_is_asked_for_or_the_lessons_own(
    arguments: list[str], clock: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    clocks: list[str] = []

    def run_headless(program: RunSetup, **_options: object) -> int:
        clocks.append(program.clock)
        return 0

    monkeypatch.setattr("cbtui.runs.headless.headless.run_headless", run_headless)
    assert cli.main(["run", *arguments]) == 0
    assert clocks == [clock]


def test_run_puts_the_log_on_stderr_as_ros_prints_it_and_a_summary_on_stdout() -> None:
    done = cbtui("run", "exclusive-2-threads", "--for", "10", "--call", "2.55", "--call-data", "false")
    assert done.returncode == 0
    log = done.stderr.splitlines()
    assert log[0] == "[WARN] [1700000000.000000000] [service_start_turn]: Setting exclusive Groups"
    assert "[INFO] [1700000003.000000000] [service_start_turn]: TICK" in log
    assert "timer_callback" in done.stdout
    assert "1 call" in done.stdout


@pytest.mark.slow
@pytest.mark.usefixtures("fresh_engines")
def test_events_are_one_json_object_a_line_and_the_same_each_time(tmp_path: Path) -> None:
    files = [tmp_path / "once.jsonl", tmp_path / "again.jsonl"]
    for file in files:
        arguments = ("run", "reentrant-1-thread", "--for", "9", "--call", "2.55", "--events", str(file))
        assert cbtui(*arguments).returncode == 0
    assert files[0].read_bytes() == files[1].read_bytes()
    lines = [json.loads(line) for line in files[0].read_text().splitlines()]
    kinds = {line["event"] for line in lines}
    assert {"callback_start", "callback_end", "wait_start", "wait_end", "publish"} <= kinds
    assert {"service_call", "service_reply", "log", "robot"} <= kinds
    wait = next(line for line in lines if line["event"] == "wait_start")
    assert (wait["t"], wait["callback"], wait["held_by"]) == (3.0, "timer_callback", "SetBool_callback")
    reply = next(line for line in lines if line["event"] == "service_reply")
    assert "TURNING" in reply["response"]
    robot = next(line for line in lines if line["event"] == "robot")
    assert {"x", "y", "yaw", "front"} <= robot.keys()


SERVER = """
import sys
import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class Server(Node):
    def __init__(self):
        super().__init__("server")
        self.create_service(SetBool, "switch", self.answer)

    def answer(self, request, response):
        self.get_logger().info(f"{sys.argv[1]} {request.data}")
        return response


def main():
    rclpy.init()
    rclpy.spin(Server())
"""


@pytest.mark.parametrize("ending", ["", "\n\nif __name__ == '__main__':\n    main()\n"])
def test_a_file_runs_with_its_arguments_and_its_own_service_is_called(tmp_path: Path, ending: str) -> None:
    (tmp_path / "server.py").write_text(SERVER + ending)
    file = str(tmp_path / "server.py")
    done = cbtui("run", file, "--clock", "virtual", "--for", "2", "--call", "1", "--", "hello")
    assert done.returncode == 0
    assert done.stderr == "[INFO] [1700000001.000000000] [server]: hello True\n"
    assert "/switch  1 call" in done.stdout


def test_a_file_runs_on_the_real_clock_unless_told_otherwise(tmp_path: Path) -> None:
    (tmp_path / "one.py").write_text("print('one')")
    done = cbtui("run", str(tmp_path / "one.py"), "--for", "5")
    assert done.returncode == 0
    assert done.stdout.startswith("one\none.py, ")
    assert "of real time: the program returned" in done.stdout


def test_a_program_that_fails_gives_exit_code_1_and_one_sentence_after_its_traceback(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Without PyBullet there is no robot, and the sentence says what to do.
    (tmp_path / "pybullet.py").write_text("raise ImportError('no wheel for this Python')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    command = [sys.executable, "-m", "cbtui", "run", "single-thread", "--for", "1"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    [sentence] = done.stderr.splitlines()
    assert "PyBullet" in sentence
    assert "Traceback" not in done.stderr + done.stdout


def test_help_imports_nothing_heavy() -> None:
    heavy = "{'textual', 'rich', 'numpy', 'pybullet', 'rosbags', 'attrs', 'asyncio', 'importlib.metadata'}"
    script = f"""
import sys
from cbtui.cli import main
try:
    main(["--help"])
except SystemExit:
    pass
print("heavy:", sorted({heavy} & set(sys.modules)))
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "heavy: []"
