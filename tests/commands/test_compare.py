"""``cbtui compare`` from the command line: what is given to the runs, and what is refused."""

from pathlib import Path

import pytest

from cbtui import cli
from tests.recording.files import write
from tests.support.commands import cbtui
from tests.trace.samples import FULL

_CALLS_OUT_OF_TIME = """
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger

rclpy.init()
node = Node("asker")
client = node.create_client(Trigger, "/nobody")

def tick():
    client.call(Trigger.Request(), timeout_sec=0.1)

node.create_timer(0.9, tick, callback_group=ReentrantCallbackGroup())
executor = MultiThreadedExecutor(2)
executor.add_node(node)
executor.spin()
"""
"""Kilted raises TimeoutError where Jazzy returns None."""

_ENDS_BY_ITSELF = """
import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("counter")
calls = []

def tick():
    calls.append(None)
    if False and len(calls) == 4:
        raise SystemExit

node.create_timer(0.5, tick)
rclpy.spin(node)
"""


def told(*words: str) -> str:
    done = cbtui(*words)
    assert done.returncode == 0, done.stderr
    return done.stdout


def figures(text: str, section: str, label: str) -> list[str]:
    """What a row of a section tells of both runs, and of the difference."""
    lines = iter(text.splitlines())
    assert section in lines
    row = next(line for line in lines if line.startswith(f"  {label}"))
    return [cell.strip() for cell in row.removeprefix(f"  {label}").split("  ") if cell.strip()]


def test_a_lesson_can_be_compared_with_itself_with_other_threads() -> None:
    words = ("--to", "8", "--call", "2.55", "--threads-a", "2", "--threads-b", "1")
    text = told("compare", "reentrant-2-threads", "reentrant-2-threads", *words)
    assert text.startswith(
        "run A  reentrant-2-threads, 2 threads\nrun B  reentrant-2-threads, 1 thread\n0 to 8 s\n"
    )
    assert figures(text, "timer_callback", "calls") == ["7", "3", "4 fewer"]
    assert "  run B waits: no free worker" in text.splitlines()


def test_a_callback_that_is_not_there_cannot_be_put_into_another_group() -> None:
    done = cbtui("compare", "split-groups", "split-groups", "--to", "1", "--group-a", "odo_callback=own")
    assert (done.returncode, done.stdout) == (2, "")
    there = "there are odom_callback, scan_callback, timer_callback; did you mean odom_callback?"
    assert done.stderr.endswith(f"no callback is named odo_callback; {there}\n")
    assert len(done.stderr.splitlines()) == 1


def test_a_lesson_can_be_compared_with_itself_with_a_callback_in_another_group() -> None:
    groups = ("--group-a", "scan_callback=own", "--group-b", "odom_callback=own")
    words = ("--for", "8", "--call", "2.55", *groups, "--threads-b", "2")
    text = told("compare", "shared-group", "shared-group", *words)
    runs = "run A  shared-group, scan own group\nrun B  shared-group, odom own group, 2 threads\n"
    assert f"{runs}0 to 8 s\n" in text
    assert figures(text, "odom_callback", "lost")[2].endswith("fewer")


def test_a_lesson_can_be_compared_with_itself_with_another_period_of_a_timer() -> None:
    period = ("--period-b", "timer_callback=2")
    text = told("compare", "reentrant-2-threads", "reentrant-2-threads", "--to", "8.1", *period)
    assert "run B  reentrant-2-threads, timer every 2 s" in text.splitlines()
    one, other, _ = figures(text, "timer_callback", "calls")
    assert int(one) > int(other) == 4


def test_a_program_can_be_compared_with_itself_on_another_release(tmp_path: Path) -> None:
    node = tmp_path / "node.py"
    node.write_text(_CALLS_OUT_OF_TIME)
    distros = ("--distro-a", "jazzy", "--distro-b", "kilted")
    done = cbtui("compare", str(node), str(node), *distros, "--to", "3")
    assert f"run B  {node}, kilted@9.1.2" in done.stdout.splitlines()
    assert "Run B ended at 1.9 s with an exception; run A has none up to 3 s." in " ".join(
        done.stdout.split()
    )
    assert figures(done.stdout, "tick", "calls") == ["2", "2", "same"]
    assert (done.returncode, "TimeoutError" in done.stderr) == (1, True)


def test_a_run_that_ends_early_is_compared_until_then_and_that_is_told(tmp_path: Path) -> None:
    short, long = tmp_path / "short.py", tmp_path / "long.py"
    long.write_text(_ENDS_BY_ITSELF)
    short.write_text(_ENDS_BY_ITSELF.replace("if False", "if True"))
    assert "\n0 to 2 s; run B is 10 s long\n" in told("compare", str(short), str(long), "--to", "10")


def test_of_a_run_that_fails_before_anything_runs_is_told_that_it_did_and_the_other_did_not(
    tmp_path: Path,
) -> None:
    failing, well = tmp_path / "failing.py", tmp_path / "well.py"
    well.write_text(_ENDS_BY_ITSELF)
    failing.write_text(_ENDS_BY_ITSELF.replace("0.5, tick", "0.5, tock"))
    done = cbtui("compare", str(failing), str(well), "--to", "5")
    assert "\nat 0 s; run B is 5 s long\nGone in run B: exception. Run A ended at 0 s with" in done.stdout
    assert done.stdout.endswith("whole program\n  no callback runs in either, at 0 s\n")


@pytest.mark.slow
def test_lines_and_calls_reach_both_runs() -> None:
    line = "ros2 service call /dummy_server_srv std_srvs/srv/SetBool '{data: true}'"
    words = ("--to", "3", "--call", "1.2", "--at", "0.5", line)
    text = told("compare", "reentrant-2-threads", "exclusive-2-threads", *words)
    assert figures(text, "SetBool_callback", "calls")[0] in ("1", "2")
    alone = told("compare", "reentrant-2-threads", "exclusive-2-threads", "--to", "3", "--call", "1.2")
    assert alone != text


