"""Engines as copies of a process that has imported all they need: one starts in a third of the CPU time."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.context import ForkServerContext, ForkServerProcess

import pytest

from cbtui.engines import session
from cbtui.engines.forking import forking_context

_PRELOADED = (
    "cbtui.cli_commands",
    "cbtui.grading.supervisor",
    "sim.engine.preloaded",
    __name__,
)


class _Engine(ForkServerProcess):
    """A copy that has the environment of the process that asked for it, as a fresh one has."""

    def start(self) -> None:
        self._environment = dict(os.environ)
        super().start()

    def run(self) -> None:
        os.environ.clear()
        os.environ.update(self._environment)
        super().run()


class _Context(ForkServerContext):
    Process = _Engine


@contextmanager
def forked() -> Iterator[None]:
    """Let sessions that are given no context copy their engines."""
    forking_context(_PRELOADED)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(session, "SPAWN_CONTEXT", _Context())
        yield
