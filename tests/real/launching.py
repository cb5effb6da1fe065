"""Programs started as a run on real rclpy starts them, without an engine or rclpy."""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from selectors import DefaultSelector

from sim.engine.setup import Keyboard, ProgramSetup
from sim.real.keyboard import RealKeyboard
from sim.real.launched import LaunchedPrograms
from sim.real.programs import OnExit
from sim.trace.events import AnyEvent

LONGEST = 60.0
"""Seconds after which a test gives up."""


@dataclass
class Launched:
    """Programs that run, and what was told of them."""

    folder: Path
    environment: dict[str, str] = field(default_factory=lambda: {**os.environ, "PYTHONUNBUFFERED": "1"})
    events: list[AnyEvent] = field(default_factory=list)
    printed: list[str] = field(default_factory=list)
    lines: list[list[str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.selector = DefaultSelector()

    def start(
        self,
        python: str,
        *programs: ProgramSetup,
        keyboard: Keyboard = Keyboard.LIVE,
    ) -> LaunchedPrograms:
        self.keyboard = RealKeyboard(self.events.append, keyboard, 0)
        self.programs = LaunchedPrograms(
            self.selector,
            self.folder,
            programs,
            python,
            self.environment,
            self.keyboard,
            lambda _lines, process=0: None,
            self.events.append,
            lambda text, _error, _process: self.printed.append(text),
            self._run_line,
        )
        self.programs.start()
        return self.programs

    def _run_line(
        self, words: Sequence[str], show: Callable[[str, bool], None], on_exit: OnExit
    ) -> Callable[[], None]:
        self.lines.append([*words])
        show("said", False)
        on_exit(0)
        return lambda: None

    def until(self, done: Callable[[], bool]) -> None:
        end = time.monotonic() + LONGEST
        while not done():
            assert time.monotonic() < end, self.printed
            for key, _ in self.selector.select(0.005):
                key.data()
            self.programs.look()

    def to_end(self) -> None:
        self.until(lambda: not self.programs.any_run)

    def of(self, kind: type[AnyEvent]) -> list[AnyEvent]:
        return [event for event in self.events if isinstance(event, kind)]
