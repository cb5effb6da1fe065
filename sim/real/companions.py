"""Helper processes on a run's ROS graph: the service caller, the process of ``ros2`` lines, the robot.

Each writes lines in the probe's format on standard output.
"""

import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from selectors import BaseSelector

import msgspec

from sim.engine.setup import RobotUse
from sim.real.probe_link import LineReader
from sim.real.wire import ProbeLine, Sent, decode_lines
from sim.robot.names import NAMES, own_sensor
from sim.trace.events import SENSOR_TOPICS, ArenaShown, EntityAppeared, EntityKind, Notice, Severity

_GRACE = 1.0
"""Seconds that a process has to end by itself."""


class Companion:
    """A helper process, started at its first use at the latest. ``take`` gets the lines that it writes."""

    def __init__(
        self,
        selector: BaseSelector,
        command: Sequence[str],
        environment: Mapping[str, str],
        take: Callable[[list[ProbeLine]], None],
    ) -> None:
        self._selector = selector
        self._command = command
        self._environment = environment
        self._take = take
        self._process: subprocess.Popen[bytes] | None = None
        self.has_spoken = False
        self.is_over = False

    def start(self) -> None:
        """Start it, unless it runs."""
        if self._process is None:
            self._process = subprocess.Popen(
                self._command,
                env=self._environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
                bufsize=0,
            )
            assert self._process.stdout is not None
            LineReader(self._selector, self._process.stdout, self._told, self._ended)

    @property
    def is_running(self) -> bool:
        """Whether it was started, and has not ended."""
        return self._process is not None and not self.is_over

    @property
    def is_awaited(self) -> bool:
        """Whether it runs, and has not written anything."""
        return self.is_running and not self.has_spoken

    def say(self, line: object) -> None:
        """Send it a request as a line of JSON."""
        self.start()
        assert self._process is not None
        assert self._process.stdin is not None
        with suppress(OSError):
            self._process.stdin.write(msgspec.json.encode(line) + b"\n")

    def stop(self) -> None:
        """End it: by SIGTERM, at which rclpy takes its files out of shared memory, or else by force."""
        if self._process is not None:
            assert self._process.stdin is not None
            self._process.stdin.close()
            self._process.terminate()
            try:
                self._process.wait(_GRACE)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()

    def _ended(self) -> None:
        self.is_over = True

    def _told(self, data: bytes) -> None:
        self.has_spoken = True
        self._take(decode_lines(data))


class ServiceCaller:
    """Calls services for the person at the console; ``python`` is an interpreter that has rclpy."""

    def __init__(
        self,
        selector: BaseSelector,
        python: str,
        environment: Mapping[str, str],
        take: Callable[[list[ProbeLine]], None],
    ) -> None:
        self._process = Companion(selector, [python, "-m", "cbtui_probe.caller"], environment, take)
        self._offered: list[str] = []
        self.start = self._process.start
        self.stop = self._process.stop

    def hear(self, lines: Iterable[ProbeLine]) -> None:
        """Note which services the programs offer."""
        self._offered += [
            line.name
            for line in lines
            if isinstance(line, EntityAppeared) and line.kind is EntityKind.SERVICE
        ]

    def set_bool(self, name: str | None, data: bool) -> str | None:
        """Call a SetBool service, the first on offer if ``name`` is empty; returns its name, if any."""
        names = self._offered if name is None else [name]
        if not names:
            return None
        self._process.say(["std_srvs/srv/SetBool", names, {"data": data}])
        return names[0]

    def reset_world(self) -> None:
        """Reset the robot."""
        self._process.say(["std_srvs/srv/Empty", ["/reset_world"], {}])


class RunRobot:
    """The robot of a run; its events are passed to ``take`` from its first use on, or from the beginning."""

    def __init__(
        self,
        use: RobotUse,
        sensor_rate: float | None,
        physics: str | None,
        selector: BaseSelector,
        environment: Mapping[str, str],
        take: Callable[[Iterable[ProbeLine]], None],
    ) -> None:
        command = [sys.executable, "-m", "sim.real.robot", str(sensor_rate or ""), physics or ""]
        self.process = Companion(selector, command, environment, self._told)
        self._take = take
        self._use = use
        self._is_used = use is RobotUse.ALWAYS
        self._arena: list[ProbeLine] = []
        """Events about its world from before its first use."""

    def start(self) -> None:
        """Start it, if the run has one."""
        if self._use is not RobotUse.NEVER:
            self.process.start()

    def hear(self, lines: Sequence[ProbeLine]) -> None:
        """Note whether a program uses one of its topics or services; it leaves if one publishes for it."""
        own = next((each for each in lines if isinstance(each, Sent) and each.topic in SENSOR_TOPICS), None)
        if own is not None and self._use is RobotUse.WHEN_USED:
            self._use = RobotUse.NEVER
            self._arena = [ArenaShown(0, (), (0, 0, 0), 0)]
            self._is_used = False
            self.process.stop()
            self._take([Notice(own.t, Severity.INFO, own_sensor(own.topic))])
        if not self._is_used and any(_name(line) in NAMES for line in lines):
            self._is_used = True
            self._take(msgspec.structs.replace(line, t=lines[0].t) for line in self._arena)

    def _told(self, lines: list[ProbeLine]) -> None:
        if self._is_used:
            self._take(lines)
        else:
            self._arena += [line for line in lines if isinstance(line, ArenaShown)]


def _name(line: ProbeLine) -> str:
    """The topic or service of an event; "" for none."""
    match line:
        case EntityAppeared(name=name) | Sent(topic=name):
            return name
        case _:
            return ""
