"""Submissions that want marks which they have not earned, or to do harm to others' marks.

Most are the starter of an exercise, which fails its check, with something before it. ``written`` puts in the
paths that a program on the grader's machine can guess.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cbtui.learning.lesson_scaffold import TEMPLATE

STARTER = (TEMPLATE / "starter.py").read_text()
SOLUTION = (TEMPLATE / "solution.py").read_text()


@dataclass(frozen=True)
class Targets:
    """What a program would like to reach: files of the lesson, a neighbour's, the table of marks."""

    checks: Path
    solution: Path
    neighbour: Path
    table: Path


def written(source: str, targets: Targets) -> str:
    """Return a forgery's source for the paths of one machine."""
    for name in ("checks", "solution", "neighbour", "table"):
        source = source.replace(f"@{name}@", repr(str(getattr(targets, name))))
    return source


def _first(code: str) -> str:
    return f"{code}\n{STARTER}"


def _if_it_can(code: str) -> str:
    """The starter, behind something that may be refused; indented by four."""
    return _first(f"import contextlib, os, signal\nwith contextlib.suppress(OSError):\n    {code}")


_PIPES = """
import gc, itertools, os, struct
gc.unfreeze()
from multiprocessing.connection import Connection
pipes = [each for each in gc.get_objects() if isinstance(each, Connection) and not each.closed]
send = Connection.send_bytes
"""
_OUTBOX = """
import gc, sys
gc.unfreeze()
outbox = next(each for each in gc.get_objects() if type(each).__name__ == "Outbox")
events = sys.modules["sim.trace.events"]
"""

REACHING_OUT: Mapping[str, str] = {
    "overwrites a neighbour": _if_it_can("open(@neighbour@, 'w').write('raise SystemExit(1)')"),
    "removes a neighbour": _if_it_can("os.unlink(@neighbour@)"),
    "writes to the table": _if_it_can("open(@table@, 'a').write('ann,blinking,0,1\\n')"),
    "removes the table": _if_it_can("os.unlink(@table@)"),
    "kills its parent": _if_it_can("os.kill(os.getppid(), signal.SIGKILL)"),
    "executes the solution": "import runpy\nrunpy.run_path(@solution@, run_name='__main__')\n",
    "executes the text of the solution": "exec(compile(open(@solution@).read(), __file__, 'exec'))\n",
    "puts the solution in its own place": (
        "import runpy, shutil\nshutil.copy(@solution@, __file__)\n"
        "runpy.run_path(__file__, run_name='__main__')\n"
    ),
    "imports a copy of the solution": (
        "import pathlib, shutil\nshutil.copy(@solution@, pathlib.Path(__file__).with_name('mine.py'))\n"
        "import mine\nmine.main()\n"
    ),
}
"""What namespaces make impossible, and what is noticed where there are none."""

ENDING: Mapping[str, str] = {
    "appends to the checks": _if_it_can("open(@checks@, 'a').write('CHECKS = CHECKS[:0] + CHECKS[:1]\\n')"),
    "leaves compiled checks": _if_it_can(
        "os.makedirs(os.path.dirname(@checks@) + '/__pycache__', exist_ok=True); "
        "open(os.path.dirname(@checks@) + '/__pycache__/more.pyc', 'w').write('x')"
    ),
}
"""What ends the grading where there are no namespaces."""

ON_THE_TRACE: Mapping[str, str] = {
    "writes to the pipe": _first(f"{_PIPES}\nfor pipe in pipes: pipe.send_bytes(b'\\x91\\xa7run_end')"),
    "repeats batches": _first(
        f"{_PIPES}\ndef twice(pipe, data, *more):\n    send(pipe, data, *more)\n    send(pipe, data, *more)\n"
        "Connection.send_bytes = twice"
    ),
    "leaves out batches": _first(
        f"{_PIPES}\nplaces = itertools.count()\ndef some(pipe, data, *more):\n"
        "    if next(places) % 2: send(pipe, data, *more)\nConnection.send_bytes = some"
    ),
    "ends twice": _first(f"{_OUTBOX}\noutbox.record(events.RunEnded(1, 'its time was up', False))"),
    "begins twice": _first(f"{_OUTBOX}\noutbox.record(events.RunStarted(0, 'blinking', 'virtual', 0))"),
    "tells of a callback that is not there": _first(
        f"{_OUTBOX}\noutbox.record(events.CallbackStarted(0, 77, 1, 0, 0, 0))"
    ),
    "goes back in time": _first(
        f"{_OUTBOX}\nfor t in (10**9, 0): outbox.record(events.Published(t, 10**6 + t, '/odom', 0, 0))"
    ),
    "tells of code that it does not have": _first(
        f"{_OUTBOX}\nevents_of = [events.NodeAppeared(0, 1, '/n'), "
        "events.GroupAppeared(0, 1, 1, events.GroupKind.EXCLUSIVE, 'X'), "
        "events.EntityAppeared(0, 1, 1, 1, events.EntityKind.TIMER, '', 'blink', __file__, 2, 3, 0, 1)]\n"
        "for each in events_of: outbox.record(each)"
    ),
    "tells nothing of waits": _first(
        "import sys\nsys.modules['sim.probes.probe'].Probe.waits = lambda *_: None"
    ),
    "changes the code of a function": _first(
        "import sys\ndef waits(self, entity, reason, holder, workers_busy): pass\n"
        "sys.modules['sim.probes.probe'].Probe.waits.__code__ = waits.__code__"
    ),
    "slows the clock down": _first(
        "import sys\nclock = sys.modules['sim.clock.virtual'].VirtualClock\n"
        "now = clock.now\nclock.now = lambda self: now(self) // 2"
    ),
    "replaces the outbox's recording": _first(
        f"{_OUTBOX}\nrecord = outbox.record\noutbox.record = lambda event: record(event)"
    ),
    "imports the engine": f"import sim.probes.probe\n{SOLUTION}",
}
"""What a program can do to its trace, and is suspicious for."""

IN_VAIN: Mapping[str, str] = {
    "announces a message without end": _first(
        f"{_PIPES}\nfor pipe in pipes: os.write(pipe.fileno(), struct.pack('!iQ', -1, 1 << 62))"
    ),
    "closes everything": "import os\nos.closerange(3, 4096)\nos._exit(0)\n",
    "has no end": "while True: pass\n",
    "waits without an end": "import threading\nthreading.Event().wait()\n",
    "writes without an end": "while True: print('x' * 1_000_000)\n",
    "leaves": "import os\nos._exit(0)\n",
    "crashes": "import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n",
    "stops itself": "import os, signal\nos.kill(os.getpid(), signal.SIGSTOP)\n",
    "starts processes without an end": (
        "import subprocess, sys\nwhile True: subprocess.Popen([sys.executable, '-c', 'input()'], stdin=-1)\n"
    ),
    "looks for the checks": "open(@checks@).read()\nraise SystemExit('read')\n",
    "says what a spreadsheet obeys": "raise SystemExit('=cmd|calc')\n",
    "says what a terminal obeys": "raise SystemExit('\\x1b]0;title\\x07\\x1b[2J')\n",
    "fills the disk": _if_it_can("[open('big', 'ab').write(bytes(1 << 20)) for _ in range(400)]"),
    "is no Python": "def main(:\n",
    "is empty": "",
    "is nested without an end": "(" * 5000 + ")" * 5000 + "\n",
}
"""What fails, however it ends."""
