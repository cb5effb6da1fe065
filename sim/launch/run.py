"""Carries out a launch file: its description, its processes, and their events."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from sim.launch.arguments import read_arguments
from sim.launch.errors import LaunchError, explained
from sim.launch.launch._processes import Processes
from sim.launch.launch.action import Action, LaunchDescriptionEntity
from sim.launch.launch.event import Event
from sim.launch.launch.events import Shutdown
from sim.launch.launch.events.process import ShutdownProcess
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.loading import load_description
from sim.launch.machine import Machine
from sim.packages import Packages, find_packages, use_packages


class LaunchRun:
    """One run of a launch file with ``name:=value`` arguments.

    ``packages`` become the process's known packages; None: those around the file. ``on_finish`` is called
    once, with the exit status, when no process or timer is left.

    Not thread-safe: ``start``, ``interrupt`` and the machine's calls must come on one thread or under one
    lock. The machine may call back inside its own methods.
    """

    def __init__(
        self,
        path: Path,
        arguments: Sequence[str],
        machine: Machine,
        *,
        packages: Packages | None = None,
        on_finish: Callable[[int], None] | None = None,
    ) -> None:
        self._path = path.absolute()
        self._arguments = tuple(arguments)
        self._packages = packages if packages is not None else find_packages(self._path)
        self._on_finish = on_finish
        self._context = LaunchContext(machine, self._packages, self._path, self._happen)
        self._context.argv = self._arguments
        self._context.processes = Processes(self._context, self._visit, self._wake)
        self._busy = False
        self.finished = False
        self.error: LaunchError | None = None
        """The error after the start, if there was one."""

    @property
    def status(self) -> int:
        """The exit status: 1 if the launch itself failed, whatever its processes returned."""
        return 0 if self.error is None else 1

    def start(self) -> None:
        """Run the launch file and carry out its description.

        Raises:
            LaunchError: the file or an argument is wrong; no process has been started then.
        """
        self._context.launch_configurations.update(read_arguments(self._arguments))
        use_packages(self._packages)
        self._context.say("Default logging verbosity is set to INFO")
        description = load_description(self._path)
        self._visit(description)
        self._wake(lambda: None)

    def interrupt(self) -> None:
        """Do what Ctrl-C does: end every process; a second one is logged and has no effect."""
        self._context.say("user interrupted with ctrl-c (SIGINT)", "WARNING")
        event = Shutdown(reason="ctrl-c (SIGINT)", due_to_sigint=True)
        self._wake(lambda: self._happen(event))

    def _wake(self, deed: Callable[[], None]) -> None:
        """Run an action and all actions that it queues, after the running one."""
        queue = self._context.queue
        queue.append(deed)
        if self._busy:
            return
        self._busy = True
        try:
            while queue:
                self._do(queue.pop(0))
        finally:
            self._busy = False
        if not self.finished and not self._context.processes.any_left:
            self.finished = True
            if self._on_finish is not None:
                self._on_finish(self.status)

    def _do(self, deed: Callable[[], None]) -> None:
        try:
            deed()
        except Exception as error:  # noqa: BLE001 -- an error of a launch file ends the launch, not the engine
            self.error = explained(error, self._path)
            self._context.say(f"Caught exception in launch: {self.error}", "ERROR")
            self._happen(Shutdown(reason=str(self.error)))

    def _happen(self, event: Event) -> None:
        """Do what the launch itself does about an event, and call its handlers."""
        if isinstance(event, Shutdown):
            if self._context.is_shutdown:
                return
            self._context.is_shutdown = True
            self._context.later(lambda: self._context.processes.end_all(event))
        if isinstance(event, ShutdownProcess):
            matcher = event.process_matcher
            is_meant = matcher if not isinstance(matcher, Action) else matcher.__eq__
            self._context.processes.end_of(is_meant)
        for handler in self._context.handlers:
            if handler.matches(event):
                self._context.event = event
                try:
                    for entity in handler.handle(event, self._context):
                        self._visit(entity)
                finally:
                    self._context.event = None

    def _visit(self, entity: LaunchDescriptionEntity) -> None:
        """Visit an entity and the entities that it returns, in order.

        Raises:
            LaunchError: an entity fails; the text names the line that created it.
        """
        try:
            found = entity.visit(self._context)
            inside = [] if found is None else list(found)
        except Exception as error:
            place = entity.place if isinstance(entity, Action) else None
            raise explained(error, self._context.launch_file, place) from error
        for each in inside:
            self._visit(each)
