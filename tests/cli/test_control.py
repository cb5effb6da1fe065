"""Lines from other terminals: they reach the run, their answers come back, and nobody else gets in."""

import os
import stat
import threading
from collections.abc import Iterator
from pathlib import Path
from queue import Queue

import pytest

from cbtui.control import ControlServer, Done, NoEngine, RemoteLine, Said, connect, runtime_folder
from sim.engine.commands import Command, InterruptLine, RunLine
from sim.trace.events import LineEnded, LineSaid

PATIENCE = 10


@pytest.fixture
def sent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> "Queue[Command]":
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return Queue()


@pytest.fixture
def server(sent: "Queue[Command]") -> Iterator[ControlServer]:
    before = threading.active_count()
    server = ControlServer(sent.put)
    server.start()
    yield server
    server.stop()
    for thread in threading.enumerate():
        if thread.name == "control":
            thread.join(PATIENCE)
    assert threading.active_count() == before


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
    assert [first.next_answer() for _ in range(3)] == [Said("/odom", False), Said("oh", True), Done(0)]
    assert [second.next_answer() for _ in range(2)] == [Said("/node", False), Done(1)]


def test_an_interruption_and_a_client_that_goes_away_end_the_line(
    server: ControlServer, sent: "Queue[Command]"
) -> None:
    asked = RemoteLine(connect(None), "ros2 topic echo /odom")
    line = given(sent).line
    asked.interrupt()
    assert sent.get(timeout=PATIENCE) == InterruptLine(line)
    server.take([LineEnded(0, line, 2)])
    assert asked.next_answer() == Done(2)
    left = connect(None)
    RemoteLine(left, "ros2 topic echo /odom")
    line = given(sent).line
    left.close()
    assert sent.get(timeout=PATIENCE) == InterruptLine(line)


def test_the_end_of_the_run_ends_every_line(server: ControlServer, sent: "Queue[Command]") -> None:
    asked = RemoteLine(connect(None), "ros2 topic echo /odom")
    given(sent)
    server.stop()
    assert asked.next_answer() == Done(None)


def test_nonsense_on_the_socket_does_no_harm(server: ControlServer, sent: "Queue[Command]") -> None:
    nonsense = connect(None)
    nonsense.send_bytes(b"\xff\x00nonsense")
    nonsense.close()
    asked = RemoteLine(connect(None), "ros2 topic list")
    assert given(sent).text == "ros2 topic list"
    asked.interrupt()


def test_without_a_run_there_is_nothing_to_connect_to(sent: "Queue[Command]") -> None:
    with pytest.raises(NoEngine, match="no run listens"):
        connect(None)
    with pytest.raises(NoEngine, match="no run of process 1 listens"):
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


def test_only_the_owner_may_enter_the_folder(sent: "Queue[Command]") -> None:
    folder = runtime_folder()
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    folder.chmod(0o777)
    with pytest.raises(PermissionError, match="is open to others"):
        runtime_folder()
    with pytest.raises(NoEngine):
        connect(None)
