"""Starts a program in a terminal of its own, as on a machine where nobody has used it yet."""

import fcntl
import os
import pty
import struct
import subprocess
import sys
import termios
from collections.abc import Sequence
from pathlib import Path

_TERMINAL = {"TERM": "xterm-256color", "COLORTERM": "truecolor", "LC_ALL": "C.UTF-8"}


def start_in_terminal(
    words: Sequence[str], columns: int, rows: int, home: Path, *, has_job_control: bool = True
) -> "tuple[subprocess.Popen[bytes], int, int]":
    """Start Python with these words; return the process, and the terminal's far and near end.

    What is written to the far end is typed, what is read from it was drawn. Closing the far end hangs up; a
    process that has job control is told so.
    """
    far, near = pty.openpty()
    fcntl.ioctl(near, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
    folders = {f"XDG_{kind}_HOME": str(home) for kind in ("CONFIG", "DATA", "STATE", "CACHE")}
    environment = os.environ | _TERMINAL | folders | {"HOME": str(home)}
    environment.pop("NO_COLOR", None)
    process = subprocess.Popen(
        [sys.executable, *words],
        stdin=near,
        stdout=near,
        stderr=near,
        env=environment,
        start_new_session=True,
        preexec_fn=_control if has_job_control else None,  # noqa: PLW1509 -- as a shell's, to hang up
    )
    return process, far, near


def _control() -> None:
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
