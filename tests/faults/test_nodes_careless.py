"""Nodes that spoil what they share with the engine: it goes on, tells of it, and can be ended."""

import signal
from pathlib import Path
from typing import NamedTuple

import pytest

from cbtui.runs.live.live_run import RunState
from sim.engine.setup import RobotUse
from sim.trace.events import AnyEvent, Notice, RunEnded
from sim.trace.model import Window
from tests.faults.support import FIRST, PATIENCE, Provoked, console_on, node_with, provoked, still_here
from tests.support.daily import first_daily, first_row_daily

AT = f"node.py:{FIRST}"
NO_NUMBERS = """\
self.wheels = getattr(self, 'wheels', None) or self.create_publisher(Twist, 'cmd_vel', 10)
self.wheels.publish(Twist(linear=Vector3(x=float('nan')), angular=Vector3(z=float('inf'))))
"""
ALL = Window(0, 1 << 62)


class GoesOn(NamedTuple):
    """What a node does, after which it goes on; the engine's notices, and one line of its log."""

    fault: str
    notices: tuple[str, ...] = ()
    line: str = ""


FAULTS = {
    "an exception in a destructor": GoesOn(
        "class D:\n    def __del__(self): 1 / 0\nD()",
        (
            f"node.py:{FIRST + 1}: ZeroDivisionError: division by zero; Python drops what comes out of "
            "N.fault.<locals>.D.__del__",
        ),
        "ZeroDivisionError: division by zero",
    ),
    "an exception in a thread": GoesOn(
        "def work(): 1 / 0\nthreading.Thread(target=work, name='worker').start()",
        (f"{AT}: ZeroDivisionError: division by zero; worker ended by it, and the rest goes on",),
        "ZeroDivisionError: division by zero",
    ),
    "threads that are left": GoesOn(
        "for _ in range(50): threading.Thread(target=time.sleep, args=(1e6,)).start()"
    ),
    "stdout is closed": GoesOn("sys.stdout.close()\nos.close(1)\nos.close(2)\nos.close(0)"),
    "a shell writes to the terminal": GoesOn("os.system('echo from a shell')", line="from a shell"),
    "C writes to the terminal": GoesOn("os.write(1, b'raw\\n')\nos.write(2, b'raw too\\n')", line="raw too"),
    "the keyboard is read": GoesOn(
        "print('keys:', os.read(0, 10))",
        (
            f"a callback waits for the keyboard ({AT}, in fault): its thread serves nothing else meanwhile; "
            "read in a thread of its own",
            "node.py reads from the keyboard, and nobody types; "
            "run it by cbtui run or cbtui open, or have text typed: --type 2 'text'",
        ),
        "keys: b''",
    ),
    "the terminal is opened": GoesOn(
        "try: open('/dev/tty', 'w')\nexcept OSError as error: print('no', error.filename)", line="no /dev/tty"
    ),
    "the folder is changed": GoesOn("os.chdir('/')\nprint('in', os.getcwd())", line="in /"),
    "signals are ignored": GoesOn(
        "for each in (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGCHLD):\n"
        "    signal.signal(each, signal.SIG_IGN)"
    ),
    "signals are handled": GoesOn(
        "for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1):\n"
        "    signal.signal(each, lambda number, _: print('got', number))\n"
        "os.kill(os.getpid(), signal.SIGUSR1)",
        line=f"got {int(signal.SIGUSR1)}",
    ),
    "time is patched": GoesOn(
        "time.sleep = time.monotonic = time.time = time.perf_counter = lambda *_: 0.0\n"
        "threading.Lock = threading.Thread = None\nprint('patched')",
        line="patched",
    ),
    "its file is deleted": GoesOn("os.remove(__file__)"),
}


@pytest.mark.parametrize("name", first_daily(*FAULTS))
def test_a_node_that_goes_on_after_its_fault_is_still_followed_and_can_be_ended(
    folder: Path, name: str, request: pytest.FixtureRequest
) -> None:
    fault, notices, line = FAULTS[name]
    by_force = name == "threads that are left"
    if not by_force:
        request.getfixturevalue("patient_engines")
    with provoked(node_with(folder, fault)) as run:
        run.until(lambda live: still_here(live) and all(_is_told(run, notices, line)))
        assert run.live.alive
        assert run.notices == [*notices]
        assert any("had not ended" in text for text in _notices_of_the_end(run)) is by_force


def _is_told(run: Provoked, notices: tuple[str, ...], line: str) -> tuple[bool, bool]:
    return len(run.notices) >= len(notices), not line or line in run.printed


def _notices_of_the_end(run: Provoked) -> list[str]:
    """Stop a run; what its engine told until it had ended by itself."""
    run.recorded = run.live.stop()
    events: list[AnyEvent] = []
    while isinstance(batch := run.news.get(timeout=PATIENCE), list):
        events += batch
    assert batch is None, batch
    assert isinstance(events[-1], RunEnded)
    return [event.text for event in events if isinstance(event, Notice)]


