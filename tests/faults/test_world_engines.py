"""Engines that are killed or stopped from outside, pipes that break, consoles that are killed."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import active_children
from pathlib import Path
from queue import Queue
from threading import Event

import pytest

from cbtui.engines.hang_detector import HangDetector
from cbtui.engines.process_tree import MARK, ProcessTree
from cbtui.engines.session import ProcessSession
from cbtui.runs.live.live_run import RunState
from sim.engine.setup import ProgramSetup, RobotUse, RunSetup
from sim.recording import read
from sim.trace.events import AnyEvent, Logged, Notice, NoticeKind, Printed, RunStarted, Severity
from tests.faults.support import PATIENCE, console_on, node_with, nothing_left, still_here
from tests.support.daily import first_daily
from tests.support.processes import alive, engines_of, is_stopped, wait_until_gone

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc"),
    pytest.mark.usefixtures("fresh_engines"),
]

IN_C = "open('reached', 'w')\nsum(range(10 ** 15))"
"""Never comes back, and lets no other thread of Python's go on."""
WITH_CHILDREN = """\
if os.fork() == 0:
    time.sleep(300)
subprocess.Popen(['sleep', '300'], start_new_session=True)
subprocess.Popen(['sh', '-c', 'setsid sleep 300 & exit'])
open('reached', 'w')
"""
SLEEPS = "import os, time\nopen(f'reached-{os.getpid()}', 'w').close()\ntime.sleep(300)\n"
COPIES = """\
import sys
from cbtui.engines.forking import forking_context
from cbtui.engines.session import ProcessSession
from sim.engine.setup import ProgramSetup, RunSetup

ended = []
setup = RunSetup(title="", programs=(ProgramSetup("node.py"),), clock="real")
session = ProcessSession(setup, len, ended.append, context=forking_context(["sim.engine.process"]))
session.start()
sys.stdin.read()
print(ended)
session.stop()
"""
"""A console whose engine is a copy of a prepared process; it ends when its input does."""
ENDS_HALF_WAY = """\
import os
from pathlib import Path
from time import sleep
from psutil import Process
from cbtui.engines.session import ProcessSession
from sim.engine.setup import ProgramSetup, RunSetup

if __name__ == "__main__":
    setup = RunSetup(title="", programs=(ProgramSetup("node.py"),), clock="real")
    session = ProcessSession(setup, len, print)
    session.start()
    while not list(Path().glob("reached-*")):
        sleep(0.01)
    Process.kill = lambda process: os._exit(0)
    session._tree.end()
"""
"""A console that ends while it ends its engine: what it had stopped is still to be killed."""
GUARDS = """\
import time
from cbtui.engines.process_tree import become_guard

become_guard()
time.sleep(300)
"""
AN_HOUR = 3_600_000_000_000
"""In nanoseconds."""
SET_AGAIN = f"""\
import time
monotonic, time_ns = time.monotonic, time.time_ns
began = monotonic()
time.time_ns = lambda: time_ns() + {AN_HOUR} * (0, 1, -2)[int((monotonic() - began) / 0.1) % 3]
time.time = lambda set_ns=time.time_ns: set_ns() / 1e9
"""
"""For every Python that is started: its wall clock is set an hour ahead and two back, time and again."""


def engine() -> int:
    """The number of the only engine's process."""
    (process,) = (each for each in active_children() if each.name == "cbtui-engine")
    assert process.pid is not None
    return process.pid


