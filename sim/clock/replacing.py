"""Puts functions of virtual time in the place of Python's, for the threads that live on a clock."""

import sys
from collections.abc import Callable
from functools import wraps
from types import ModuleType
from typing import Any

from sim.clock.virtual import VirtualClock


class Replacements:
    """Functions that threads of a clock get in place of Python's own; other threads keep the real ones."""

    def __init__(self, clock: VirtualClock) -> None:
        self.clock = clock
        self._new: dict[int, Any] = {}
        self._old: list[Any] = []

    def put(self, owner: Any, name: str, virtual: Callable[..., Any]) -> None:
        """Have threads of the clock get ``virtual`` when they call ``owner.name``, if the system has it."""
        real = getattr(owner, name, None)
        if real is None:
            return
        owns = self.clock.owns_current_thread

        @wraps(real)
        def chosen(*args: Any, **named: Any) -> Any:
            return (virtual if owns() else real)(*args, **named)

        setattr(owner, name, chosen)
        if isinstance(owner, ModuleType):
            self.note(real, chosen)

    def note(self, real: Any, new: Any) -> None:
        """A function of Python's has been replaced."""
        self._new[id(real)] = new
        self._old.append(real)  # while it is kept, nothing else gets its id

    def hand_on(self) -> None:
        """Give the new functions to those modules of Python's that have imported the old ones by name."""
        for module in tuple(sys.modules.values()):
            if getattr(module, "__name__", "").partition(".")[0] in sys.stdlib_module_names:
                for name, value in tuple(vars(module).items()):
                    if id(value) in self._new:
                        setattr(module, name, self._new[id(value)])
