"""Engines that run a program in the order of threads that a seed chooses."""

from pathlib import Path
from queue import Queue

import msgspec
import pytest

from cbtui.engines.forking import forking_context
from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.lesson_setup import setup_to_judge
from lessons.catalogue import find
from sim.engine.setup import ProgramSetup, RobotUse, RunSetup
from sim.trace.events import AnyEvent, Notice, Severity
from tests.commands.exploring_files import LOCK_ORDER
from tests.support.engine_runs import SECOND, run_to_end

SETUP = msgspec.structs.replace(setup_to_judge(find("lock-or-group")), until=7 * SECOND, robot=RobotUse.NEVER)


def seeded(seed: int | None) -> list[AnyEvent]:
    return run_to_end(msgspec.structs.replace(SETUP, seed=seed)).events


def forked(seed: int) -> list[AnyEvent]:
    """The events of a run in a copy of a process that has imported all."""
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session = ProcessSession(
        msgspec.structs.replace(SETUP, seed=seed),
        news.put,
        news.put,
        context=forking_context(["sim.engine.process"]),
    )
    session.start()
    events: list[AnyEvent] = []
    try:
        while isinstance(batch := news.get(timeout=60), list):
            events += batch
    finally:
        session.stop()
    assert batch is None
    return events


@pytest.mark.slow
@pytest.mark.usefixtures("fresh_engines")
def test_a_seed_gives_the_same_trace_in_a_fresh_process_and_in_a_copy() -> None:
    assert seeded(4) == forked(4) == forked(4)


def test_seed_0_is_the_usual_order_and_others_are_not() -> None:
    usual = seeded(None)
    assert seeded(0) == usual
    assert seeded(1) != usual


def test_threads_that_wait_for_each_others_locks_are_told_of_with_their_places(tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    slow = LOCK_ORDER.replace("with self.one, self.two:", "with self.one, wait(), self.two:")
    file.write_text(slow + _WAIT)
    run = run_to_end(
        RunSetup(
            title="mine.py",
            programs=(ProgramSetup(str(file)),),
            robot=RobotUse.NEVER,
            speed=None,
            until=SECOND,
        )
    )
    (notice,) = (each for each in run.events if isinstance(each, Notice) and each.severity is Severity.ERROR)
    assert notice.text.startswith("deadlock: ThreadPoolExecutor-0_")
    assert ", in forth) waits for self.two, which ThreadPoolExecutor-0_" in notice.text
    assert ", in back) waits for self.one, which ThreadPoolExecutor-0_" in notice.text
    assert " took at mine.py:" in notice.text
    assert 0.1 * SECOND < notice.t < 0.5 * SECOND


_WAIT = """

class wait:
    def __enter__(self):
        import time
        time.sleep(0.05)

    def __exit__(self, *_):
        pass
"""
