"""A ``ros2`` line that a launch file starts: one more process of the launch."""

import shlex
from collections.abc import Sequence

from sim.engine.programs.programs import ProgramSupervisor
from sim.engine.programs.starting import ProgramStarter
from sim.launch import OnOutput
from sim.shell import OnExit, ShellLine
from sim.shell.model_ground import ModelGround
from sim.trace.events import Printed, ProcessEnded


class LaunchedLine:
    """Starts the line when it is created."""

    def __init__(
        self,
        programs: ProgramSupervisor,
        starter: ProgramStarter,
        label: str,
        words: Sequence[str],
        on_exit: OnExit,
        on_output: OnOutput,
    ) -> None:
        self._programs = programs
        self._on_exit = on_exit
        self._on_output = on_output
        self.number = programs.announce(label)
        ground = ModelGround(programs.host)
        self._line = ShellLine(ground, shlex.join(words), starter, self._take, self._end)
        self._line.start()

    def interrupt(self) -> None:
        """End the line as Ctrl-C would; other signals do the same."""
        self._line.interrupt()

    terminate = kill = interrupt

    def _take(self, text: str, error: bool) -> None:
        self._programs.record(Printed(self._programs.host.clock.now(), text, error, self.number))
        self._on_output(text, error)

    def _end(self, status: int) -> None:
        now = self._programs.host.clock.now()
        self._programs.record(ProcessEnded(now, self.number, "the line is done", status))
        self._on_exit(status)