@pytest.mark.parametrize(
    "name", first_daily("time is patched", "an exception in a destructor", "an exception in a thread")
)
def test_on_virtual_time_too(folder: Path, name: str) -> None:
    fault, notices, line = FAULTS[name]
    with provoked(node_with(folder, fault), "virtual") as run:
        run.until(lambda live: still_here(live) and all(_is_told(run, notices, line)))
        assert run.live.alive


@pytest.mark.slow
def test_what_comes_out_of_a_destructor_again_and_again_is_told_once(folder: Path) -> None:
    fault = FAULTS["an exception in a destructor"].fault
    with provoked(node_with(folder, fault, again=True)) as run:
        run.until(lambda live: still_here(live) and len(live.timeline.logs) > 20)
        assert len(run.notices) == 1


def test_a_file_that_is_gone_is_told_of_when_it_is_run_again(folder: Path) -> None:
    path = node_with(folder, "os.remove(__file__)\nos._exit(1)")
    with provoked(path) as run:
        run.to_its_end()
    for recording in folder.glob("*.mcap"):
        recording.unlink()
    with provoked(path) as again:
        again.to_its_end()
        assert again.sentence.startswith("the run is over: node.py cannot be read: No such file or directory")
        assert again.live.state is RunState.ENDED


@pytest.mark.parametrize(
    ("fault", "does"),
    first_row_daily(
        ("lock = threading.Lock()\nlock.acquire()\nlock.acquire()", "waits for lock"),
        ("os.read(os.pipe()[0], 1)", "computes, or waits"),
    ),
    ids=["a lock", "a pipe"],
)
def test_a_callback_that_waits_for_ever_on_the_real_clock_is_told_of_with_its_place(
    folder: Path, fault: str, does: str
) -> None:
    with provoked(node_with(folder, fault)) as run:
        run.until(lambda _: run.notices != [])
        (notice,) = run.notices
        line = FIRST + fault.count("\n")
        assert notice.startswith("tick has not come back since ")
        assert f" s (node.py:{line}, in fault): it {does}" in notice
        assert _notices_of_the_end(run) == []


KEPT_LOCK = """
lock = threading.Lock()
def keep():
    with lock:
        time.sleep(4)
threading.Thread(target=keep).start()
time.sleep(0.1)
lock.acquire()
"""


@pytest.mark.parametrize(
    "fault",
    ["time.sleep(4)", pytest.param(KEPT_LOCK, marks=pytest.mark.slow)],
    ids=["itself", "with its lock"],
)
def test_a_callback_that_waits_for_a_long_sleep_is_not_taken_for_one_that_hangs(
    folder: Path, fault: str
) -> None:
    with provoked(node_with(folder, fault)) as run:
        run.until(still_here)
        assert run.notices == []


OWN_END = f"/n destroyed itself in its own callback tick ({AT}, in fault): this call goes on to its end"


def test_a_node_that_destroys_itself_is_told_of_and_its_other_callbacks_run_no_more(folder: Path) -> None:
    fault = "self.create_timer(0.01, lambda: print('again'))\nself.destroy_node()\nprint('destroyed')"
    with provoked(node_with(folder, fault), "virtual") as run:
        run.until(lambda _: "destroyed" in run.printed)
        (notice,) = run.notices
        assert notice.startswith(OWN_END.replace(str(FIRST), str(FIRST + 1)))
        assert run.sentence == notice
        assert _notices_of_the_end(run) == []
        assert run.printed == ["destroyed"]


@pytest.mark.slow
async def test_a_node_that_destroys_itself_is_told_of_on_screen_and_can_be_run_again(folder: Path) -> None:
    path = node_with(folder, "self.destroy_node()")
    async with console_on(path) as console:
        await console.until(lambda _: console.said.startswith(OWN_END))
        node_with(folder, "pass")
        await console.pilot.press("ctrl+r")
        await console.until(still_here)


def test_a_robot_that_is_sent_velocities_that_are_no_numbers_stands_still_and_tells_once(
    folder: Path,
) -> None:
    with provoked(node_with(folder, NO_NUMBERS, again=True), "virtual", RobotUse.ALWAYS) as run:
        run.until(lambda live: len(live.timeline.trail(ALL)) > 20)
        stood = [(at.x, at.y, at.yaw) for at in run.live.timeline.trail(ALL)]
        assert {place == pytest.approx(stood[0], abs=1e-3) for place in stood} == {True}
        assert run.notices == [
            f"the robot ignores velocities that are no numbers (node.py:{FIRST + 1}, in fault): "
            "linear.x=nan, angular.z=inf; publish finite ones"
        ]
        assert run.sentence == run.notices[0]
        assert len(run.printed) == 2  # the driver's warning, and that the node goes on


def test_a_signal_that_ends_programs_ends_this_one_in_a_sentence(folder: Path) -> None:
    with provoked(node_with(folder, f"os.kill(os.getpid(), {int(signal.SIGALRM)})")) as run:
        run.to_its_end()
        assert run.live.loss == "the program crashed with SIGALRM"
