"""Lines from other terminals: they reach the run, their answers come back, and nobody else gets in."""

import os
import stat
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from queue import Queue

import pytest

from cbtui import cli
from cbtui.engines.control_socket import (
    ControlServer,
    LineOutput,
    LineResult,
    NoEngine,
    RemoteLine,
    UnusableFolderError,
    connect,
    runtime_folder,
)
from cbtui.engines.listening import ListeningSession
from cbtui.runs.setup.lesson_setup import RunRequest
from sim.engine.commands import Command, InterruptLine, RunLine
from sim.trace.events import LineEnded, LineSaid

PATIENCE = 60


@pytest.fixture
def sent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> "Queue[Command]":
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return Queue()


@pytest.fixture
def server(sent: "Queue[Command]") -> Iterator[ControlServer]:
    before = set(threading.enumerate())
    server = ControlServer(sent.put, "One shared group")
    server.start()
    yield server
    server.stop()
    end = time.monotonic() + PATIENCE
    while not set(threading.enumerate()) <= before:
        assert time.monotonic() < end, "a thread is left"
        time.sleep(0.001)


def given(sent: "Queue[Command]") -> RunLine:
    command = sent.get(timeout=PATIENCE)
    assert isinstance(command, RunLine)
    return command


def test_a_line_reaches_the_run_and_gets_its_own_answers(
    server: ControlServer, sent: "Queue[Command]"
) -> None:
    first = RemoteLine(connect(None), "ros2 topic list")
    second = RemoteLine(connect(os.getpid()), "ros2 node list")
    numbers = {command.text: command.line for command in (given(sent), given(sent))}
    one, two = numbers["ros2 topic list"], numbers["ros2 node list"]
    server.take(
        [LineSaid(0, one, "/odom", False), LineSaid(0, two, "/node", False), LineSaid(0, 1, "x", False)]
    )
    server.take([LineSaid(1, one, "oh", True), LineEnded(1, one, 0), LineEnded(1, two, 1)])
    assert [first.next_answer() for _ in range(3)] == [
        LineOutput("/odom", False),
        LineOutput("oh", True),
        LineResult(0),
    ]
    assert [second.next_answer() for _ in range(2)] == [LineOutput("/node", False), LineResult(1)]


def test_an_interruption_and_a_client_that_goes_away_end_the_line(
    server: ControlServer, sent: "Queue[Command]"
) -> None:
    asked = RemoteLine(connect(None), "ros2 topic echo /odom")
    line = given(sent).line
    asked.interrupt()
    assert sent.get(timeout=PATIENCE) == InterruptLine(line)
    server.take([LineEnded(0, line, 2)])
    assert asked.next_answer() == LineResult(2)
    left = connect(None)
    RemoteLine(left, "ros2 topic echo /odom")
    line = given(sent).line
    left.close()
    assert sent.get(timeout=PATIENCE) == InterruptLine(line)


@pytest.mark.parametrize("others", [0, 1])
def test_where_several_runs_listen_the_one_that_answers_is_named(
    server: ControlServer, sent: "Queue[Command]", capsys: pytest.CaptureFixture[str], others: int
) -> None:
    (path,) = runtime_folder().iterdir()
    if others:
        os.link(path, path.with_name("1.sock"))
    client = threading.Thread(target=cli.main, args=(["ros2", "topic", "list"],))
    client.start()
    line = given(sent).line
    server.take([LineSaid(0, line, "/odom", False), LineEnded(0, line, 0)])
    client.join()
    who = f"cbtui: process {os.getpid()} answers: One shared group; --engine chooses another one\n"
    assert capsys.readouterr() == ("/odom\n", who if others else "")


def test_the_end_of_the_run_ends_every_line(server: ControlServer, sent: "Queue[Command]") -> None:
    asked = RemoteLine(connect(None), "ros2 topic echo /odom")
    given(sent)
    server.stop()
    assert asked.next_answer() == LineResult(None)


