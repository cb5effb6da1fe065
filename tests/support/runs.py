"""The door to hand-made runs for tests: the builder and the ready-made runs of the lessons."""

from tests.support.builder import EPOCH, Run, ns
from tests.support.lesson_runs import (
    dummy_server_one_thread_run,
    dummy_server_run,
    scan_from,
    shared_group_run,
    split_groups_run,
)

__all__ = [
    "EPOCH",
    "Run",
    "dummy_server_one_thread_run",
    "dummy_server_run",
    "ns",
    "scan_from",
    "shared_group_run",
    "split_groups_run",
]
