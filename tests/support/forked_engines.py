"""Engines as copies of a process that has imported all they need: one starts in a third of the CPU time."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing.context import ForkServerContext, ForkServerProcess

import pytest

from cbtui.engines import session
from cbtui.engines.forking import forking_context
from sim.engine.programs.ending import GRACE

_PRELOADED = (
    "cbtui.cli_commands",
    "cbtui.grading.supervisor",
    "sim.engine.preloaded",
    __name__,
)

grace = GRACE
"""Real seconds that the programs of engines which start have to end by themselves."""


class _Engine(ForkServerProcess):
    """A copy with the environment of the process that asked for it, as a fresh one, and its grace period."""

    def start(self) -> None:
        self._environment, self._grace = dict(os.environ), grace
        super().start()

    def run(self) -> None:
        os.environ.clear()
        os.environ.update(self._environment)
        pytest.MonkeyPatch().setattr("sim.engine.shutdown.GRACE", self._grace)
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
