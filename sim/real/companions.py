"""What takes part in a run's ROS graph beside its programs: who calls services, ``ros2`` lines, the robot.

Each is a process of its own that tells on standard output, line by line, what a probe would tell of it.
"""

import subprocess
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from selectors import BaseSelector

import msgspec

from sim.real.probe_link import LineReader
from sim.real.wire import ProbeLine, decode_lines


class Companion:
    """A process that is started with its first use, or before. ``take`` gets what it tells."""

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

    def say(self, line: object) -> None:
        """Have it read a line of JSON."""
        self.start()
        assert self._process is not None
        assert self._process.stdin is not None
        with suppress(OSError):
            self._process.stdin.write(msgspec.json.encode(line) + b"\n")

    def stop(self) -> None:
        """End it."""
        if self._process is not None:
            assert self._process.stdin is not None
            self._process.stdin.close()
            self._process.kill()
            self._process.wait()

    def _ended(self) -> None:
        self.is_over = True

    def _told(self, data: bytes) -> None:
        self.has_spoken = True
        self._take(decode_lines(data))
