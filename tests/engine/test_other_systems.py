"""What Linux alone has is not needed: a run on a Python without it, as on a Mac."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

WITHOUT = """
import os, select, selectors, signal, time
gone = {
    select: [name for name in dir(select) if name.lower().startswith("epoll")],
    selectors: ["EpollSelector"],
    signal: ["sigtimedwait", "sigwaitinfo", "SIGRTMIN", "SIGRTMAX", "SIGPWR", "SIGPOLL", "SIGSTKFLT"],
    os: [
        "pipe2", "posix_fadvise", "copy_file_range", "splice", "getrandom", "eventfd", "memfd_create",
        "pidfd_open", "sched_getaffinity", "sched_setaffinity", "getresuid", "setresuid",
    ],
    time: ["CLOCK_BOOTTIME", "CLOCK_TAI", "pthread_getcpuclockid"],
}
for module, names in gone.items():
    for name in names:
        vars(module).pop(name, None)
selectors.DefaultSelector = selectors.PollSelector
"""


@pytest.mark.slow
@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_a_run_needs_nothing_that_linux_alone_has(clock: str, tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text(WITHOUT)
    command = [sys.executable, "-m", "cbtui", "run", "split-groups", "--for", "1", "--clock", clock]
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("split-groups, 1.0 s of ")
