"""The terminal of a run's programs: what is typed arrives at moments of the run, and again at the same."""

from pathlib import Path
from queue import Queue

import msgspec
import pytest

from cbtui.engines.session import ProcessSession
from sim.engine.commands import TerminalInput
from sim.engine.inputs import inputs_of
from sim.engine.setup import Keyboard, RunSetup, TimedText
from sim.trace.events import (
    AnyEvent,
    KeyboardAsked,
    Logged,
    Notice,
    Printed,
    Reading,
    Typed,
    VelocityCommanded,
    encode,
)
from tests.support.engine_runs import SECOND, Run, program_setup, run_to_end
from tests.support.teleop import ASKING, TELEOP


def set_up(
    folder: Path, source: str, seconds: float = 5.0, clock: str = "virtual", *, robot: bool = False
) -> RunSetup:
    path = folder / "node.py"
    path.write_text(source)
    return program_setup(path, seconds, clock, robot=robot)


def typing(setup: RunSetup, *typed: tuple[float, str]) -> Run:
    texts = tuple(TimedText(round(at * SECOND), text) for at, text in typed)
    return run_to_end(msgspec.structs.replace(setup, typed=texts))


def lines(run: Run) -> list[tuple[float, str]]:
    return [(event.t / SECOND, event.text) for event in run.events if isinstance(event, Printed)]


def printed(run: Run) -> list[str]:
    return [text for _, text in lines(run)]


def test_a_teleop_program_gets_key_after_key_at_the_moment_at_which_they_are_typed(tmp_path: Path) -> None:
    run = typing(set_up(tmp_path, TELEOP, robot=True), (1, "wwa"), (3.05, "s"), (4, "\x03"))
    assert lines(run)[1:] == [
        (1.0, "linear 0.02, angular 0.00"),
        (1.0, "linear 0.04, angular 0.00"),
        (1.0, "linear 0.04, angular 0.20"),
        (3.05, "linear 0.00, angular 0.00"),
    ]
    assert run.ending.t == 4 * SECOND
    assert run.ending.reason == "the program returned"
    asked = [event for event in run.events if isinstance(event, KeyboardAsked)]
    assert asked == [KeyboardAsked(0, Reading.RAW, "node.py")]
    robot = run.timeline.robot(3 * SECOND)
    assert robot is not None
    assert robot.travelled > 0.05
    assert robot.turned > 0.2
    driven = [event.linear for event in run.events if isinstance(event, VelocityCommanded)]
    assert max(driven) == 0.04
    assert driven[-1] == 0


def test_a_timeout_of_select_is_one_of_the_runs_time(tmp_path: Path) -> None:
    source = """
import select, sys, time
for timeout in (0.1, 0.25, 0, 3):
    found = select.select([sys.stdin], [], [], timeout)[0]
    print(f'{time.monotonic():.2f}', bool(found))
"""
    assert printed(typing(set_up(tmp_path, source), (1, "x\n"))) == [
        *("0.10 False", "0.35 False", "0.35 False", "1.00 True")
    ]


WAITS = {
    "poll": "waits = select.poll(); waits.register(sys.stdin, select.POLLIN)\nwait = lambda: waits.poll(400)",
    "epoll": "waits = select.epoll(); waits.register(0, select.EPOLLIN)\nwait = lambda: waits.poll(0.4)",
    "selectors": (
        "waits = selectors.DefaultSelector(); waits.register(sys.stdin, selectors.EVENT_READ)\n"
        "wait = lambda: waits.select(0.4)"
    ),
    "PollSelector": (
        "waits = selectors.PollSelector(); waits.register(0, selectors.EVENT_READ)\n"
        "wait = lambda: waits.select(0.4)"
    ),
    "SelectSelector": (
        "waits = selectors.SelectSelector(); waits.register(0, selectors.EVENT_READ)\n"
        "wait = lambda: waits.select(0.4)"
    ),
}


@pytest.mark.parametrize("way", WAITS)
def test_whatever_looks_for_keys_finds_them_in_the_runs_time(tmp_path: Path, way: str) -> None:
    source = f"""
import select, selectors, sys, time, tty
{WAITS[way]}
tty.setcbreak(0)
for _ in range(4):
    key = sys.stdin.read(1) if wait() else 'none'
    print(f'{{time.monotonic():.2f}}', key)
"""
    run = typing(set_up(tmp_path, source), (0.5, "ab"))
    assert printed(run) == ["0.40 none", "0.50 a", "0.50 b", "0.90 none"]
    assert not [event for event in run.events if isinstance(event, Notice)]


