"""Nodes that take more than there is: memory and processes are watched from outside, and all are ended."""

import os
from pathlib import Path
from threading import Timer

import pytest

from cbtui import cli
from cbtui.engines import resource_guard
from cbtui.engines.memory_limit import MEMORY_LIMIT, memory_limit
from cbtui.runs.live.live_run import RunState
from sim.engine.failures.crash_dump import ASKED
from tests.faults.support import FIRST, node_with, provoked, still_here
from tests.support.daily import first_daily
from tests.support.processes import wait_until_gone

LITTLE = "0.3"
"""GB that a node may use here: twice what an engine takes."""


@pytest.mark.parametrize("clock", first_daily("real", "virtual"))
@pytest.mark.parametrize(
    "fault",
    ["kept = []\nwhile True: kept.append(bytearray(b'x') * 2_000_000)", "self.kept = b'x' * 3_000_000_000"],
    ids=["bit by bit", "at once"],
)
def test_a_node_that_takes_memory_without_end_is_ended_and_told_with_its_place(
    folder: Path, fault: str, clock: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(MEMORY_LIMIT, LITTLE)
    with provoked(node_with(folder, fault), clock) as run:
        run.to_its_end()
        assert run.live.loss is not None
        assert run.live.loss.startswith("the node used more than 0.3 GB of memory and was ended (node.py:")
        assert run.live.loss.endswith("in fault)")
        assert run.live.state is RunState.LOST


def test_the_place_is_told_though_a_busy_machine_delays_the_dump_of_the_stacks(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(MEMORY_LIMIT, LITTLE)
    kill = os.kill

    def kill_later(process: int, number: int) -> None:
        if number == ASKED:
            Timer(0.5, kill, (process, number)).start()
        else:
            kill(process, number)

    with provoked(node_with(folder, "self.kept = [b'x' * 1_000_000_000]\ntime.sleep(100)")) as run:
        monkeypatch.setattr(os, "kill", kill_later)
        run.to_its_end()
        assert run.live.loss is not None
        assert run.live.loss.endswith("in fault)")


def test_the_memory_of_what_a_node_starts_counts(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(MEMORY_LIMIT, LITTLE)
    hog = "[sys.executable, '-c', 'import time; x = b\"x\" * 900_000_000; time.sleep(100)']"
    with provoked(node_with(folder, f"subprocess.Popen({hog})")) as run:
        run.to_its_end()
        assert run.live.loss is not None
        assert run.live.loss.startswith("the node used more than 0.3 GB of memory and was ended")


def test_the_memory_limit_is_what_the_environment_says_and_never_more_than_half_of_the_machine_else(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(MEMORY_LIMIT, "1.5")
    assert memory_limit() == 1_500_000_000
    monkeypatch.delenv(MEMORY_LIMIT)
    assert 0 < memory_limit() <= 4_000_000_000


@pytest.mark.parametrize("text", ["", "much", "0", "-1", "nan", "inf"])
def test_a_memory_limit_that_is_no_number_is_refused_in_a_sentence(
    text: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(MEMORY_LIMIT, text)
    with pytest.raises(SystemExit) as ended:
        cli.main(["run", "hello"])
    assert ended.value.code == 2
    said = f"cbtui: CBTUI_MEMORY_GB has to be a number of GB above 0, such as 4, and is {text!r}\n"
    assert capsys.readouterr().err == said


def test_a_node_that_forks_goes_on_and_its_other_half_is_told_that_it_has_no_ros(folder: Path) -> None:
    with provoked(node_with(folder, "os.fork()")) as run:
        run.until(
            lambda live: still_here(live) and any("cannot use ROS here" in line for line in run.printed)
        )
        assert run.live.alive


def test_forking_does_not_live_on_virtual_time_and_says_so(folder: Path) -> None:
    with provoked(node_with(folder, "os.fork()"), "virtual") as run:
        run.to_its_end()
        assert f"node.py:{FIRST}: the program raised NotImplementedError: os.fork does not" in run.sentence


@pytest.mark.slow
def test_a_node_that_forks_without_end_is_ended_with_all_that_came_of_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(resource_guard, "_MOST_PROCESSES", 12)
    fault = """
for _ in range(40):
    if os.fork() == 0:
        os.setsid()
        time.sleep(100)
time.sleep(9)
"""
    with provoked(node_with(folder, fault)) as run:
        run.to_its_end()
        assert run.live.loss is not None
        assert run.live.loss.startswith("the node had more than 12 processes and was ended (node.py:")


def test_nothing_that_a_node_starts_outlives_it(folder: Path) -> None:
    fault = """
os.system('sleep 300 &')
subprocess.Popen(['sleep', '300'], start_new_session=True)
subprocess.Popen(['sh', '-c', 'setsid sleep 300 & exit'])
"""
    with provoked(node_with(folder, fault)) as run:
        run.until(still_here)


@pytest.mark.parametrize(
    "ends", ["time.sleep(0.2)", "os._exit(3)", "time.sleep(1.5); os.kill(os.getpid(), 9)"]
)
def test_a_daemon_with_a_session_and_an_environment_of_its_own_ends_with_the_run(
    folder: Path, ends: str
) -> None:
    told = folder / "pid"
    fault = f"""
subprocess.run(['setsid', '-f', 'env', '-i', 'sh', '-c', 'echo $$ > {told}; exec sleep 300'])
while not os.path.exists({str(told)!r}) or not open({str(told)!r}).read(): time.sleep(0.01)
{ends}
rclpy.shutdown()
"""
    with provoked(node_with(folder, fault)) as run:
        run.to_its_end()
    wait_until_gone([int(told.read_text())])


@pytest.mark.slow
def test_nothing_that_a_node_started_outlives_its_crash(folder: Path) -> None:
    fault = (
        "subprocess.Popen(['sleep', '300'], start_new_session=True)\nos.system('sleep 300 &')\nos._exit(1)"
    )
    with provoked(node_with(folder, fault)) as run:
        run.to_its_end()
        assert run.live.state is RunState.LOST
