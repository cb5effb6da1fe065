"""The crash dump: where a program's threads were when its process ended without Python's help.

``faulthandler`` writes it to a file that the console opens for the engine: when C code crashes, when the
process is aborted, and when the console sends a signal. The console reads the file once the engine is gone.
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
"""The signal by which the console requests a crash dump; hardly any program uses it."""

_FRAME = re.compile(r'  File "(.*)", line (\d+) in (.*)')
_THREAD = re.compile(r"^(Current thread|Thread) 0x[^\n]*\n(.*?)(?=^$|\Z)", re.MULTILINE | re.DOTALL)
_TIMEOUT = "Timeout ("
"""The start of a crash dump that ``faulthandler`` writes at its timeout."""
_CUT = "\n  ..."
"""The end of a list of frames that ``faulthandler`` has shortened."""

_MODEL = str(Path(__file__).parents[2])


class _DumpFrame(NamedTuple):
    file: str
    line: str
    function: str


def enable_crash_dump(file: Connection, flush: Callable[[], None]) -> None:
    """Write crash dumps to ``file`` from now on; ``flush`` sends the waiting events.

    ``os._exit``, which the interpreter does not notice, writes a dump and flushes before it ends the process.
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
    """End the process with a crash dump unless this is called again in time, which C code may prevent."""
    faulthandler.dump_traceback_later(seconds, exit=True, file=file.fileno())


def timed_out(crash_dump: str) -> bool:
    """Return whether the process ended because ``exit_unless_renewed`` was not called again."""
    return _TIMEOUT in crash_dump


def place_in(crash_dump: str, programs: Iterable[str]) -> str:
    """Return where in the learner's files a thread was, as "node.py:42, in tick"; "" for none.

    ``programs`` are the paths of the programs. The crashed thread takes precedence, then one that was
    computing in one of their files.
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


def left_process(crash_dump: str) -> bool:
    """Return whether a program ended the process by ``os._exit()``."""
    frames = [each for text in _threads(crash_dump)[:1] for each in _frames(text)]
    is_left = bool(frames[1:]) and frames[0].function == "leave_with_crash_dump"
    return is_left and not frames[1].file.startswith(_MODEL)


def overflowed(crash_dump: str) -> bool:
    """Return whether the crashed thread had more nested calls than the dump shows."""
    return any(_CUT in text for text in _threads(crash_dump)[:1])


def _threads(crash_dump: str) -> list[str]:
    """Return the frames of each thread, those of the current one first."""
    found = sorted(_THREAD.findall(crash_dump), key=lambda each: each[0] != "Current thread")
    return [text for _, text in found]


def _frames(text: str) -> Sequence[_DumpFrame]:
    return [_DumpFrame(*found) for found in _FRAME.findall(text)]


def _is_own(file: str, folders: tuple[str, ...]) -> bool:
    own = file.startswith(folders) and "site-packages" not in file
    return own and (not file.startswith(_MODEL + os.sep))
