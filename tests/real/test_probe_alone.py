"""The probe by itself: in any Python, at its socket."""

import ast
import os
import shutil
import socket
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import pytest

from sim.probes.on_path.cbtui_probe import FOLLOW, PORT, TOKEN, callbacks
from sim.probes.on_path.cbtui_probe.callbacks import Calls
from sim.probes.on_path.cbtui_probe.consoles import Console as ConsoleLink
from sim.probes.on_path.cbtui_probe.consoles import lines
from sim.probes.on_path.cbtui_probe.latest import Latest
from sim.probes.on_path.cbtui_probe.recorder import Recorder, now
from sim.probes.on_path.cbtui_probe.sockets import Server
from sim.probes.on_path.cbtui_probe.turns import Turns
from sim.real.probe_link import process_at, processes_in, sockets_in
from sim.real.programs import ON_PATH
from sim.real.wire import Hello, Left, decode_lines
from sim.trace.events import EventsLost, Notice

VERSIONS = ("3.10", "3.12", "3.13", "3.14")


def test_the_probe_imports_nothing_but_python_and_rclpy() -> None:
    for path in ON_PATH.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = []
            if isinstance(node, ast.Import):
                names = [each.name for each in node.names]
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                names = [node.module or ""]
            roots = {name.partition(".")[0] for name in names}
            assert roots <= {*sys.stdlib_module_names, "rclpy", "cbtui_probe"}, path


def python_of(version: str) -> str:
    """A Python of that version, as pyenv has it or the path; skips where there is none."""
    kept = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    found = next(map(str, kept.glob(f"{version}.*/bin/python")), None) or shutil.which(f"python{version}")
    return found or pytest.skip(f"no Python {version} is installed")


