"""Provokes faults for real: a small node file, a real engine, and the console's own run or screen."""

import asyncio
import os
import time
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from queue import Empty, Queue
from statistics import median
from typing import TypeAlias
from uuid import uuid4

import psutil
import pytest
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.engines.session import ProcessSession
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.live.playhead import Playhead
from cbtui.screens.lesson import LessonScreen
from cbtui.widgets.diagnosis import diagnosis_on_screen
from cbtui.widgets.diagnosis_line import DiagnosisLine
from sim.engine.setup import ProgramSetup, RobotUse, RunSetup
from sim.recording import Recording, read
from sim.trace.events import AnyEvent, Logged
from sim.trace.figures.concurrency import Concurrency
from tests.support.console import WIDE

News: TypeAlias = "list[AnyEvent] | str | None"

PATIENCE = 240.0
"""Real seconds after which what was to happen counts as not happening."""
ANSWERED = 0.2
"""Seconds within which a key is to be answered."""

_NODE = """\
import os, signal, subprocess, sys, threading, time
import rclpy
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool

class N(Node):
    def __init__(self):
        super().__init__('n')
        self.count = 0
        self.create_timer(0.02, self.tick)

    def tick(self):
        self.count += 1
        if self.count == 3 or (self.count > 3 and {again}):
            self.fault()
        if self.count == 8:
            self.get_logger().info('still here')

    def fault(self):
{body}

def main():
    rclpy.init()
    rclpy.spin(N())

if __name__ == '__main__':
    main()
"""
FIRST = _NODE[: _NODE.index("{body}")].count("\n") + 1
"""The line of a node file in which its fault begins."""


def node_with(folder: Path, fault: str, *, again: bool = False) -> Path:
    """Write a node whose timer commits a fault at its third call, and with ``again`` at each one after."""
    path = folder / "node.py"
    body = "\n".join(f"        {line}" for line in fault.strip("\n").split("\n"))
    path.write_text(_NODE.format(body=body, again=again))
    return path


@dataclass
class Provoked:
    """A run of a faulty node as the console holds it. It belongs to the thread of the test."""

    setup: RunSetup
    live: LiveRun = field(init=False)
    news: "Queue[News]" = field(default_factory=Queue)
    recorded: str | None = None
    over: bool = False

    def __post_init__(self) -> None:
        self.live = LiveRun(self.setup, ProcessSession, self.news.put, self.news.put)

    def until(self, condition: Callable[[LiveRun], bool]) -> None:
        """Take what the engine tells until something is so, or the engine is gone."""
        deadline = time.monotonic() + PATIENCE
        while not condition(self.live) and not self.over:
            assert time.monotonic() < deadline, f"it never came to it; said was {self.sentence!r}"
            with suppress(Empty):
                self._take(self.news.get(timeout=0.1))

    def to_its_end(self) -> None:
        """Take all until the engine is gone."""
        self.until(lambda _: False)

    def _take(self, news: News) -> None:
        if not isinstance(news, list):
            self.over = True
            finish = self.live.over(news)
            self.recorded = self.recorded if finish is None else finish()
            return
        first = self.live.timeline.started is None
        self.live.take(news)
        if first:
            self.live.record()

    @property
    def sentence(self) -> str:
        """What the line of the diagnosis says."""
        return diagnosis_on_screen(self.live, Playhead(), Concurrency(self.live.timeline)).text

    @property
    def notices(self) -> list[str]:
        """The engine's own sentences."""
        return [notice.text for notice in self.live.timeline.notices]

    @property
    def printed(self) -> list[str]:
        """The lines that the program logged and printed."""
        return [line.text for line in self.live.timeline.logs]

    def recording(self) -> Recording:
        """The recording that was being made, read again."""
        (path,) = Path.cwd().glob("*.mcap")
        return read(path)


