"""Runs ``cbtui`` and presses Ctrl-C at a moment: ``python interrupted.py MOMENT WORDS …``.

The moment is the so-many-th call of a function on the main thread, from the command's first line on, or the
first call of a function that is named: the same each time, however busy the machine is. As in a terminal,
every process of the group gets SIGINT. A file ``interrupted`` tells that it came to that; not where the
command had done all that it has to do.
"""

import os
import runpy
import signal
import sys
from pathlib import Path
from types import FrameType

_FIRST = str(Path("cbtui", "__main__.py"))


def run(moment: str) -> None:
    """Run ``sys.argv`` as the ``cbtui`` command."""
    calls = 0

    def count(frame: FrameType, event: str, _argument: object) -> None:
        nonlocal calls
        if event == "call" and (calls or frame.f_code.co_filename.endswith(_FIRST)):
            calls += 1
            if moment in (str(calls), frame.f_code.co_qualname):
                sys.setprofile(None)
                if signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
                    Path("interrupted").touch()
                    os.killpg(0, signal.SIGINT)

    sys.setprofile(count)
    runpy.run_module("cbtui", run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    moment, sys.argv = sys.argv[1], ["cbtui", *sys.argv[2:]]
    run(moment)