@pytest.mark.parametrize("version", VERSIONS)
def test_every_python_of_ros_can_run_it(version: str) -> None:
    code = "import cbtui_probe.callbacks, cbtui_probe.recorder, cbtui_probe.sockets, cbtui_probe.starting"
    done = subprocess.run(
        [python_of(version), "-c", code],
        env={**os.environ, "PYTHONPATH": str(ON_PATH)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_another_sitecustomize_is_run_too(tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text("print('mine')\n")
    path = os.pathsep.join([str(ON_PATH), str(tmp_path)])
    done = subprocess.run(
        [sys.executable, "-c", "print('program')"],
        env={**os.environ, "PYTHONPATH": path, "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.split() == ["mine", "program"]


@pytest.fixture
def recorder() -> Recorder:
    return Recorder()


@pytest.fixture
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("p")


@pytest.fixture
def server(recorder: Recorder, folder: Path) -> Iterator[Server]:
    server = Server(recorder, lambda: None, Turns())
    server.start(str(folder))
    yield server
    server.close()


class Console:
    """Somebody at a probe's socket."""

    def __init__(self, folder: Path) -> None:
        [path] = folder.glob("*.sock")
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.settimeout(10)
        self._socket.connect(str(path))
        self._lines = self._socket.makefile("rb")
        self._told: deque[object] = deque()

    def next(self) -> object:
        if not self._told:
            self._told.extend(decode_lines(self._lines.readline()))
        return self._told.popleft()

    def follow(self) -> "Console":
        assert isinstance(self.next(), Hello)
        self._socket.sendall(FOLLOW)
        return self

    def hears_something(self) -> bool:
        """Whether a line comes; who is turned away hears nothing."""
        return bool(self._lines.readline())

    def leave(self) -> None:
        self._lines.close()
        self._socket.close()


Come = Callable[[], Console]


@pytest.fixture
def come(folder: Path) -> Iterator[Come]:
    """Has somebody come to the probe's socket, who leaves at the end at the latest."""
    consoles: list[Console] = []

    def one_more() -> Console:
        consoles.append(Console(folder))
        return consoles[-1]

    yield one_more
    for console in consoles:
        console.leave()


def say(recorder: Recorder, text: str) -> None:
    recorder.put("notice", now(), "INFO", text)


def text_of(line: object) -> str:
    assert isinstance(line, Notice)
    return line.text


@pytest.mark.usefixtures("server")
def test_who_follows_hears_what_was_and_what_comes(recorder: Recorder, come: Come) -> None:
    say(recorder, "before")
    console = come().follow()
    assert text_of(console.next()) == "before"
    say(recorder, "after")
    assert text_of(console.next()) == "after"


@pytest.mark.usefixtures("server")
def test_several_consoles_follow_and_come_and_go(recorder: Recorder, folder: Path, come: Come) -> None:
    say(recorder, "to both")
    first, second = come().follow(), come().follow()
    assert text_of(first.next()) == text_of(second.next()) == "to both"
    first.leave()
    say(recorder, "to who is left")
    assert text_of(second.next()) == "to who is left"
    assert text_of(come().follow().next()) == "to both"
    assert [hello.process for hello in processes_in(folder)] == [os.getpid()]


@pytest.mark.usefixtures("server")
def test_more_consoles_than_there_is_room_for_are_turned_away(recorder: Recorder, come: Come) -> None:
    say(recorder, "to those who are let in")
    assert [come().follow().hears_something() for _ in range(5)] == [True, True, True, True, False]


@pytest.mark.usefixtures("server")
def test_what_has_appeared_is_told_to_everybody_who_comes(recorder: Recorder, come: Come) -> None:
    thread = recorder.thread()
    assert [getattr(come().follow().next(), "thread", None) for _ in range(2)] == [thread, thread]


def test_what_began_long_ago_and_goes_on_is_told_to_who_comes_late() -> None:
    ongoing: list[tuple[Any, ...]] = [
        ("callback_start", 10, 1, 7, 0, 0, 0),
        ("called", 11, 2, "/switch", 1, "", 5, 6),
        ("blocked", 12, 2, 7, 1, "/switch"),
        ("at", 13, 1, 7, [["node.py", "tick", 3]], [0, 0, 0, 0], "rclpy.client", "Client.call"),
        ("ready", 14, 3, 1, 0),
        ("wait_start", 15, 3, 14, "group held", 1, True),
        ("callback_start", 16, 4, 8, 0, 0, 0),
        ("callback_suspend", 17, 4, 8),
        ("taken", 18, 5, 8, 17, 1),
        ("callback_suspend", 19, 5, 8),
        ("callback_resume", 20, 5, 9),
    ]
    over: list[tuple[Any, ...]] = [
        ("callback_start", 21, 6, 8, 0, 0, 0),
        ("at", 22, 6, 8, [["node.py", "hear", 9]], [0, 0, 0, 0], "time", "sleep"),
        ("callback_end", 23, 6, 8),
        ("called", 24, 9, "/other", 0, "", 5, 6),
        ("service_reply", 25, 9, "/other", ""),
        ("wait_start", 26, 6, 26, "group held", 1, True),
        ("wait_end", 27, 6),
    ]
    latest, later = Latest(), [("notice", 30, "INFO", str(number)) for number in range(20_000)]
    latest.add([*ongoing, *over], lines([*ongoing, *over]))
    latest.add(later, lines(later))
    told, count = latest.whole()
    assert decode_lines(told) == decode_lines(lines([*ongoing, *later]))
    assert count == len(ongoing) + len(later)


def test_an_executor_stops_until_the_thread_that_is_late_has_worked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim.probes.on_path.cbtui_probe.turns._LONGEST", 10.0)
    turns, order = Turns(), list[str]()
    turns.end(-1)  # it was to work a second ago
    late_at = turns.late_at
    assert now() > late_at

    def work() -> None:
        while turns.late_at == late_at:  # until the executor stops
            time.sleep(0)
        order.append("worked")
        turns.end(1)

    thread = threading.Thread(target=work)
    thread.start()
    turns.let()
    order.append("goes on")
    thread.join()
    assert order == ["worked", "goes on"]


def test_an_executor_goes_on_without_a_thread_that_never_works() -> None:
    turns = Turns()
    turns.end(-1)
    turns.let()
    assert now() < turns.late_at, "nor is it asked to stop again"


def test_a_process_that_ends_says_farewell(recorder: Recorder, folder: Path, come: Come) -> None:
    server = Server(recorder, lambda: None, Turns())
    server.start(str(folder))
    say(recorder, "to who follows")
    console = come().follow()
    assert text_of(console.next()) == "to who follows"
    server.close()
    assert isinstance(console.next(), Left)


@pytest.fixture
def port(monkeypatch: pytest.MonkeyPatch) -> int:
    """A free port, at which probes listen for who knows the token."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        number = int(free.getsockname()[1])
    monkeypatch.setenv(PORT, str(number))
    monkeypatch.setenv(TOKEN, "swordfish")
    return number


def test_through_a_port_only_who_knows_the_token_is_answered(
    port: int, request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    request.getfixturevalue("server")
    hello = process_at(("127.0.0.1", port))
    assert hello is not None
    assert hello.process == os.getpid()
    monkeypatch.setenv(TOKEN, "sword")
    assert process_at(("127.0.0.1", port)) is None


def test_a_console_that_does_not_read_loses_events_and_is_told_how_many() -> None:
    ours, theirs = socket.socketpair()
    ours.setblocking(False)
    console, told = ConsoleLink(ours), lines([("notice", 1, "INFO", "x" * 100_000)])
    for _ in range(300):
        console.tell(told, 1)
    assert console.send()
    received = b""
    while not received.endswith(b"\n") or not console.is_up_to_date:
        received += theirs.recv(1 << 20)
        console.tell_lost(0)
        assert console.send()
    theirs.close()
    console.close()
    heard = decode_lines(received)
    [lost] = [line for line in heard if isinstance(line, EventsLost)]
    assert lost.count + len(heard) - 1 == 300


def test_a_socket_is_there_only_once_it_answers(
    recorder: Recorder, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found: list[list[Path]] = []
    listen = socket.socket.listen

    def looked_at(listener: socket.socket, backlog: int) -> None:
        found.append(sockets_in(folder))
        listen(listener, backlog)

    monkeypatch.setattr(socket.socket, "listen", looked_at)
    server = Server(recorder, lambda: None, Turns())
    server.start(str(folder))
    server.close()
    assert found == [[]]


def test_a_callback_runs_though_the_probe_cannot_tell_of_its_start(recorder: Recorder) -> None:
    def start(*_: object) -> None:
        raise ZeroDivisionError

    calls: list[int] = []
    Calls(recorder, SimpleNamespace(number=7, wait=None, kind="timer")).traced(calls.append, start)(5)  # type: ignore[arg-type]
    assert calls == [5]
    assert [event[0] for event in recorder.take()] == ["thread", "notice", "callback_end"]


def test_rclpy_is_asked_how_late_a_timer_is_only_where_its_rhythm_does_not_tell(
    recorder: Recorder, monkeypatch: pytest.MonkeyPatch
) -> None:
    ms = 1_000_000
    ask = Mock(return_value=9 * ms)
    timer = SimpleNamespace(time_until_next_call=ask)
    entity: Any = SimpleNamespace(
        number=7, wait=None, kind="timer", made=lambda: timer, due=100 * ms, period=10 * ms
    )
    tick = Calls(recorder, entity)
    for moment in (100.2, 110.1, 140.0):
        monkeypatch.setattr(callbacks, "now", lambda moment=moment: round(moment * ms))
        tick.traced(lambda: None, tick.begin_timer)()
    late = [event[5] / ms for event in recorder.take() if event[0] == "callback_start"]
    assert (late, ask.call_count) == ([0.2, 0.1, 20.0], 1)


def test_a_full_buffer_gives_up_the_oldest_and_counts_them(recorder: Recorder) -> None:
    for number in range(200_005):
        say(recorder, str(number))
    assert recorder.lost == 5
    assert recorder.take()[0][3] == "5"


def test_the_sockets_of_dead_processes_are_removed(folder: Path) -> None:
    with socket.socket(socket.AF_UNIX) as dead:
        dead.bind(str(folder / "4711.sock"))
    assert processes_in(folder) == []
    assert list(folder.iterdir()) == []


RAISING = """
import traceback
from cbtui_probe.callbacks import Calls
from cbtui_probe.recorder import Recorder
from types import SimpleNamespace

def fail():
    raise ValueError("no more")

traced = Calls(Recorder(), SimpleNamespace(number=7, wait=None, kind="guard")).traced(fail)
try:
    traced()
except ValueError:
    traceback.print_exc()
"""


@pytest.mark.parametrize("version", VERSIONS[1:])
def test_what_a_callback_raises_is_shown_without_the_probe_by_every_python(version: str) -> None:
    done = subprocess.run(
        [python_of(version), "-c", RAISING],
        env={**os.environ, "PYTHONPATH": str(ON_PATH)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "no more" in done.stderr
    assert "cbtui" not in done.stderr