def comes_true(condition: Callable[[], bool]) -> bool:
    """Wait until something is so; whether it was in time."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.01)
    return True


async def test_an_engine_that_is_killed_is_told_of_and_can_be_run_again(folder: Path) -> None:
    async with console_on(node_with(folder, "pass")) as console:
        await console.until(still_here)
        os.kill(engine(), signal.SIGKILL)
        await console.until(lambda live: live.state is RunState.LOST)
        await console.answers()
        await console.until(lambda _: console.said == "engine lost: killed by signal 9; r runs again")
        await console.pilot.press("r")
        await console.until(still_here)


@pytest.mark.slow
async def test_an_engine_that_is_stopped_is_told_of_and_goes_on_when_it_may(folder: Path) -> None:
    async with console_on(node_with(folder, "pass")) as console:
        await console.until(still_here)
        stopped = engine()
        os.kill(stopped, signal.SIGSTOP)
        await console.until(lambda live: live.state is RunState.SILENT)
        await console.answers()
        said = "engine does not answer: its process was stopped; r runs again"
        await console.until(lambda _: console.said == said)
        os.kill(stopped, signal.SIGCONT)
        await console.until(lambda live: live.state is RunState.LIVE)
        os.kill(stopped, signal.SIGSTOP)
        await console.until(lambda live: live.state is RunState.SILENT)
        await console.pilot.press("r")
        await console.until(lambda live: live.state is RunState.LIVE and still_here(live))
        assert engine() != stopped


@pytest.mark.slow
async def test_an_engine_that_code_in_c_keeps_is_told_of(folder: Path) -> None:
    async with console_on(node_with(folder, IN_C)) as console:
        await console.until(lambda live: live.state is RunState.SILENT)
        await console.answers()
        await console.until(lambda _: console.said.startswith("engine does not answer: code in C keeps it"))


def test_a_machine_that_slept_says_nothing_of_the_engine() -> None:
    hang_detector = HangDetector()
    hang_detector.received([RunStarted(0, "", "real", 0), Printed(7, "last", error=False)])
    assert [hang_detector.polled_nothing(lambda: "why") for _ in range(9)] == [[]] * 9
    (notice,) = hang_detector.polled_nothing(lambda: "why")
    assert isinstance(notice, Notice)
    assert (notice.t, notice.severity) == (7, Severity.WARN)
    assert notice.kind is NoticeKind.ENGINE_SILENT
    assert hang_detector.polled_nothing(lambda: "why") == []
    assert hang_detector.received([]) == [Notice(7, Severity.INFO, "the engine answers again")]
    assert hang_detector.received([]) == []


@pytest.mark.slow
def test_a_pipe_that_breaks_in_the_middle_of_a_message_gives_what_came_whole(folder: Path) -> None:
    # One event, which comes in one message; what is printed is cut into many.
    path = node_with(folder, "self.get_logger().info('x' * 20_000_000)")
    news: Queue[list[AnyEvent] | str | None] = Queue()
    go_on = Event()

    def deliver(events: list[AnyEvent]) -> None:
        news.put(events)
        go_on.wait(PATIENCE)

    programs = (ProgramSetup(str(path)),)
    setup = RunSetup(title="", programs=programs, clock="real", robot=RobotUse.NEVER)
    session = ProcessSession(setup, deliver, news.put)
    with nothing_left():
        session.start()
        assert comes_true(lambda: b"x" * 100 in _waiting(session._pipe.fileno()))
        os.kill(engine(), signal.SIGKILL)
        go_on.set()
        came = []
        while isinstance(batch := news.get(timeout=PATIENCE), list):
            came += batch
        session.stop()
    assert isinstance(came[0], RunStarted)
    assert not any(isinstance(event, Logged) and event.text.startswith("xx") for event in came)
    assert batch == "the engine was killed by signal 9"


def _waiting(descriptor: int) -> bytes:
    """What can be read, and is left there."""
    with socket.socket(fileno=os.dup(descriptor)) as end, suppress(BlockingIOError):
        return end.recv(1 << 16, socket.MSG_PEEK | socket.MSG_DONTWAIT)
    return b""


@pytest.mark.parametrize(
    "fault", first_daily(WITH_CHILDREN, IN_C), ids=["with children", "kept by code in C"]
)
def test_a_console_that_is_killed_takes_its_engine_and_what_it_started_along(
    fault: str, folder: Path
) -> None:
    path = node_with(folder, fault)
    with nothing_left():
        console = _console(path, "--record", "run.mcap")
        assert comes_true((folder / "reached").exists)
        console.kill()
        console.communicate()
    recording = read(folder / "run.mcap")
    assert list(recording.batches()) or recording.damage
    assert recording.damage is not None
    assert "breaks off" in recording.damage


def test_whoever_ends_an_engine_spares_the_process_that_ends_it_with_the_console() -> None:
    sleep, marked = ["sleep", "300"], os.environ | {MARK: "mine"}
    guards = [sys.executable, "-c", GUARDS]
    engine, started, guard = (
        subprocess.Popen(each, env=marked, start_new_session=True) for each in (sleep, sleep, guards)
    )
    assert comes_true(lambda: "guard" in Path(f"/proc/{guard.pid}/comm").read_text())
    ProcessTree(engine.pid, "mine").end()
    assert (engine.wait(), started.wait()) == (-signal.SIGKILL, -signal.SIGKILL)
    assert guard.poll() is None
    assert not is_stopped(guard.pid)
    guard.kill()
    guard.wait()


def test_a_console_that_ends_while_it_ends_its_engine_leaves_nothing_stopped(folder: Path) -> None:
    (folder / "node.py").write_text(SLEEPS)
    (folder / "console.py").write_text(ENDS_HALF_WAY)
    with nothing_left():
        subprocess.run([sys.executable, "console.py"], cwd=folder, check=True)


def test_a_console_that_is_killed_leaves_what_others_run(folder: Path) -> None:
    (folder / "node.py").write_text(SLEEPS)
    consoles: list[subprocess.Popen[str]] = []
    engines: list[int] = []
    for _ in range(2):
        command = [sys.executable, "-c", COPIES]
        pipe = subprocess.PIPE
        consoles.append(subprocess.Popen(command, cwd=folder, stdin=pipe, stdout=pipe, text=True))
        assert comes_true(lambda: len(list(folder.glob("reached-*"))) == len(consoles))
        (appeared,) = {int(each.name.split("-")[1]) for each in folder.glob("reached-*")} - {*engines}
        engines.append(appeared)
    (killed, other), (gone, left) = consoles, engines
    killed.kill()
    killed.communicate()
    wait_until_gone([gone])
    assert alive(left)
    assert not is_stopped(left)
    assert other.communicate("")[0] == "[]\n"


@pytest.mark.slow
def test_a_machine_that_slept_finishes_its_run(folder: Path) -> None:
    path = node_with(folder, "for each in (os.getppid(), os.getpid()): os.kill(each, signal.SIGSTOP)")
    with nothing_left():
        console = _console(path, "--for", "1", "--record", "run.mcap")
        assert comes_true(lambda: sum(map(is_stopped, [console.pid, *engines_of(console.pid)])) == 2)
        both = [console.pid, *engines_of(console.pid)]
        time.sleep(2)  # it is how long the machine sleeps, and nothing is waited for
        for each in reversed(both):  # the engine first: a console that waits for one that stands would say so
            os.kill(each, signal.SIGCONT)
        _, complaints = console.communicate(timeout=PATIENCE)
    assert console.returncode == 0
    assert "the engine does not answer" not in complaints.decode()
    recording = read(folder / "run.mcap")
    times = [event.t for events in recording.batches() for event in events]
    assert recording.damage is None
    assert max(times) >= 1_000_000_000


@pytest.mark.slow
def test_a_wall_clock_that_is_set_again_and_again_changes_no_time_of_a_run(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "sitecustomize.py").write_text(SET_AGAIN)
    monkeypatch.setenv("PYTHONPATH", str(folder), prepend=os.pathsep)
    path = node_with(folder, "self.get_logger().info(str(self.get_clock().now().nanoseconds))", again=True)
    with nothing_left():
        console = _console(path, "--for", "5", "--record", "run.mcap")
        console.communicate(timeout=PATIENCE)
    assert console.returncode == 0
    events = [event for batch in read(folder / "run.mcap").batches() for event in batch]
    began = [
        int(event.text) - event.t for event in events if isinstance(event, Logged) and event.text.isdecimal()
    ]
    assert len(began) > 5
    assert max(began) - min(began) < AN_HOUR // 60
    assert 5_000_000_000 <= max(event.t for event in events) < AN_HOUR // 60


def _console(path: Path, *words: str) -> "subprocess.Popen[bytes]":
    """A console without a screen, on the real clock."""
    command = [sys.executable, "-m", "cbtui", "run", str(path), "--clock", "real", "--no-robot", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
