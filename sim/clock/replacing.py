"""Replaces functions of Python with those of virtual time, for the threads that live on a clock."""

import sys
from collections.abc import Callable
from functools import wraps
from types import ModuleType
from typing import Any

from sim.clock.virtual import VirtualClock


class Replacements:
    """Functions that threads of a clock get instead of Python's own; other threads get the real ones."""

    def __init__(self, clock: VirtualClock) -> None:
        self.clock = clock
        self._new: dict[int, Any] = {}
        self._old: list[Any] = []

    def put(self, owner: Any, name: str, virtual: Callable[..., Any]) -> None:
        """Make ``owner.name`` call ``virtual`` on threads of the clock, if the system has that function."""
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
        """Remember that ``new`` has replaced a function of Python."""
        self._new[id(real)] = new
        self._old.append(real)  # while it is kept, nothing else gets its id

    def hand_on(self) -> None:
        """Replace the functions in all standard modules that have imported them by name."""
        for module in tuple(sys.modules.values()):
            if getattr(module, "__name__", "").partition(".")[0] in sys.stdlib_module_names:
                for name, value in tuple(vars(module).items()):
                    if id(value) in self._new:
                        setattr(module, name, self._new[id(value)])
