"""Runs of a real engine process, collected for a test."""

from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from queue import Queue

import msgspec

from cbtui.engines.session import ProcessSession
from cbtui.runs.setup.lesson_setup import setup_for
from lessons.catalogue import find
from sim.engine.setup import ProgramSetup, RobotUse, RunSetup, TimedCall
from sim.trace.events import AnyEvent, CallbackStarted, EntityAppeared, Logged, RunEnded
from sim.trace.timeline import Timeline

SECOND = 1_000_000_000
_LIMIT = 60.0
"""Real seconds after which a run that sends nothing is given up."""


@dataclass
class Run:
    """All the events of a run, and how its engine ended."""

    events: list[AnyEvent] = field(default_factory=list)
    loss: str | None = None

    @property
    def timeline(self) -> Timeline:
        """The timeline that checks look at."""
        timeline = Timeline(until_ending=True)
        timeline.extend(self.events)
        return timeline

    @property
    def ending(self) -> RunEnded:
        """How the run ended."""
        last = self.events[-1]
        assert isinstance(last, RunEnded)
        return last

    def logs(self) -> list[tuple[float, str]]:
        """Time in seconds and text of every log line."""
        return [(event.t / SECOND, event.text) for event in self.events if isinstance(event, Logged)]

    def starts(self, callback: str) -> list[float]:
        """When a callback started, in seconds."""
        ids = {e.entity for e in self.events if isinstance(e, EntityAppeared) and e.callback == callback}
        return [e.t / SECOND for e in self.events if isinstance(e, CallbackStarted) and e.entity in ids]


def run_to_end(setup: RunSetup) -> Run:
    """Run an engine until it ends by itself."""
    news: Queue[list[AnyEvent] | str | None] = Queue()
    session = ProcessSession(setup, news.put, news.put)
    run = Run()
    session.start()
    try:
        while isinstance(batch := news.get(timeout=_LIMIT), list):
            run.events += batch
        run.loss = batch
    finally:
        session.stop()
    return run


@lru_cache(maxsize=16)
def run_lesson(lesson: str, seconds: float, *calls: float, threads: int | None = None) -> Run:
    """Run a lesson on virtual time as fast as it goes, calling its service at the times given."""
    setup = setup_for(find(lesson), threads=threads, speed=None)
    return run_to_end(
        msgspec.structs.replace(
            setup,
            until=round(seconds * SECOND),
            calls=tuple(TimedCall(round(at * SECOND), data=True) for at in calls),
        )
    )


def run_program(
    folder: Path,
    source: str,
    seconds: float = 5.0,
    clock: str = "virtual",
    *,
    robot: bool = False,
    distro: str = "",
) -> Run:
    """Write a program to a folder and run it."""
    path = folder / "node.py"
    path.write_text(source)
    setup = program_setup(path, seconds, clock, robot=robot)
    return run_to_end(msgspec.structs.replace(setup, distro=distro))


def program_setup(path: Path, seconds: float, clock: str = "virtual", *, robot: bool = False) -> RunSetup:
    """The set-up of a run of a program file as fast as it goes."""
    return RunSetup(
        title=path.name,
        programs=(ProgramSetup(str(path)),),
        clock=clock,
        speed=None,
        until=round(seconds * SECOND),
        robot=RobotUse.ALWAYS if robot else RobotUse.NEVER,
    )
