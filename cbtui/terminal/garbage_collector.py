"""Keeps full garbage collections short, so that keys are answered.

A full collection visits every object: a tenth of a second in the console. Objects that survive one are frozen
here, so that the next collection visits few; when a screen closes, all objects are visited once more.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

from cbtui.terminal.textual_internals import forget_drawn_styles

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


def unfreeze_screen() -> None:
    """Unfreeze all objects, as those of a closed screen are garbage."""
    forget_drawn_styles()
    if _freeze_survivors in gc.callbacks:
        gc.unfreeze()


def _freeze_survivors(phase: str, about: dict[str, int]) -> None:
    if phase == "stop" and about["generation"] == _FULL:
        gc.freeze()