@pytest.mark.slow
def test_what_is_run_gets_the_inputs_of_a_recording_and_lasts_as_long(tmp_path: Path) -> None:
    recording = str(tmp_path / "run.mcap")
    told("run", "exclusive-2-threads", "--for", "3", "--at", "1.2", "ros2 topic list", "--record", recording)
    text = told("compare", "exclusive-2-threads", "reentrant-1-thread", "--inputs", recording)
    assert "0 to 3 s" in text.splitlines()
    text = told("compare", recording, "exclusive-2-threads", "--inputs", recording)
    rows = [line for line in text.splitlines() if line.startswith("  ") and "run A" not in line]
    assert {line.split()[0] for line in rows} == {"calls", "wait", "late", "threads", "at"}
    assert all(line.endswith("same") for line in rows)


@pytest.fixture
def recording(tmp_path: Path) -> str:
    path = tmp_path / "run.mcap"
    write(path, FULL)
    return str(path)


@pytest.fixture
def node(tmp_path: Path) -> str:
    path = tmp_path / "node.py"
    path.write_text("")
    return str(path)


LESSONS = ["single-thread", "split-groups"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([*LESSONS, "--from", "x"], "'x' is not a number; give seconds"),
        ([*LESSONS, "--to", "0"], "a run cannot last 0 seconds"),
        ([*LESSONS, "--from", "9", "--to", "9"], "nothing is left to compare from 9 s to 9 s"),
        ([*LESSONS, "--call", "-1"], "-1 s is before the run begins"),
        (
            [*LESSONS, "--call", "61"],
            "a call at 61 s comes after the 60 s that are compared; give --for",
        ),
        ([*LESSONS, "--at", "5", "ros2 topic list", "--to", "5"], "a line at 5 s comes after the 5 s"),
        ([*LESSONS, "--at", "soon", "ros2 topic list"], "'soon' is not a number"),
        ([*LESSONS, "--threads-a", "0"], "an executor cannot have 0 threads here"),
        ([*LESSONS, "--threads-b", "two"], "'two' is not a whole number"),
        ([*LESSONS, "--inputs", "/no.mcap"], "/no.mcap cannot be read"),
        ([*LESSONS, "--inputs", "RECORDING", "--call", "1"], "leave out --call and --at"),
        ([*LESSONS, "--", "-some"], "only a file takes arguments; leave out what follows --"),
        (["RECORDING", "single-thread", "--threads-a", "2"], "leave out --threads-a"),
        (["single-thread", "RECORDING", "--threads-b", "2"], "leave out --threads-b"),
        (["single-thread", "RECORDING", "--group-b", "timer_callback=own"], "leave out --group-b"),
        (["single-thread", "RECORDING", "--period-b", "timer_callback=1"], "leave out --period-b"),
        (["single-thread", "RECORDING", "--distro-b", "kilted"], "leave out --distro-b"),
        ([*LESSONS, "--distro-a", "noetic"], "'noetic' is no distribution; give humble, jazzy"),
        ([*LESSONS, "--on-a", "ros2", "--distro-a", "jazzy"], "leave out --distro-a; --python-a names"),
        (["RECORDING", "RECORDING", "--call", "1"], "nothing is run; leave out --call"),
        (["RECORDING", "RECORDING", "--at", "1", "ros2 topic list"], "nothing is run; leave out --at"),
        (["RECORDING", "RECORDING", "--inputs", "RECORDING"], "nothing is run; leave out --inputs"),
        (["RECORDING", "RECORDING", "--from", "1000"], "nothing is left to compare from 1000 s"),
        (["RECORDING", "single-thread", "--on-a", "ros2"], "stays as it is; leave out --on-a"),
        (["RECORDING", "single-thread", "--python-a", "python3"], "give --on-a ros2 with it"),
        ([*LESSONS, "--on-b", "ros2", "--python-b", "/no/python3"], "--python-b /no/python3: there is no"),
        ([*LESSONS, "--on-b", "ros2", "--inputs", "RECORDING"], "cannot be repeated; leave out --inputs"),
        (["single-thread"], "required: B"),
        (["NODE", "/no/such.py"], "there is no file /no/such.py"),
        (["/tmp/", "NODE"], "is a folder; name the file in it"),
        (["nothing", "NODE"], "no lesson is called 'nothing'"),
    ],
)
def test_what_cannot_be_compared_is_refused_in_one_sentence(
    words: list[str], sentence: str, recording: str, node: str, capsys: pytest.CaptureFixture[str]
) -> None:
    files = {"RECORDING": recording, "NODE": node}
    try:
        code = cli.main(["compare", "--text", *(files.get(word, word) for word in words)])
    except SystemExit as left:
        code = int(str(left.code))
    told = capsys.readouterr()
    assert (code, told.out) == (2, "")
    assert sentence in told.err
    assert len(told.err.splitlines()) == 1


@pytest.mark.parametrize(
    ("text", "code", "told"),
    [
        ("def (:\n", 1, "\ncbtui: it.py:1: invalid syntax\n"),
        (
            "import rclpy\nrclpy.init()\nrclpy.create_node('n')\n",
            2,
            "cbtui: nothing is left to compare, it.py ended at 0 s: the program returned\n",
        ),
    ],
)
def test_a_run_that_ends_at_once_is_named_with_its_reason_once(
    text: str,
    code: int,
    told: str,
    node: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("it.py").write_text(text)
    assert cli.main(["compare", "--text", node, "it.py", "--for", "1"]) == code
    assert capsys.readouterr().err.endswith(told)
