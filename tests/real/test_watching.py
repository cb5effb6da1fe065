"""Programs that others start are watched, and nothing happens to them."""

import os
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from queue import Queue
from selectors import DefaultSelector

import pytest

from cbtui import cli
from cbtui.engines.control_socket import runtime_folder
from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.shown_program import of_processes, of_robot
from sim.engine.commands import CallService, RunLine, Stop
from sim.engine.setup import RealRos
from sim.probes.on_path.cbtui_probe import PROTOCOL, TOKEN
from sim.real.probe_link import ProbeLink, processes_in
from sim.real.programs import claimed_domain
from sim.real.wire import Hello, Left, ProbeLine
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    EntityAppeared,
    LineEnded,
    LineSaid,
    ProcessAppeared,
    ProcessEnded,
    RunEnded,
    ServiceCalled,
    ThreadAppeared,
    VelocityCommanded,
)
from sim.trace.timeline import Timeline
from tests.real import programs
from tests.real.programs import needs_ros


@pytest.fixture(autouse=True)
def folder(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path_factory.mktemp("x")))
    probes = runtime_folder() / "probes"
    probes.mkdir()
    return probes


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["probe"], "probe needs a command: cbtui probe -- python3 node.py"),
        (["probe", "--", "no-such-program"], "there is no program no-such-program"),
        (["attach"], "no process can be watched: start one with cbtui probe -- COMMAND"),
        (["attach", "localhost:1"], "argument PID|HOST:PORT: 1 is not a port for a program"),
        (["attach", "localhost:65500"], "no probe listens at localhost:65500 (Connection refused)"),
        (
            ["attach", "4711"],
            "process 4711 cannot be watched: it was not started with cbtui probe, or has ended",
        ),
        (
            ["probe", "--", __file__],
            f"{__file__} is not executable; for a Python file give python3 {__file__}",
        ),
        (["probe", "python3", "node.py"], "unrecognized arguments: python3 node.py; put -- before python3"),
    ],
)
def test_what_cannot_be_watched_is_told_in_a_sentence(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        cli.main(words)
    assert ended.value.code == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(("token", "wanted"), [("", "wants a token"), ("x" * 20, "has another token")])
def test_a_probe_that_does_not_reply_lacks_its_token(
    token: str, wanted: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(TOKEN, token)
    with socket.create_server(("127.0.0.1", 0)) as server:

        def hang_up() -> None:
            server.accept()[0].close()

        threading.Thread(target=hang_up, daemon=True).start()
        where = f"127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(SystemExit, match="2"):
            cli.main(["attach", where])
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(
        f"cbtui: the probe at {where} {wanted}: give the one that cbtui probe --tcp printed"
    )


@needs_ros
@pytest.mark.slow
def test_a_process_is_watched_and_goes_on_when_nobody_watches_any_more(tmp_path: Path, folder: Path) -> None:
    file = tmp_path / "tried.py"
    file.write_text(
        programs.HEAD + programs.STARVED + programs.TAIL.format(executor="SingleThreadedExecutor()")
    )
    probe = [sys.executable, "-m", "cbtui", "probe", "--", sys.executable, str(file)]
    with subprocess.Popen(probe, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            while not (found := processes_in(folder)):
                assert process.poll() is None
                time.sleep(0.05)
            assert [hello.process for hello in found] == [process.pid]  # it has become the command
            for _ in range(2):
                events = watched(folder, found)
                assert f"tried.py-{process.pid}" in [
                    e.label for e in events if isinstance(e, ProcessAppeared)
                ]
                introduced = [type(e) for e in events if isinstance(e, ProcessAppeared | ThreadAppeared)]
                assert introduced[0] is ProcessAppeared, "the process's threads are named after it"
                assert isinstance(events[-1], RunEnded)
                assert process.poll() is None
            process.terminate()
            process.wait(timeout=60)
            assert processes_in(folder) == []
        finally:
            process.kill()


def watched(folder: Path, found: list[Hello]) -> list[AnyEvent]:
    """Watch until three callbacks have ended, and leave."""
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session = ProcessSession(
        of_processes(RealRos(watched=str(folder)), found).set_up(None, 1.0), news.put, news.put
    )
    session.start()
    events: list[AnyEvent] = []
    try:
        while isinstance(batch := news.get(timeout=60), list):
            events += batch
            if sum(isinstance(event, CallbackEnded) for event in events) >= 3:
                session.send(Stop())
    finally:
        session.stop()
    assert batch is None
    return events


@needs_ros
@pytest.mark.slow
def test_lines_and_calls_act_on_the_graph_of_what_is_watched(
    tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    domain, claim = claimed_domain()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    file = tmp_path / "tried.py"
    body = programs.CALLS_ITSELF.replace("self.client.call(", "self.client.call_async(")
    file.write_text(programs.HEAD + body + programs.TAIL.format(executor="SingleThreadedExecutor()"))
    probe = [sys.executable, "-m", "cbtui", "probe", "--", sys.executable, str(file)]
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session = ProcessSession(of_robot(folder, 5.0).set_up(None, 1.0), news.put, news.put)
    session.start()
    said: list[str] = []
    called: set[str] = set()
    moved = 0
    is_there = has_ended = False
    with claim, subprocess.Popen(probe, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            while isinstance(batch := news.get(timeout=60), list):
                if not is_there and any(isinstance(event, EntityAppeared) for event in batch):
                    is_there = True
                    session.send(RunLine(1, "ros2 topic pub -w 1 -t 30 -r 10 /cmd_vel geometry_msgs/Twist"))
                    session.send(CallService("/switch", data=True))
                said += [event.text for event in batch if isinstance(event, LineSaid)]
                called |= {e.service for e in batch if isinstance(e, ServiceCalled) and e.entity == 0}
                moved += sum(isinstance(event, VelocityCommanded) for event in batch)
                has_ended |= any(isinstance(event, LineEnded) for event in batch)
                if has_ended and called:
                    session.send(Stop())
        finally:
            session.stop()
            process.kill()
    assert batch is None
    assert sum(each.startswith("publishing #") for each in said) == 30
    # Each side of a connection is told of the other at its own time: what is said before is lost.
    assert 1 <= moved <= 30
    assert called == {"/switch"}


def test_the_heading_counts_the_processes_that_are_there() -> None:
    hello = Hello(0, PROTOCOL, 17, "3.12.3", "jazzy", ["python3", "node.py"], 0)
    subject, timeline, said = of_processes(RealRos(watched="probes"), [hello]), Timeline(), []
    for event in (ProcessAppeared(0, 1, "a"), ProcessAppeared(1, 2, "b"), ProcessEnded(2, 1, "it ended", 0)):
        timeline.extend([event])
        said.append(subject.heading_of(timeline))
    assert said == ["watched: 1 process", "watched: 2 processes", "watched: 1 process"]


def test_a_process_that_dies_in_the_middle_of_a_line_was_heard_until_then(folder: Path) -> None:
    told: list[ProbeLine] = []
    selector = DefaultSelector()
    with socket.socket(socket.AF_UNIX) as probe:
        probe.bind(str(folder / "1.sock"))
        probe.listen()
        link = ProbeLink(selector, told.extend)
        assert link.connect(folder / "1.sock")
        connection, _ = probe.accept()
        connection.sendall(b'[["left",5]]\n[["le')
        connection.close()
    while link.is_open:
        for key, _ in selector.select(1.0):
            key.data()
    assert told == [Left(5)]


def test_the_runtime_folder_is_the_users_alone(folder: Path) -> None:
    assert folder.parent.stat().st_mode & 0o077 == 0
    assert folder.stat().st_uid == os.getuid()
