"""A lock that only who has taken it releases guards something; one that others release is a signal."""

import sys
from pathlib import Path
from typing import Any

import pytest

from sim.interpreter.guarding import takes_to_guard

GUARDS = """
def take(lock, look):
    lock.acquire()
    look()
    lock.release()
"""
SIGNALS = """
def take(lock, look):
    lock.acquire()
    look()
"""
RELEASED_BY_ANOTHER = f"""{GUARDS}
def ring(node):
    node.lock.release()
"""


class Seen:
    """Looks at the frame that takes it."""

    def __init__(self) -> None:
        self.guards: list[bool] = []

    def acquire(self) -> None:
        self.guards.append(takes_to_guard(sys._getframe(1)))

    def release(self) -> None:
        pass


@pytest.mark.parametrize(
    ("source", "guards"), [(GUARDS, True), (SIGNALS, False), (RELEASED_BY_ANOTHER, False)]
)
def test_a_lock_guards_if_every_function_that_releases_it_takes_it(
    source: str, guards: bool, tmp_path: Path
) -> None:
    file = tmp_path / "node.py"
    file.write_text(source)
    names: dict[str, Any] = {}
    exec(compile(source, str(file), "exec"), names)
    seen = Seen()
    names["take"](seen, lambda: None)
    assert seen.guards == [guards]
