"""Python's collector of garbage, kept from walking through the whole console again and again.

A full collection looks at every object there is: that takes a console a tenth of a second, in which no key is
answered. What has outlived one is set aside here, so that the next looks at little; when a screen is left,
all is looked at once more.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

from cbtui.terminal.textual_internals import forget_drawn_styles

_FULL = 2
"""The oldest generation: a collection of it is a full one."""


@contextmanager
def survivors_frozen() -> Iterator[None]:
    """Freeze all objects that exist now and, until the end, those that survive a full collection."""
    gc.callbacks.append(_set_survivors_aside)
    gc.freeze()
    try:
        yield
    finally:
        gc.callbacks.remove(_set_survivors_aside)
        gc.unfreeze()


def collect_now() -> None:
    """Make a full collection while nobody waits for a key; without ``survivors_frozen`` none is due."""
    if _set_survivors_aside in gc.callbacks:
        gc.collect()


def unfreeze_screen() -> None:
    """Have the next full collection look at everything: a screen's objects are of no use any more."""
    forget_drawn_styles()
    if _set_survivors_aside in gc.callbacks:
        gc.unfreeze()


def _set_survivors_aside(phase: str, about: dict[str, int]) -> None:
    if phase == "stop" and about["generation"] == _FULL:
        gc.freeze()
