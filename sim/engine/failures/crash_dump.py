"""The crash dump: where a program's threads stood when its process ended without Python's help.

``faulthandler`` writes it to a file that the console handed to the engine: when C code crashes, when the
process is aborted, and when the console asks by a signal. The console reads the file once the engine is gone.
"""

import faulthandler
import os
import re
import signal
from collections.abc import Callable, Iterable, Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

ASKED = getattr(signal, "SIGRTMAX", signal.SIGUSR2)
"""The signal by which the console asks where the threads stand: one that hardly any program uses."""

_FRAME = re.compile(r'  File "(.*)", line (\d+) in (.*)')
_THREAD = re.compile(r"^(Current thread|Thread) 0x[^\n]*\n(.*?)(?=^$|\Z)", re.MULTILINE | re.DOTALL)
_KEPT = "Timeout ("
"""Begins what ``faulthandler`` writes when its time is up."""
_CUT = "\n  ..."
"""Ends a list of frames of which there are too many to write them all down."""

_MODEL = str(Path(__file__).parents[2])


class _Frame(NamedTuple):
    file: str
    line: str
    function: str


def enable_crash_dump(file: Connection, flush: Callable[[], None]) -> None:
    """Write crash dumps to ``file`` from now on; ``flush`` sends what waits to be sent.

    ``os._exit``, of which the interpreter takes no notice, writes and flushes before it ends the process.
    """
    number = file.fileno()
    os.set_inheritable(number, False)
    faulthandler.enable(number, all_threads=True)
    faulthandler.register(ASKED, number, all_threads=True)
    leave, engine = os._exit, os.getpid()

    def leave_with_crash_dump(status: int) -> NoReturn:
        if os.getpid() == engine:
            faulthandler.dump_traceback(number, all_threads=True)
            flush()
        leave(status)

    module: Any = os
    module._exit = leave_with_crash_dump


def exit_unless_renewed(file: Connection, seconds: float) -> None:
    """End the process with a crash dump unless this is called again in time, which code in C may prevent."""
    faulthandler.dump_traceback_later(seconds, exit=True, file=file.fileno())


def timed_out(crash_dump: str) -> bool:
    """Whether the process ended because ``exit_unless_renewed`` was not called again."""
    return _KEPT in crash_dump


def place_in(crash_dump: str, programs: Iterable[str]) -> str:
    """Where in the learner's own files a thread stood, as "node.py:42, in tick"; "" if nowhere.

    ``programs`` are the paths of the programs. The thread that crashed takes precedence, then one that was
    computing in a file of theirs.
    """
    paths = [Path(each) for path in programs for each in (path, os.path.realpath(path))]
    folders = tuple(f"{path.parent}{os.sep}" for path in paths)
    threads = [_frames(text) for text in _threads(crash_dump)]
    busy = [frames for frames in threads[1:] if frames and _is_own(frames[0].file, folders)]
    for frames in (*threads[:1], *busy, *threads[1:]):
        for file, line, function in frames:
            if _is_own(file, folders):
                return f"{Path(file).name}:{line}, in {function}"
    return ""


def overflowed(crash_dump: str) -> bool:
    """Whether the thread that crashed had called more functions within one another than can be told."""
    return any(_CUT in text for text in _threads(crash_dump)[:1])


def _threads(crash_dump: str) -> list[str]:
    """The frames of each thread, those of the current one first."""
    found = sorted(_THREAD.findall(crash_dump), key=lambda each: each[0] != "Current thread")
    return [text for _, text in found]


def _frames(text: str) -> Sequence[_Frame]:
    return [_Frame(*found) for found in _FRAME.findall(text)]


def _is_own(file: str, folders: tuple[str, ...]) -> bool:
    own = file.startswith(folders) and "site-packages" not in file
    return own and (not file.startswith(_MODEL + os.sep))
