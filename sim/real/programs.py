"""The programs of a run on real rclpy: processes of their own, each with the probe on its path."""

import errno
import json
import os
import random
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from selectors import BaseSelector

from sim.engine.setup import RunSetup
from sim.probes.on_path.cbtui_probe import CHANGES, FOLDER
from sim.real.probe_link import LineReader, ProbeLink

ON_PATH = Path(__file__).parents[1] / "probes" / "on_path"
"""The folder that a probed program has on its path."""
_BOOTSTRAPPED = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
"""The environment variable by which ROS's wheels know that they have found their libraries."""
_DOMAINS = range(1, 102)
"""The ROS domains whose ports are free on every system."""
_LOG_BEGINS, _LOG_ENDS = "\x1e", "\x1f"
"""What rclpy's log lines stand between on the terminal: the probe tells of them too."""


def unbootstrapped(python: str) -> dict[str, str]:
    """This process's environment as an interpreter is to have it, with the probe's folder on its path.

    The wheels of this Python's ROS put their libraries there, which are not those of another one.
    """
    inherited = dict(os.environ)
    if python != sys.executable and inherited.pop(_BOOTSTRAPPED, ""):
        libraries = inherited.pop("LD_LIBRARY_PATH", "").split(os.pathsep)
        others = [each for each in libraries if each and not Path(each).is_relative_to(sys.prefix)]
        inherited |= {"LD_LIBRARY_PATH": os.pathsep.join(others)} if others else {}
    path = os.pathsep.join(filter(None, (str(ON_PATH), os.environ.get("PYTHONPATH"))))
    return {**inherited, "PYTHONPATH": path}


def watched_environment(python: str, folder: Path) -> dict[str, str]:
    """The environment of a process that others start, probed at a socket in ``folder``."""
    return {**unbootstrapped(python), FOLDER: str(folder)}


def claimed_domain() -> tuple[int, socket.socket]:
    """A ROS domain that no other run on this machine has, until the socket is closed.

    Raises:
        OSError: there are as many runs as domains.
    """
    claim = socket.socket(socket.AF_UNIX)
    for domain in random.sample(_DOMAINS, len(_DOMAINS)):
        with suppress(OSError):
            claim.bind(f"\0cbtui-domain-{domain}")  # of no file: it is free again when its process is gone
            return domain, claim
    claim.close()
    raise OSError(errno.EADDRINUSE, "every ROS domain has a run")


def environment(setup: RunSetup, python: str, folder: Path, domain: int) -> dict[str, str]:
    """The environment of a run's programs: probed at sockets in ``folder``, in a ROS domain of their own.

    Their probes make the changes of the set-up.
    """
    changes = {
        "threads": setup.threads,
        "groups": [(each.node, each.callback, each.wish) for each in setup.groups],
        "periods": [(each.node, each.callback, each.period) for each in setup.periods],
    }
    return {
        **watched_environment(python, folder),
        "PYTHONUNBUFFERED": "1",
        CHANGES: json.dumps(changes),
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "RCUTILS_COLORIZED_OUTPUT": "0",
        "RCUTILS_CONSOLE_OUTPUT_FORMAT": f"{_LOG_BEGINS}{{message}}{_LOG_ENDS}",
    }


class Program:
    """One program that was started. ``take`` gets what its probe sends, ``show`` the lines that it prints.

    ``number`` tells it from the others of the run, 0 for an only one.
    """

    def __init__(
        self,
        selector: BaseSelector,
        command: Sequence[str],
        environment: Mapping[str, str],
        number: int,
        take: Callable[..., None],
        show: Callable[[str, bool, int], None],
    ) -> None:
        self.number = number
        self.name = Path(command[1]).name
        self.link = ProbeLink(selector, partial(take, process=number))
        self._show = show
        self._open = 2
        self._signal: signal.Signals | None = None
        self._process = subprocess.Popen(
            command,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            bufsize=0,
        )
        for stream, error in ((self._process.stdout, False), (self._process.stderr, True)):
            assert stream is not None
            LineReader(selector, stream, partial(self._printed, error=error), self._one_less)

    def look(self, folder: Path) -> None:
        """Listen to its probe as soon as that listens in a folder."""
        self.link.connect(folder / f"{self._process.pid}.sock")

    @property
    def has_ended(self) -> bool:
        """Whether it is over, and all that it said has been taken."""
        return self._open == 0 and not self.link.is_open and self._process.poll() is not None

    @property
    def status(self) -> int:
        """Its exit code once it has ended; negative for the signal that killed it."""
        return self._process.returncode

    @property
    def was_ended(self) -> bool:
        """Whether it ended by the signal that it was sent."""
        return self._signal is not None and self.status == -self._signal

    def type(self, text: str, *, ends: bool) -> None:
        """Have it read a text from its standard input; with ``ends``, no more will come."""
        stdin = self._process.stdin
        assert stdin is not None
        with suppress(OSError, ValueError):
            stdin.write(text.encode())
            if ends:
                stdin.close()

    def signal(self, number: signal.Signals) -> None:
        """Send it, and what it started, a signal."""
        self._signal = number
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, number)

    def _one_less(self) -> None:
        self._open -= 1

    def _printed(self, data: bytes, error: bool) -> None:
        text = data.decode(errors="replace")
        if error and self.link.hello is not None:
            text = _without_log(text)
        for line in text.replace(_LOG_BEGINS, "").replace(_LOG_ENDS, "").splitlines():
            self._show(line, error, self.number)


def _without_log(text: str) -> str:
    """What a program wrote besides its log; a line of the log is written at once."""
    kept, _, rest = text.partition(_LOG_BEGINS)
    while rest:
        _, _, rest = rest.partition(_LOG_ENDS)
        more, _, rest = rest.removeprefix("\n").partition(_LOG_BEGINS)
        kept += more
    return kept
