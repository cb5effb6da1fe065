"""Sets of threads, futures and tasks have the same order in each run, wherever these lie in memory.

Python's are replaced for good, so each program has a process.
"""

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from tests.support.daily import first_daily

_PRELUDE = """
import asyncio, concurrent.futures, contextlib, random, sys, threading, time
from sim.clock import VirtualClock
from sim.clock.asyncio_loops import ProgramLoops
from sim.clock.hashes import number_tasks
from sim.clock.stdlib import live_on
clock = VirtualClock()
live_on(clock)
number_tasks(clock)
ProgramLoops(clock).install()

class Lumber:
    pass

layout = random.Random(int(sys.argv[1]))
lumber = [(Lumber(), Lumber().__dict__) for _ in range(4000)]
layout.shuffle(lumber)
del lumber[:2000]  # what is made from here on lies in the holes

async def named(name):
    await asyncio.sleep(0.1)
    print("ran", name)
    return name

async def until_cancelled(name):
    try:
        await asyncio.sleep(9)
    finally:
        print("cancelled", name)
"""
PROGRAMS = {
    "threads": """
        print([each.name for each in {threading.Thread() for _ in range(20)}])
        """,
    "the threads of a pool": """
        with concurrent.futures.ThreadPoolExecutor(20) as pool:
            list(pool.map(time.sleep, [0.1] * 20))
            print([each.name for each in pool._threads])
        """,
    "futures that are done": """
        with concurrent.futures.ThreadPoolExecutor(20) as pool:
            futures = [pool.submit(lambda each=each: each) for each in range(20)]
            print([each.result() for each in concurrent.futures.wait(futures).done])
            print([each.result() for each in concurrent.futures.as_completed(futures)])
        """,
    "locks of futures": """
        futures = [concurrent.futures.Future() for _ in range(20)]
        taken = concurrent.futures._base._AcquireFutures(futures).futures
        print([futures.index(each) for each in taken])
        """,
    "tasks that are done": """
        async def main():
            done, _ = await asyncio.wait([asyncio.create_task(named(each)) for each in range(20)])
            print([each.result() for each in done])
        asyncio.run(main())
        """,
    "coroutines as they complete": """
        async def main():
            print([await each for each in asyncio.as_completed([named(each) for each in range(20)])])
        asyncio.run(main())
        """,
    "tasks that are left at the end": """
        async def main():
            for each in range(20):
                asyncio.create_task(until_cancelled(each))
            await asyncio.sleep(1)
        asyncio.run(main())
        """,
    "futures of a loop": """
        async def main():
            futures = [asyncio.get_running_loop().create_future() for _ in range(20)]
            print([futures.index(each) for each in set(futures)])
        asyncio.run(main())
        """,
}


@pytest.mark.parametrize("program", first_daily(*PROGRAMS))
def test_a_set_has_the_same_order_wherever_its_elements_lie(program: str) -> None:
    printed = {_run(PROGRAMS[program], layout) for layout in range(3)}
    assert len(printed) == 1, "\n".join(printed)


def _run(program: str, layout: int) -> str:
    """What a program prints whose objects lie where ``layout``, a seed, leaves holes."""
    return subprocess.run(
        [sys.executable, "-c", _PRELUDE + textwrap.dedent(program), str(layout)],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        check=True,
    ).stdout