def test_a_line_for_a_run_whose_console_outlives_it_gets_one_sentence(
    sent: "Queue[Command]", tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "node.py"
    program.write_text("raise ValueError")
    ended = Queue[str | None]()
    session = ListeningSession(RunRequest(files=[program]).setup(), lambda events: None, ended.put)
    session.start()
    try:
        assert ended.get(timeout=PATIENCE) is None
        assert cli.main(["ros2", "topic", "list"]) == 1
    finally:
        session.stop()
    over = "cbtui: that run is over; run it again, or open another one\n"
    assert capsys.readouterr() == ("", over)


def test_a_line_that_runs_when_the_run_ends_is_told(server: ControlServer, sent: "Queue[Command]") -> None:
    asked = RemoteLine(connect(None), "ros2 topic echo /odom")
    given(sent)
    server.over()
    assert asked.next_answer() == LineResult(None)


def test_nonsense_on_the_socket_does_no_harm(server: ControlServer, sent: "Queue[Command]") -> None:
    nonsense = connect(None)
    nonsense.send_bytes(b"\xff\x00nonsense")
    nonsense.close()
    asked = RemoteLine(connect(None), "ros2 topic list")
    assert given(sent).text == "ros2 topic list"
    asked.interrupt()


def test_without_a_run_there_is_nothing_to_connect_to(sent: "Queue[Command]") -> None:
    with pytest.raises(NoEngine, match=f"no run listens in {runtime_folder()}"):
        connect(None)
    with pytest.raises(NoEngine, match=f"no run of process 1 listens in {runtime_folder()}"):
        connect(1)


def test_a_socket_that_a_killed_run_left_is_removed(sent: "Queue[Command]") -> None:
    server = ControlServer(sent.put)
    server.start()
    (path,) = runtime_folder().iterdir()
    left = path.with_name("1.sock")
    os.link(path, left)
    server.stop()
    with pytest.raises(NoEngine):
        connect(None)
    assert not left.exists()


def test_a_run_that_ends_while_the_sockets_are_looked_through_hides_no_other(server: ControlServer) -> None:
    (runtime_folder() / "1.sock").symlink_to("gone")
    connect(None).close()


def belong_to_another_user(folder: Path) -> None:
    if os.geteuid() != 0:
        pytest.skip("only root can give a folder away")
    os.chown(folder, 65534, 65534)


def be_a_file(folder: Path) -> None:
    folder.rmdir()
    folder.touch()


def lie_nowhere(folder: Path) -> None:
    folder.rmdir()
    folder.parent.rmdir()


@pytest.fixture(
    params=[
        (lambda folder: folder.chmod(0o770), "is open to other users, until chmod 700 closes it"),
        (belong_to_another_user, "belongs to another user"),
        (be_a_file, "cannot be made: File exists"),
        (lie_nowhere, "cannot be made: No such file or directory"),
    ]
)
def why_refused(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Why the folder of the sockets is refused."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "above"))
    (tmp_path / "above").mkdir()
    folder = runtime_folder()
    spoil, why = request.param
    spoil(folder)
    return f"{folder} {why}"


def test_a_folder_of_sockets_that_others_may_have_touched_is_refused_in_a_sentence(why_refused: str) -> None:
    with pytest.raises(UnusableFolderError) as refused:
        runtime_folder()
    assert str(refused.value) == why_refused
    with pytest.raises(NoEngine) as none:
        connect(None)
    assert str(none.value) == f"no run can be looked for ({why_refused})"


def test_a_run_without_a_console_that_cannot_listen_says_so(
    why_refused: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "node.py"
    program.write_text("print('done')")
    assert cli.main(["run", str(program), "--for", "1"]) == 0
    said = capsys.readouterr().err.splitlines()[0]
    assert said == (
        f"cbtui: lines of cbtui ros2 do not reach this run: {why_refused}; "
        "set XDG_RUNTIME_DIR to a folder of your own"
    )


def test_a_path_that_is_too_long_for_a_socket_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    above = tmp_path / ("long" * 30)
    above.mkdir()
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(above))
    sentence = ControlServer(lambda command: None).start()
    assert sentence is not None
    assert "path too long" in sentence


def test_a_line_that_finds_no_run_says_where_it_looked(
    sent: "Queue[Command]", capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["ros2", "pkg", "list"]) == 0
    said = capsys.readouterr()
    assert said.err == (
        f"cbtui: no run listens in {runtime_folder()}, so this line runs in an engine of its own; to reach "
        "a run, give its terminal and this one the same XDG_RUNTIME_DIR, a folder of your own\n"
    )
    assert "unit5_pkg" in said.out.split()


def test_only_the_owner_may_enter_the_folder(sent: "Queue[Command]") -> None:
    assert stat.S_IMODE(runtime_folder().stat().st_mode) == 0o700
