"""Event loops of asyncio on a run's clock."""

import asyncio
import sys
import threading
import time

from sim.clock import PacedClock
from sim.clock.asyncio_loops import ProgramLoops


def test_a_loop_on_a_paced_clock_keeps_its_pace() -> None:
    clock = PacedClock(speed=1e5)
    loop = ProgramLoops(clock).new_event_loop()
    loop.time = lambda: clock.now() / 1e9  # type: ignore[method-assign]
    began, wall = clock.now(), time.monotonic()
    loop.run_until_complete(asyncio.sleep(3600.0))
    loop.close()
    assert clock.now() - began >= 3600 * 1_000_000_000
    assert time.monotonic() - wall < 60


def test_every_main_thread_has_a_loop_before_python_3_14_and_other_threads_have_none() -> None:
    loops = ProgramLoops(PacedClock())
    found: list[object] = []

    def ask() -> None:
        try:
            loop = loops.get_event_loop()
        except RuntimeError as error:
            found.append(str(error))
        else:
            found.append(loop is loops.get_event_loop())
            loop.close()

    for name in ("MainThread", "worker"):
        thread = threading.Thread(target=ask, name=name)
        thread.start()
        thread.join()
    none = "There is no current event loop in thread '{}'."
    of_main = True if sys.version_info < (3, 14) else none.format("MainThread")
    assert found == [of_main, none.format("worker")]