def test_keys_and_a_socket_are_looked_at_together(tmp_path: Path) -> None:
    source = """
import select, socket, sys
near, far = socket.socketpair()
waits = select.poll()
for each in (near, sys.stdin):
    waits.register(each, select.POLLIN)
print(waits.poll(0))
far.send(b'x')
print(waits.poll(9000) == [(near.fileno(), select.POLLIN)])
waits.unregister(near)
print(waits.poll(9000) == [(0, select.POLLIN)])
waits.unregister(0)
print(waits.poll(0))
"""
    assert printed(typing(set_up(tmp_path, source), (1, "x\n"))) == ["[]", "True", "True", "[]"]


@pytest.mark.parametrize("opened", ["open('/dev/tty')", "open('/dev/tty', 'rb', 0)"])
def test_a_program_may_open_the_terminal_by_its_name(tmp_path: Path, opened: str) -> None:
    source = f"import termios\nwith {opened} as tty:\n    termios.tcgetattr(tty)\n    print(tty.readline())"
    assert "two" in printed(typing(set_up(tmp_path, source), (1, "two\n")))[0]


@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_input_holds_its_own_thread_only_and_its_prompt_is_seen_at_once(tmp_path: Path, clock: str) -> None:
    run = typing(set_up(tmp_path, ASKING, clock=clock), (1.2, "1\n"), (2.2, "2\nq\n"))
    assert printed(run) == ["speed? ", "the speed is 1.0", "speed? ", "the speed is 2.0", "speed? "]
    prompt = next(event for event in run.events if isinstance(event, Printed))
    assert not prompt.ends
    assert prompt.t < 1.2 * SECOND
    assert len([event for event in run.events if isinstance(event, Logged)]) >= 2
    assert run.ending.reason == "the program returned"


READERS = r"""
import getpass, os, sys

print(repr(sys.stdin.readline()), sys.stdin.buffer.readline(), os.read(0, 100))
print(getpass.getpass(), input(), sys.stdin.isatty(), os.isatty(0), *os.get_terminal_size(0))
print([line for line in sys.stdin], repr(sys.stdin.read()))
"""


def test_every_way_of_reading_waits_in_the_runs_time(tmp_path: Path) -> None:
    typed = ((1, "né\n"), (2, "n"), (2.5, "é\n"), (3, "three\n"), (3.5, "secret\n"), (4, "five\nsix\n7"))
    run = typing(set_up(tmp_path, READERS), *typed)
    assert lines(run) == [
        (3.0, r"'né\n' b'n\xc3\xa9\n' b'three\n'"),
        (3.0, "Password: "),
        (3.5, ""),
        (4.0, "secret five True True 80 24"),
        (4.0, r"['six\n', '7'] ''"),
    ]
    assert [event.text for event in run.events if isinstance(event, Typed)][4] == "••••••\n"


def test_the_keys_of_a_cursor_key_come_together(tmp_path: Path) -> None:
    source = (
        "import os, sys, tty\ntty.setcbreak(0)\nprint(os.read(0, 9), os.read(0, 9), repr(sys.stdin.read(3)))"
    )
    assert printed(typing(set_up(tmp_path, source), (1, "\x1b[Aä\x1b[B"))) == [
        r"b'\x1b[A' b'\xc3\xa4' '\x1b[B'"
    ]


def test_a_read_that_is_not_to_wait_does_not(tmp_path: Path) -> None:
    source = """
import os, sys, time
os.set_blocking(0, False)
try:
    os.read(0, 1)
except BlockingIOError:
    print(repr(sys.stdin.read(1)))
time.sleep(2)
print(sys.stdin.readline())
"""
    assert printed(typing(set_up(tmp_path, source), (1, "now\n")))[1] == "now"


def test_who_reads_where_nobody_types_is_told_so_and_gets_the_end_of_the_input(tmp_path: Path) -> None:
    run = run_to_end(set_up(tmp_path, "input('speed? ')"))
    (notice,) = (event.text for event in run.events if isinstance(event, Notice))
    assert notice.startswith("node.py reads from the keyboard, and nobody types; ")
    assert "EOFError" in run.ending.reason


