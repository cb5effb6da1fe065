"""Processes that others started."""

import time

import psutil

_LIMIT = 60.0
"""Seconds after which a process that should have ended counts as left."""


def descendants(process: int) -> list[int]:
    """Return the numbers of all processes that a process started, and that those started."""
    return [each.pid for each in psutil.Process(process).children(recursive=True)]


def engines_of(console: int) -> list[int]:
    """Return the numbers of a console's engines, from their first moment on."""
    children = psutil.Process(console).children()
    return [each.pid for each in children if "spawn_main" in command_line(each.pid)]


def command_line(process: int) -> str:
    """Return the words that a process was started with; "" if it has ended."""
    try:
        return " ".join(psutil.Process(process).cmdline())
    except psutil.NoSuchProcess:
        return ""


def environment(process: int) -> dict[str, str]:
    """Return the environment that a process was started with; an empty one if it has ended."""
    try:
        return psutil.Process(process).environ()
    except psutil.NoSuchProcess:
        return {}


def port_of(process: int) -> int:
    """Return the only port on which a process listens."""
    connections = psutil.Process(process).net_connections("tcp")
    (port,) = (each.laddr.port for each in connections if each.status == psutil.CONN_LISTEN)
    return port


def alive(process: int) -> bool:
    """Tell whether a process still does something."""
    return _state(process) not in {psutil.STATUS_ZOMBIE, psutil.STATUS_DEAD}


def wait_until_gone(processes: list[int]) -> None:
    """Wait until none of them does anything: whoever watches over an engine ends a moment after it."""
    end = time.monotonic() + _LIMIT
    while any(map(alive, processes)):
        assert time.monotonic() < end, "a process is left"
        time.sleep(0.01)


def is_stopped(process: int) -> bool:
    """Tell whether a process was stopped by a signal."""
    return _state(process) == psutil.STATUS_STOPPED


def _state(process: int) -> str:
    try:
        return psutil.Process(process).status()
    except psutil.NoSuchProcess:
        return psutil.STATUS_DEAD
