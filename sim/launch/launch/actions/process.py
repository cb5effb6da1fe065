"""Actions that start processes and end them."""

# ruff: noqa: D102 -- what a method does that overrides another stands with that one

from __future__ import annotations

import re
import shlex
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from sim.launch.errors import LaunchFailure
from sim.launch.launch._processes import LaunchLine, Upkeep
from sim.launch.launch.action import Action, LaunchDescriptionEntity
from sim.launch.launch.actions.flow import seconds
from sim.launch.launch.conditions import is_true
from sim.launch.launch.event_handlers import OnProcessExit
from sim.launch.launch.events.process import ShutdownProcess as ShutdownProcessEvent
from sim.launch.launch.launch_context import LaunchContext
from sim.launch.launch.substitution import normalize_to_list_of_substitutions, performed
from sim.launch.machine import ProcessSpec

_PYTHON = re.compile(r"python(3(\.\d+)?)?")
_OUTPUTS = {"screen": "screen", "log": "log", "both": "both", "full": "both", "own_log": "log"}
_IGNORED = frozenset(("emulate_tty", "log_cmd", "cached_output", "output_format", "shell"))
"""Options that only change how a terminal or a shell takes part, of which there is none."""


class ExecuteLocal(Action):
    """The base of actions that start a process."""

    completes_at_once = False

    def __init__(
        self,
        *,
        name: Any = None,
        exec_name: Any = None,
        prefix: Any = None,
        output: Any = "log",
        env: dict[Any, Any] | None = None,
        additional_env: dict[Any, Any] | None = None,
        cwd: Any = None,
        on_exit: Any = None,
        respawn: Any = False,
        respawn_delay: float | None = None,
        respawn_max_retries: int = -1,
        sigterm_timeout: Any = 5,
        sigkill_timeout: Any = 5,
        condition: Any = None,
        **others: Any,
    ) -> None:
        super().__init__(condition=condition)
        if prefix is not None:
            raise NotImplementedError(
                f"{type(self).__name__}(prefix=…) is not supported: nothing can stand before a program here"
            )
        if env is not None:
            raise NotImplementedError(f"{type(self).__name__}(env=…) is not supported; use additional_env")
        for option in set(others) - _IGNORED:
            raise TypeError(f"{type(self).__name__} has no argument {option!r}")
        self._name = exec_name if exec_name is not None else name
        self._output = output
        self._environment = dict(additional_env or {})
        self._cwd = cwd
        self._on_exit = on_exit
        self._respawn = respawn
        self._respawn_delay = respawn_delay or 0.0
        self._most_respawns = respawn_max_retries
        self._timeouts = (sigterm_timeout, sigkill_timeout)

    def execute(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity] | None:
        if context.is_shutdown:
            return None
        what = self.prepare(context)
        if self._on_exit is not None:
            context.register_event_handler(OnProcessExit(target_action=self, on_exit=self._on_exit))
        sigterm, sigkill = (seconds(context, each, "a timeout") for each in self._timeouts)
        upkeep = Upkeep(
            is_true(context, self._respawn), self._respawn_delay, self._most_respawns, sigterm, sigkill
        )
        context.processes.start(self, what, upkeep)
        return None

    def prepare(self, context: LaunchContext) -> ProcessSpec | LaunchLine:
        """What to start."""
        raise NotImplementedError(f"{type(self).__name__} does not implement prepare()")

    def label(self, context: LaunchContext, program: str) -> str:
        """The label of the process."""
        name = program if self._name is None else performed(context, self._name)
        return context.processes.label(name)

    def environment(self, context: LaunchContext) -> dict[str, str]:
        """The variables that are different for the process."""
        own = {
            performed(context, name): performed(context, value) for name, value in self._environment.items()
        }
        return {**context.changed_environment, **own}

    def working_folder(self, context: LaunchContext) -> Path | None:
        """The folder that the process is to work in."""
        return None if self._cwd is None else Path(performed(context, self._cwd))

    def output(self, context: LaunchContext) -> str:
        """``screen``, ``log`` or ``both``."""
        if isinstance(self._output, dict):
            raise NotImplementedError("an output per stream is not supported; give 'screen', 'log' or 'both'")
        name = performed(context, self._output)
        if name not in _OUTPUTS:
            raise LaunchFailure(f"the output {name!r} is none of {', '.join(_OUTPUTS)}")
        return _OUTPUTS[name]


class ExecuteProcess(ExecuteLocal):
    """Runs a ``ros2`` line or a Python file."""

    def __init__(self, *, cmd: Iterable[Any], shell: bool = False, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self.cmd = [normalize_to_list_of_substitutions(each) for each in cmd]
        self._shell = shell

    def prepare(self, context: LaunchContext) -> ProcessSpec | LaunchLine:
        words = [performed(context, each) for each in self.cmd]
        if self._shell:
            words = shlex.split(" ".join(words))
        program = Path(words[0]).name if words else ""
        if program == "ros2":
            return LaunchLine(self.label(context, program), ("ros2", *words[1:]))
        if _PYTHON.fullmatch(program) and len(words) > 1 and not words[1].startswith("-"):
            return self._file(context, program, words[1:])
        raise NotImplementedError(
            f"ExecuteProcess cannot run {' '.join(words)!r} here: only 'ros2 …' and 'python3 FILE.py …' are"
        )

    def _file(self, context: LaunchContext, program: str, words: list[str]) -> ProcessSpec:
        cwd = self.working_folder(context)
        path = (cwd or Path()) / words[0]
        if not path.is_file():
            raise LaunchFailure(f"the file {path} of an ExecuteProcess does not exist")
        return ProcessSpec(
            label=self.label(context, program),
            path=path.absolute(),
            folder=path.resolve().parent,
            arguments=tuple(words[1:]),
            environment=self.environment(context),
            output=self.output(context),
            working_folder=cwd,
        )


class ShutdownProcess(Action):
    """Ends the processes of some actions: of one, or of those that a callable picks."""

    def __init__(self, *, process_matcher: Any, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._matcher = process_matcher

    def execute(self, context: LaunchContext) -> None:
        context.emit_event(ShutdownProcessEvent(process_matcher=self._matcher))