@contextmanager
def provoked(path: Path, clock: str = "real", robot: RobotUse = RobotUse.NEVER) -> Iterator[Provoked]:
    """Run a node file, recording from the beginning; nothing of it may be left, and the recording opens."""
    setup = RunSetup(title="fault", programs=(ProgramSetup(str(path)),), clock=clock, speed=None, robot=robot)
    with nothing_left():
        run = Provoked(setup)
        run.live.start()
        try:
            yield run
        finally:
            run.recorded = run.live.stop() or run.recorded
    assert run.recorded is not None
    assert run.recorded.startswith("Recorded ")
    assert run.recording().damage is None
    assert sum(map(len, run.recording().batches())) > 0


def still_here(live: LiveRun) -> bool:
    """Whether the node has gone on after its fault."""
    return any(isinstance(line, Logged) and line.text == "still here" for line in live.timeline.logs)


@contextmanager
def nothing_left() -> Iterator[None]:
    """Check that every process started inside has ended, in whatever group or session it is.

    Whoever watches over an engine ends by itself a moment after it.
    """
    name, value = "CBTUI_FAULT", uuid4().hex
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(name, value)
        yield
    deadline = time.monotonic() + PATIENCE
    while (left := list(_marked(name, value))) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not left, f"left behind: {left}"


def _marked(name: str, value: str) -> Iterator[str]:
    """The command lines of the processes that have an entry in their environment."""
    for process in psutil.process_iter():
        with suppress(psutil.Error):
            command = " ".join(process.cmdline())
            marked = process.pid != os.getpid() and process.environ().get(name) == value
            # The tracker is the test's own, started with the first engine.
            if marked and "resource_tracker" not in command:
                yield command


@dataclass
class Console:
    """A console with a faulty node on its screen."""

    app: CbtuiApp
    pilot: Pilot[None]
    screen: LessonScreen

    async def until(self, condition: Callable[[LiveRun], bool]) -> None:
        """Wait until something is so of the run on screen."""
        deadline = time.monotonic() + PATIENCE
        while not condition(self.screen.runs.run):
            assert time.monotonic() < deadline, "it never came to it"
            await asyncio.sleep(0.01)

    @property
    def said(self) -> str:
        """What the line of the diagnosis says."""
        diagnosis = self.screen.query_one(DiagnosisLine).diagnosis
        return "" if diagnosis is None else diagnosis.text

    async def answers(self) -> None:
        """Press keys until the console's own thread computes less than ``ANSWERED`` before it answers most.

        Time on the wall would tell of whatever else the machine does, which makes computing slower, too, but
        not for ever: a console that has too much to do, or only waits, does not come to it within
        ``PATIENCE``.
        """
        deadline = time.monotonic() + PATIENCE
        while (computed := median(await self._press_keys())) >= ANSWERED:
            assert time.monotonic() < deadline, f"a key is answered after {computed:.2f} s"

    async def _press_keys(self, keys: int = 9) -> list[float]:
        """Return the seconds that the console's own thread computes before it answers each of some keys."""
        taken = []
        for number in range(keys):
            wanted = ("code", "factory")[number % 2]
            pressed, computed = time.monotonic(), time.thread_time()
            self.app.simulate_key(str(self.screen.PANES_HERE.index(wanted) + 1))
            while not self.screen.query_one(f"#{wanted}").has_class("-current"):
                assert time.monotonic() - pressed < PATIENCE, "a key was never answered"
                await asyncio.sleep(0.005)
            taken.append(time.thread_time() - computed)
            await asyncio.sleep(0.05)
        return taken


@asynccontextmanager
async def console_on(path: Path, clock: str = "real") -> AsyncIterator[Console]:
    """A console with a node file open; nothing may be left when it is closed."""
    with nothing_left():
        app = CbtuiApp(start_file=(path, [], clock))
        app.animation_level = "none"
        async with app.run_test(size=WIDE, notifications=True) as pilot:
            while not isinstance(app.screen, LessonScreen):
                await pilot.pause()
            yield Console(app, pilot, app.screen)
