"""The programs of a run on real rclpy: processes of their own, each with the probe on its path."""

import errno
import fcntl
import json
import os
import random
import re
import signal
import socket
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from selectors import BaseSelector
from typing import NamedTuple

from sim.engine.failures.cause import Cause
from sim.engine.failures.failure import Failure
from sim.engine.setup import RunSetup
from sim.interpreter.exception_text import UNREADABLE
from sim.interpreter.safe_path import left_out
from sim.probes.on_path.cbtui_probe import CHANGES, FOLDER, PORT, TOKEN
from sim.real.printed_traceback import PrintedTraceback
from sim.real.probe_link import LineReader, ProbeLink
from sim.real.wire import Uncaught
from sim.trace.events import Notice, NoticeKind, Severity

ON_PATH = Path(__file__).parents[1] / "probes" / "on_path"
"""The folder that a probed program has on its path."""
_LAST_WORDS = 0.5
"""Seconds to wait for the output of a program that has ended."""
_RAISED = 1
"""The exit status of a Python program that an exception ended."""
_BOOTSTRAPPED = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
"""The environment variable that ROS's wheels set once they have found their libraries."""
_OF_TEXT = re.compile(r"\(.*, line \d+\)$")
"""The end of a syntax error's message if the text at fault is not the file that was given."""
_DOMAINS = range(1, 102)
"""The ROS domains whose ports are free on every system."""
_LOG_BEGINS, _LOG_ENDS = "\x1e", "\x1f"
"""Markers around rclpy's log lines in the output; the probe reports these lines as events."""


def unbootstrapped(python: str) -> dict[str, str]:
    """The environment for another interpreter: this process's, with the probe's folder on Python's path.

    Library paths that this interpreter's ROS wheels have added are removed: another one has its own.
    """
    inherited = dict(os.environ)
    if python != sys.executable and inherited.pop(_BOOTSTRAPPED, ""):
        libraries = inherited.pop("LD_LIBRARY_PATH", "").split(os.pathsep)
        others = [each for each in libraries if each and not Path(each).is_relative_to(sys.prefix)]
        inherited |= {"LD_LIBRARY_PATH": os.pathsep.join(others)} if others else {}
    path = os.pathsep.join(filter(None, (str(ON_PATH), os.environ.get("PYTHONPATH"))))
    return {**inherited, "PYTHONPATH": path}


def watched_environment(
    python: str, folder: Path, port: int | None = None, token: str = ""
) -> dict[str, str]:
    """The environment of a process whose probe listens at a socket in ``folder``.

    With a ``port`` it also listens on the loopback interface, for consoles that send the ``token``.
    """
    reached = {} if port is None else {PORT: str(port), TOKEN: token}
    return {**unbootstrapped(python), FOLDER: str(folder), **reached}


def claimed_domain() -> tuple[int, socket.socket]:
    """A ROS domain that no other run on this machine uses, reserved until the socket is closed.

    Raises:
        OSError: every domain is in use.
    """
    claim = socket.socket(socket.AF_UNIX)
    for domain in random.sample(_DOMAINS, len(_DOMAINS)):
        with suppress(OSError):
            claim.bind(f"\0cbtui-domain-{domain}")  # of no file: it is free again when its process is gone
            return domain, claim
    claim.close()
    raise OSError(errno.EADDRINUSE, "every ROS domain has a run")