def test_behind_the_last_text_the_input_ends(tmp_path: Path) -> None:
    run = typing(set_up(tmp_path, "while True:\n    print(int(input()) + 1)"), (1, "1\n"), (2, "2\n"))
    assert printed(run)[:2] == ["2", "3"]
    assert "EOFError" in run.ending.reason
    assert run.ending.t == 2 * SECOND


def test_ctrl_c_ends_the_run_unless_the_program_takes_it_as_a_key(tmp_path: Path) -> None:
    run = typing(set_up(tmp_path, ASKING), (1.2, "\x03"))
    assert run.ending.reason == "it was interrupted from the keyboard"
    assert run.ending.t == 1.2 * SECOND


def test_a_callback_that_waits_for_the_keyboard_is_named(tmp_path: Path) -> None:
    source = ASKING.replace("self.get_logger().info('tick')", "input()").replace("input('speed? ')", "'q'")
    source = source.replace(
        "threading.Thread(target=rclpy.spin, args=(Ticking(),), daemon=True).start()", "rclpy.spin(Ticking())"
    )
    run = typing(set_up(tmp_path, source), (4, "\n"))
    notices = [event for event in run.events if isinstance(event, Notice)]
    assert notices[0].text.startswith("a callback waits for the keyboard (node.py:13, in tick)")
    assert notices[0].entity
    assert notices[0].t == SECOND // 2
    assert notices[0].place == (str(tmp_path / "node.py"), 13)


LAUNCH = """
import sys
from launch import LaunchDescription
from launch.actions import ExecuteProcess

def generate_launch_description():
    asking = __file__.replace('node.launch.py', 'asking.py')
    return LaunchDescription([ExecuteProcess(cmd=[sys.executable, asking], output='screen')])
"""


def test_a_launched_program_has_no_keyboard_and_that_is_said(tmp_path: Path) -> None:
    (tmp_path / "asking.py").write_text("input('speed? ')")
    path = tmp_path / "node.launch.py"
    path.write_text(LAUNCH)
    run = typing(program_setup(path, 5), (1, "5\n"))
    notice = next(event.text for event in run.events if isinstance(event, Notice))
    assert "reads from the keyboard, which ros2 launch gives to no program; " in notice
    assert "EOFError" in run.ending.reason


def test_curses_says_what_does_its_work_here(tmp_path: Path) -> None:
    run = run_to_end(set_up(tmp_path, "import curses\ncurses.wrapper(print)"))
    assert run.ending.reason.endswith("; print, and read keys with termios")


def live(setup: RunSetup, *keys: TerminalInput) -> Run:
    """Run a program and type the first of some texts when it waits for the keyboard, then one by one."""
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session = ProcessSession(msgspec.structs.replace(setup, keyboard=Keyboard.LIVE), news.put, news.put)
    run = Run()
    left = list(keys)
    session.start()
    try:
        while isinstance(batch := news.get(timeout=60), list):
            run.events += batch
            for event in batch:
                first = isinstance(event, KeyboardAsked) and left == list(keys)
                if left and (first or isinstance(event, Typed)):
                    session.send(left.pop(0))
    finally:
        session.stop()
    return run


@pytest.mark.slow
@pytest.mark.parametrize("source", [ASKING, TELEOP], ids=["lines", "keys"])
def test_a_run_that_was_typed_to_is_repeated_byte_for_byte(tmp_path: Path, source: str) -> None:
    setup = set_up(tmp_path, source, seconds=3)
    run = live(setup, TerminalInput("1\n"), TerminalInput("2\n"), TerminalInput("wwd", ends=True))
    assert [event.text for event in run.events if isinstance(event, Typed)]
    again = run_to_end(
        msgspec.structs.replace(setup, keyboard=Keyboard.REPEATED, inputs=inputs_of(run.events))
    )
    assert encode(again.events) == encode(run.events)


def test_a_run_as_fast_as_it_can_waits_for_whoever_types(tmp_path: Path) -> None:
    run = live(set_up(tmp_path, ASKING), TerminalInput("1\n"), TerminalInput("q\n"))
    assert run.ending.reason == "the program returned"
    assert run.ending.t < SECOND


@pytest.mark.slow
def test_many_lines_from_a_pipe_arrive_whole(tmp_path: Path) -> None:
    source = "import sys\nnumbers = [int(line) for line in sys.stdin]\nprint(len(numbers), sum(numbers))"
    text = "".join(f"{number}\n" for number in range(5000))
    run = live(set_up(tmp_path, source), TerminalInput(text, ends=True))
    assert printed(run) == ["5000 12497500"]
