"""Starts processes as forks of a server that has imported all they need."""

import multiprocessing
from collections.abc import Sequence
from multiprocessing import forkserver, resource_tracker
from multiprocessing.context import BaseContext

from cbtui.engines.session import engine_environment
from sim.clean_start import without_current_folder


def forking_context(modules: Sequence[str]) -> BaseContext:
    """Return what starts such processes; ``modules`` are imported once, before the first of them."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([*modules])
    with without_current_folder():
        resource_tracker.ensure_running()  # it lets SIGINT through when it has started, and forks must not
    with engine_environment():
        forkserver.ensure_running()
    return context
