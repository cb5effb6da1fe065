"""How long a person waits for the menu, for a lesson's first callbacks, and for the help."""

import subprocess
import sys
import time

from tests.benchmarks.console import QUESTION, RUNS, SKIPS, opened

_MENU = rb"open.*quit"
"""Keys that the menu names below its list."""


def menu(_: int) -> float:
    """The seconds from typing the command to the menu."""
    with opened() as console:
        return console.until(_MENU)


def lesson(_: int) -> float:
    """The seconds from the key that begins a lesson to its first callbacks on screen."""
    with opened() as console:
        console.until(_MENU)
        console.watch(1.0)
        console.press("3\r")
        console.until(QUESTION)
        console.press(SKIPS)
        return console.until(RUNS)


def command_help(_: int) -> float:
    """The seconds from typing ``cbtui --help`` to its end."""
    began = time.perf_counter()
    command = [sys.executable, "-m", "cbtui", "--help"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began
