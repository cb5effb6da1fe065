"""A program ends as under CPython, whatever ends it, and is on the trace until it has."""

import gzip
import subprocess
import sys
from pathlib import Path
from queue import Queue
from signal import SIGINT, SIGTERM
from time import monotonic
from types import FrameType

import msgspec
import pytest

from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.lesson_setup import RunRequest
from sim.engine.commands import Stop
from sim.engine.programs.ending import GRACE
from sim.probes.own_code import place_of
from sim.trace.events import AnyEvent, Notice, Printed, RunEnded
from sim.trace.figures.summary import summarise
from sim.trace.figures.summary_text import plain_text
from tests.support.daily import first_daily, first_row_daily
from tests.support.engine_runs import Run, program_setup, run_program, run_to_end

LEAVES = """
import atexit, gzip, tempfile, threading, time, weakref
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

here = Path(__file__).parent
log = open(here / "log.csv", "w")
packed = gzip.open(here / "log.gz", "wt")
for number in range(20):
    print(number, file=log)
    print(number, file=packed)

class Motor:
    def __del__(self):
        print("motor off")

class Arm:
    pass

motor, arm = Motor(), Arm()
motor.itself = motor
finalizer = weakref.finalize(arm, print, "arm down")
scratch = tempfile.TemporaryDirectory()
(here / "scratch").write_text(scratch.name)
atexit.register(print, "atexit")
pool = ThreadPoolExecutor(2)
pool.submit(time.sleep, 0.1)
threading.Thread(target=lambda: (time.sleep(0.2), print("thread"))).start()
threading.Thread(target=time.sleep, args=(1000,), daemon=True).start()
"""

LAST = """
try:
    print("ready")
    time.sleep(1000)
except KeyboardInterrupt:
    print("interrupted")
    time.sleep(0.1)
    raise
finally:
    time.sleep(0.1)
    print("last line")
"""

ENDINGS = {
    "returns": ("", "the program returned"),
    "raises": ("\n1 / 0", "node.py:31: the program raised ZeroDivisionError: division by zero"),
    "exits": ("\nimport sys; sys.exit(3)", "the program ended with exit code 3 (node.py:31)"),
    "time is up": (LAST, "its time was up"),
}


def printed(run: Run) -> list[str]:
    """Lines of standard output, but for that of a thread, which may come at any time."""
    lines = [event.text for event in run.events if isinstance(event, Printed) and not event.error]
    return [line for line in lines if line != "thread"]


def check_what_is_left(folder: Path, run: Run) -> None:
    twenty = "".join(f"{number}\n" for number in range(20))
    assert (folder / "log.csv").read_text() == twenty
    with gzip.open(folder / "log.gz", "rt") as file:
        assert file.read() == twenty
    assert not Path((folder / "scratch").read_text()).exists()
    assert printed(run)[-3:] == ["atexit", "arm down", "motor off"]
    assert any(isinstance(event, Printed) and event.text == "thread" for event in run.events)
    assert isinstance(run.events[-1], RunEnded)
    assert not [event for event in run.events if isinstance(event, Notice) and not event.unrepeatable]


@pytest.mark.usefixtures("patient_engines")
@pytest.mark.parametrize("clock", ["virtual", "real"])
@pytest.mark.parametrize("how", first_daily(*ENDINGS))
def test_files_exit_functions_and_objects_are_seen_to_however_a_program_ends(
    tmp_path: Path, how: str, clock: str
) -> None:
    source, reason = ENDINGS[how]
    run = run_program(tmp_path, LEAVES + source, seconds=3.0 if source == LAST else 20.0, clock=clock)
    assert run.loss is None
    assert run.ending.reason == reason
    check_what_is_left(tmp_path, run)
    if source == LAST:
        assert printed(run)[-5:-3] == ["interrupted", "last line"]


@pytest.mark.usefixtures("patient_engines")
@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_a_run_that_is_stopped_shows_its_programs_ending_to_the_last_line(tmp_path: Path, clock: str) -> None:
    path = tmp_path / "node.py"
    path.write_text(LEAVES + LAST)
    news: Queue[list[AnyEvent] | str | None] = Queue()
    setup = msgspec.structs.replace(program_setup(path, 1000.0, clock), speed=1.0)
    session, run = ProcessSession(setup, news.put, news.put), Run()
    session.start()
    while "ready" not in printed(run):
        run.events += news.get(timeout=60)  # type: ignore[arg-type]
    session.stop()
    while isinstance(batch := news.get(timeout=60), list):
        run.events += batch
    assert run.ending.reason == "it was stopped"
    assert printed(run)[-5:-3] == ["interrupted", "last line"]
    check_what_is_left(tmp_path, run)


