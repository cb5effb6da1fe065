"""A multiprocessing context that forks processes from a server with modules already imported."""

import multiprocessing
from collections.abc import Sequence
from multiprocessing import forkserver, resource_tracker
from multiprocessing.context import BaseContext

from cbtui.engines.session import engine_environment
from sim.interpreter.safe_path import without_current_folder


def forking_context(modules: Sequence[str]) -> BaseContext:
    """Return a multiprocessing context that forks from a server, which imports ``modules`` once."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([*modules])
    with without_current_folder():
        resource_tracker.ensure_running()  # it unblocks SIGINT as it starts, and forks must keep it blocked
    with engine_environment():
        forkserver.ensure_running()
    return context