def environment(setup: RunSetup, python: str, folder: Path, domain: int) -> dict[str, str]:
    """The environment of a run's programs: probes listen in ``folder``, in a ROS domain of the run's own.

    The probes apply the set-up's changes.
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
        "RCUTILS_CONSOLE_OUTPUT_FORMAT": _LOG_BEGINS
        + "[{severity}] [{time}] [{name}]: {message}"
        + _LOG_ENDS,
    }


STOPPED = "it was stopped"
"""The ending of a program that was asked to end."""

OnExit = Callable[[int], None]
"""Takes an exit status, once."""


class Start(NamedTuple):
    """How a program is started."""

    command: Sequence[str]
    environment: Mapping[str, str]
    folder: Path | None = None
    """The working directory; None: that of the run."""
    terminal: int | None = None
    """The terminal that it reads from; None: its input is empty."""
    owns_terminal: bool = False
    """Whether the terminal is also its controlling terminal, ``/dev/tty``."""


class Program:
    """One program that was started. ``take`` gets what its probe sends, ``show`` the lines that it prints.

    ``number`` identifies it in the run, 0 if it is the only one; ``name`` is its name for people.
    """

    def __init__(
        self,
        selector: BaseSelector,
        start: Start,
        name: str,
        number: int,
        take: Callable[..., None],
        show: Callable[[str, bool, int], None],
    ) -> None:
        self.number = number
        self.name = name
        self.link = ProbeLink(selector, partial(take, process=number))
        self._show = show
        self._open = 2
        self.output_listener: Callable[[str, bool], None] | None = None
        """Also gets every line of output, log lines included; set by a launch file."""
        self.reads = start.terminal is not None
        """Whether it has the keyboard."""
        self._traceback = PrintedTraceback()
        self._ended_at = 0.0
        self._sent: signal.Signals | None = None
        """The last signal that it was sent."""
        self._process = subprocess.Popen(
            start.command,
            env=left_out(start.environment),
            cwd=start.folder,
            stdin=subprocess.DEVNULL if start.terminal is None else start.terminal,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            preexec_fn=_own_terminal if start.owns_terminal else None,  # noqa: PLW1509 -- one system call
            bufsize=0,
        )
        self.process = self._process.pid
        """Its process id."""
        self._readers = [
            LineReader(selector, stream, partial(self._printed, error=error), self._one_less)
            for stream, error in ((self._process.stdout, False), (self._process.stderr, True))
            if stream is not None
        ]

    def look(self, folder: Path) -> None:
        """Connect to its probe once it listens in a folder."""
        self.link.connect(folder / f"{self.process}.sock")

    @property
    def has_ended(self) -> bool:
        """Whether it has ended and its output has been read.

        Child processes may keep its output open; they are waited for only briefly.
        """
        if self._process.poll() is None:
            return False
        self._ended_at = self._ended_at or time.monotonic()
        is_late = time.monotonic() > self._ended_at + _LAST_WORDS
        return is_late or (self._open == 0 and not self.link.is_open)

    @property
    def status(self) -> int:
        """Its exit code once it has ended; negative for the signal that killed it."""
        return self._process.returncode

    def outcome(self) -> Cause:
        """How it ended."""
        uncaught, status = self.link.uncaught, self.status
        if uncaught is None and status == _RAISED and not self.link.has_left:
            uncaught = self._traceback.uncaught()
        if uncaught is not None:
            return ended_by(uncaught, "the program", self._advice(uncaught.error))
        if status == -signal.SIGINT or (self._sent is not None and status == -self._sent):
            return Cause(STOPPED, failed=False)
        if status < 0:
            return Cause(f"the program crashed with {signal.Signals(-status).name}", failed=True)
        reason = "the program returned" if status == 0 else f"the program ended with exit code {status}"
        advice = self._advice(self._traceback.error)
        return Cause(f"{reason}; {advice}" if advice else reason, failed=status != 0)

    def _advice(self, error: str) -> str:
        from sim.real.missing import on_missing

        return on_missing(error, self.link.hello.distribution if self.link.hello else "")

    def show_rest(self) -> None:
        """Show all output so far, even an unfinished line."""
        for reader in self._readers:
            reader.read_all()

    def interrupt(self) -> None:
        """Send SIGINT to it and its children, as Ctrl-C does."""
        self._signal(signal.SIGINT)

    def terminate(self) -> None:
        """Send SIGTERM to it and its children."""
        self._signal(signal.SIGTERM)

    def kill(self) -> None:
        """Kill it and its children."""
        self._signal(signal.SIGKILL)

    def _signal(self, number: signal.Signals) -> None:
        self._sent = number
        with suppress(ProcessLookupError):
            os.killpg(self.process, number)

    def _one_less(self) -> None:
        self._open -= 1

    def _printed(self, data: bytes, error: bool) -> None:
        text = data.decode(errors="replace")
        if self.output_listener is not None:
            for line in _lines(text):
                self.output_listener(line, error)
        if error and self.link.hello is not None:
            text = _without_log(text)
        for line in _lines(text):
            if error:
                self._traceback.take(line)
            self._show(line, error, self.number)


def ended_by(uncaught: Uncaught, name: str, advice: str = "") -> Cause:
    """The end by an exception of the program that people know as ``name``."""
    is_unreadable = uncaught.exception in UNREADABLE and not _OF_TEXT.search(uncaught.error)
    failure = Failure(
        uncaught.file,
        uncaught.line,
        uncaught.error.partition(": ")[2] if is_unreadable else f"{name} raised {uncaught.error}",
        uncaught.advice or advice,
        uncaught.exception,
    )
    return Cause(failure.sentence, True, uncaught.error, failure)


def raised_by(uncaught: Uncaught) -> Notice:
    """What is told of a program that an exception ends once its other threads have ended."""
    cause = ended_by(uncaught, "the program")
    assert cause.failure is not None
    return Notice(
        uncaught.t,
        Severity.ERROR,
        cause.reason,
        kind=NoticeKind.PROGRAM_RAISED,
        problem=cause.failure.what,
        advice=cause.failure.advice,
        place=(cause.failure.file, cause.failure.line),
        error=cause.error,
    )


def _own_terminal() -> None:
    if os.isatty(0):  # else the machine has no pseudo-terminals
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)


def _lines(text: str) -> list[str]:
    return text.replace(_LOG_BEGINS, "").replace(_LOG_ENDS, "").splitlines()


def _without_log(text: str) -> str:
    """The output of a program without its log lines, each of which is written in one piece."""
    kept, _, rest = text.partition(_LOG_BEGINS)
    while rest:
        _, _, rest = rest.partition(_LOG_ENDS)
        more, _, rest = rest.removeprefix("\n").partition(_LOG_BEGINS)
        kept += more
    return kept