@pytest.mark.slow
@pytest.mark.parametrize("number", first_daily(SIGINT, SIGTERM))
def test_a_run_in_the_terminal_that_is_ended_shows_it_too(tmp_path: Path, number: int) -> None:
    path = tmp_path / "node.py"
    path.write_text(LEAVES + LAST)
    words = [sys.executable, "-m", "cbtui", "run", str(path)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        while process.stdout.readline() != "ready\n":
            pass
        process.send_signal(number)
        text = process.stdout.read()
    assert process.returncode == 128 + number
    assert "interrupted\nlast line\natexit\narm down\nmotor off\n" in text.replace("thread\n", "")
    assert (tmp_path / "log.csv").read_text().count("\n") == 20


@pytest.mark.parametrize(
    ("clock", "ends"),
    first_row_daily(
        ("virtual", "time.sleep(1000)"), ("real", "time.sleep(1000)"), ("virtual", "while True: pass")
    ),
)
def test_an_ending_that_does_not_end_is_ended_by_force_and_told_of(
    tmp_path: Path, clock: str, ends: str
) -> None:
    source = f"""
import time
log = open({str(tmp_path / "log.csv")!r}, "w")
log.write("1")
try:
    time.sleep(1000)
finally:
    {ends}
"""
    began = monotonic()
    run = run_program(tmp_path, source, seconds=3.0, clock=clock)
    assert monotonic() - began < GRACE + 60
    assert run.ending.reason == "its time was up"
    # What keeps virtual time is told before, if the machine leaves it no time to end.
    notices = [event.text for event in run.events if isinstance(event, Notice)]
    (notice,) = (each for each in notices if "node.py had not ended" in each)
    assert "(MainThread: node.py:8, in <module>)" in notice
    assert (tmp_path / "log.csv").read_text() == "1"


@pytest.mark.slow
def test_a_thread_that_keeps_a_program_from_ending_is_named_with_its_line(tmp_path: Path) -> None:
    source = """
import threading, time
def mission():
    time.sleep(1000)
threading.Thread(target=mission).start()
time.sleep(1000)
"""
    run = run_program(tmp_path, source, seconds=0.5, clock="real")
    (notice,) = (
        each.text for each in run.events if isinstance(each, Notice) and "had not ended" in each.text
    )
    assert "Thread-1 (mission): node.py:4, in mission): it was ended by force" in notice


def test_the_line_of_a_thread_is_never_one_of_cbtui_nor_of_what_starts_it() -> None:
    def frame_in(module: str, file: str) -> FrameType:
        names = {"__name__": module, "sys": sys}
        exec(compile("frame = sys._getframe()", file, "exec"), names)
        frame = names["frame"]
        assert isinstance(frame, FrameType)
        return frame

    of_program = place_of(frame_in("__main__", "/home/me/node.py"))
    assert of_program == "node.py:1, in <module>"
    assert "session.py" not in place_of(frame_in("cbtui.engines.session", "session.py"))
    assert "<string>" not in place_of(frame_in("__main__", "<string>"))


def test_what_an_exit_function_raises_is_told_with_its_place(tmp_path: Path) -> None:
    source = "import atexit\n@atexit.register\ndef off():\n    1 / 0\natexit.register(print, 'before')"
    run = run_program(tmp_path, source)
    assert run.ending.reason == "the program returned"
    (notice,) = (event.text for event in run.events if isinstance(event, Notice))
    assert notice == "node.py:4: ZeroDivisionError: division by zero; Python drops what comes out of off"
    text = [event.text for event in run.events if isinstance(event, Printed)]
    assert text[0] == "before"
    assert not any("sim/" in line for line in text)


@pytest.mark.usefixtures("patient_engines")
def test_a_callback_that_computes_without_end_hears_of_the_runs_end(tmp_path: Path) -> None:
    source = "try:\n    print('ready')\n    while True: pass\nfinally:\n    print('last line')"
    path = tmp_path / "node.py"
    path.write_text(source)
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session, run = ProcessSession(program_setup(path, 1000.0), news.put, news.put), Run()
    session.start()
    while "ready" not in printed(run):
        run.events += news.get(timeout=60)  # type: ignore[arg-type]
    session.send(Stop())
    while isinstance(batch := news.get(timeout=60), list):
        run.events += batch
    session.stop()
    assert printed(run) == ["ready", "last line"]
    assert run.ending.reason == "it was stopped"


@pytest.mark.usefixtures("patient_engines")
@pytest.mark.slow
@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_an_interrupted_program_is_answered_no_more_and_may_join_and_shut_down(
    tmp_path: Path, clock: str
) -> None:
    source = """
import threading, rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool
rclpy.init()
node = Node("ends")
node.create_service(SetBool, "motor", lambda request, answer: answer)
client = node.create_client(SetBool, "motor")
executor = MultiThreadedExecutor(2)
executor.add_node(node)
spinning = threading.Thread(target=executor.spin)
spinning.start()
other = Node("other")
try:
    rclpy.spin(other)
except KeyboardInterrupt:
    future = client.call_async(SetBool.Request())
    rclpy.spin_until_future_complete(other, future)
    print("answered", future.done())
finally:
    spinning.join()
    executor.shutdown()
    rclpy.try_shutdown()
    print("last line")
"""
    run = run_program(tmp_path, source, seconds=3.0, clock=clock)
    assert printed(run) == ["answered False", "last line"]
    assert not [event for event in run.events if isinstance(event, Notice)]


@pytest.mark.slow
@pytest.mark.parametrize("typed", ["link.py", "folder/real.py"])
def test_a_program_behind_a_link_keeps_the_name_that_was_typed(tmp_path: Path, typed: str) -> None:
    real = tmp_path / "real"
    real.mkdir()
    (real / "beside.py").write_text("")
    (real / "real.py").write_text("import sys, beside\nprint(sys.argv[0], __file__, sys.path[0])\n1 / 0")
    (tmp_path / "link.py").symlink_to(real / "real.py")
    (tmp_path / "folder").symlink_to(real)
    path = tmp_path / typed
    setup = RunRequest(files=[path], speed=1.0).setup()
    assert setup.title == path.name
    run = run_to_end(setup)
    assert printed(run) == [f"{path} {path} {real}"]
    assert run.ending.reason.startswith(f"{path.name}:3: the program raised ZeroDivisionError")


LAST_MESSAGE = """
import rclpy
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String
rclpy.init({options})
node = rclpy.create_node("last")
publisher = node.create_publisher(String, "last", 1)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    print("ok", rclpy.ok())
    node.get_logger().info("last line")
    publisher.publish(String(data="stop"))
    print("published")
"""


@pytest.mark.usefixtures("patient_engines")
@pytest.mark.slow
@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_a_last_message_fails_as_under_rclpy_once_ctrl_c_has_ended_the_context(
    tmp_path: Path, clock: str
) -> None:
    run = run_program(tmp_path, LAST_MESSAGE.format(options=""), seconds=1.0, clock=clock)
    assert run.ending.reason == "its time was up"
    assert not run.ending.failed
    assert printed(run)[0] == "ok False"
    assert [text for _, text in run.logs()] == ["last line"]
    assert "published" not in printed(run)
    (notice,) = (event.text for event in run.events if isinstance(event, Notice))
    said = "node.py:13: the program raised RCLError: Failed to publish: publisher's context is"
    assert notice.startswith(said)
    assert notice.endswith("call rclpy.init(signal_handler_options=SignalHandlerOptions.NO)")
    assert f"its end  {said}" in plain_text(summarise(run.timeline))


@pytest.mark.usefixtures("patient_engines")
@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_a_program_that_handles_ctrl_c_itself_publishes_a_last_message(tmp_path: Path, clock: str) -> None:
    source = LAST_MESSAGE.format(options="signal_handler_options=SignalHandlerOptions.NO")
    run = run_program(tmp_path, source, seconds=1.0, clock=clock)
    assert printed(run) == ["ok True", "published"]


CTRL_C_OF_ITS_OWN = """
import os, signal, time
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.signals import SignalHandlerOptions

def work():
    timer.cancel()
    time.sleep(1)
    print("worker done")

def press():
    os.kill(os.getpid(), signal.SIGINT)

rclpy.init(OPTIONS)
node = rclpy.create_node("busy")
timer = node.create_timer(0.5, work, callback_group=MutuallyExclusiveCallbackGroup())
node.create_timer(1.0, press)
executor = MultiThreadedExecutor(2)
executor.add_node(node)
try:
    executor.spin()
except KeyboardInterrupt:
    print("context", "lives" if rclpy.ok() else "ended")
"""


LEFT_ALONE = "signal_handler_options=SignalHandlerOptions.NO"


@pytest.mark.parametrize(
    ("options", "context"), first_row_daily(("", "context ended"), (LEFT_ALONE, "context lives"))
)
def test_ctrl_c_that_a_program_sends_itself_ends_its_context_and_no_callback_of_a_worker(
    tmp_path: Path, options: str, context: str
) -> None:
    run = run_program(tmp_path, CTRL_C_OF_ITS_OWN.replace("OPTIONS", options))
    assert printed(run) == [context, "worker done"]
    assert run.ending.t == 1_500_000_000


def test_a_worker_that_is_busy_does_not_delay_the_end_of_a_run_whose_time_is_up(tmp_path: Path) -> None:
    run = run_program(tmp_path, CTRL_C_OF_ITS_OWN.replace("OPTIONS", ""), seconds=0.75)
    assert run.ending.t == 750_000_000
    assert "worker done" not in printed(run)


SIGTERM_OF_ITS_OWN = """
import os
import signal
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.signals import SignalHandlerOptions

rclpy.init(OPTIONS)
node = rclpy.create_node("busy")
node.create_timer(0.5, lambda: os.kill(os.getpid(), signal.SIGTERM))
try:
    rclpy.spin(node)
except ExternalShutdownException:
    pass
print("context", "lives" if rclpy.ok() else "ended")
"""


def test_a_sigterm_that_a_program_sends_itself_ends_its_context(tmp_path: Path) -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2: ``spin`` returns or raises ExternalShutdownException.
    run = run_program(tmp_path, SIGTERM_OF_ITS_OWN.replace("OPTIONS", ""))
    assert run.ending.reason == "the program returned"
    assert printed(run)[-1] == "context ended"


@pytest.mark.slow
def test_a_sigterm_that_a_program_does_not_have_handled_kills_it(tmp_path: Path) -> None:
    run = run_program(tmp_path, SIGTERM_OF_ITS_OWN.replace("OPTIONS", LEFT_ALONE))
    assert run.loss == "the program crashed with SIGTERM"
