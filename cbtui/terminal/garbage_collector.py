"""Keeps full garbage collections short, so that keys are answered.

A full collection visits every object: a tenth of a second in the console. Objects that survive one are frozen
here, so that the next collection visits few; some time after a screen has closed all objects are visited.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

_FULL = 2
"""The oldest generation, whose collection is a full one."""
_USUAL_THRESHOLDS = 700, 10, 10
"""Python's own thresholds; ``cbtui.__main__`` raises them, as imported modules are no garbage."""


@contextmanager
def survivors_frozen() -> Iterator[None]:
    """Freeze all objects that exist now and, until the end, those that survive a full collection."""
    gc.callbacks.append(_freeze_survivors)
    gc.freeze()
    gc.set_threshold(*_USUAL_THRESHOLDS)
    try:
        yield
    finally:
        gc.callbacks.remove(_freeze_survivors)
        gc.unfreeze()


def collect_now() -> None:
    """Collect now, before keys are pressed; does nothing outside of ``survivors_frozen``."""
    if _freeze_survivors in gc.callbacks:
        gc.collect()


def collect_closed_screens() -> None:
    """Collect all garbage, also among objects that were frozen; does nothing outside of ``survivors_frozen``.

    It takes a quarter of a second on a busy machine, in which no key is answered.
    """
    if _freeze_survivors in gc.callbacks:
        gc.unfreeze()
        gc.collect()


def _freeze_survivors(phase: str, about: dict[str, int]) -> None:
    if phase == "stop" and about["generation"] == _FULL:
        gc.freeze()
