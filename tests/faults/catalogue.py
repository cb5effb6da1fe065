"""Every fault during which a person can press keys, by name, and what brings it about in a console."""

import os
import resource
import signal
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from typing import TypeAlias

from tests.benchmarks.console import RUNS, Console, opened
from tests.faults import test_nodes_careless, test_nodes_raging, test_nodes_that_end, test_world_engines
from tests.faults.test_world_disk import LONG, ROOM
from tests.support.processes import engines_of

Strike: TypeAlias = Callable[[Console], AbstractContextManager[object]]
"""Does something to a console that runs, or to what it has started; what it needs meanwhile stays open."""


@dataclass(frozen=True)
class Fault:
    """What a node's timer does, at its third call or from then on ``again``, or what strikes from outside."""

    code: str
    clock: str = "real"
    again: bool = False
    strike: Strike = nullcontext


@contextmanager
def engine_gets(number: signal.Signals, console: Console) -> Iterator[None]:
    """Send the engine a signal."""
    (engine,) = engines_of(console.process)
    os.kill(engine, number)
    yield


def killed(console: Console) -> AbstractContextManager[None]:
    """Kill the engine."""
    return engine_gets(signal.SIGKILL, console)


def stopped(console: Console) -> AbstractContextManager[None]:
    """Stop the engine."""
    return engine_gets(signal.SIGSTOP, console)


@contextmanager
def machine_slept(console: Console) -> Iterator[None]:
    """Let neither console nor engine do anything for a while."""
    both = [console.process, *engines_of(console.process)]
    for number in (signal.SIGSTOP, signal.SIGCONT):
        for each in both:
            os.kill(each, number)
        time.sleep(1)
    yield


@contextmanager
def disk_full(console: Console) -> Iterator[None]:
    """Have the console record, where no file may grow."""
    resource.prlimit(console.process, resource.RLIMIT_FSIZE, (ROOM, ROOM))
    console.press("R")
    yield


@contextmanager
def another_console(console: Console) -> Iterator[None]:
    """Open the same file in another console, and have both record."""
    console.press("R")
    with opened("open", "node.py") as other:
        other.until(RUNS)
        other.press("R")
        yield


FORKS = "while True:\n    if os.fork() == 0:\n        os.setsid()\n        time.sleep(100)"
FAULTS: Mapping[str, Fault] = {
    "nothing": Fault("pass"),
    **{name: Fault(each.fault, each.clock, again=True) for name, each in test_nodes_raging.FAULTS.items()},
    "allocates bit by bit": Fault("kept = []\nwhile True: kept.append(bytearray(b'x') * 2_000_000)"),
    "allocates at once": Fault("self.kept = b'x' * 3_000_000_000"),
    "forks": Fault("os.fork()"),
    "forks without end": Fault(FORKS),
    **{name: Fault(each.fault) for name, each in test_nodes_careless.FAULTS.items()},
    "waits for ever for a lock": Fault("lock = threading.Lock()\nlock.acquire()\nlock.acquire()"),
    "destroys itself": Fault("self.destroy_node()"),
    "velocities that are no numbers": Fault(test_nodes_careless.NO_NUMBERS, again=True),
    **{name: Fault(each.fault) for name, each in test_nodes_that_end.FAULTS.items()},
    "the engine is killed": Fault("pass", strike=killed),
    "the engine is killed within a message": Fault("print('x' * 20_000_000)", again=True, strike=killed),
    "the engine is stopped": Fault("pass", strike=stopped),
    "code in C keeps the engine": Fault(test_world_engines.IN_C),
    "the machine slept": Fault("pass", strike=machine_slept),
    "the disk is full while recording": Fault(LONG, again=True, strike=disk_full),
    "two consoles at once": Fault(LONG, again=True, strike=another_console),
}
