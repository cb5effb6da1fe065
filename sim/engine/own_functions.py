"""Notices a program that replaces functions of the engine's own, to change what the trace tells."""

import sys
from collections.abc import Iterator, Mapping
from types import CodeType, FunctionType


class OwnFunctions:
    """The code of the model's functions and methods as it is now, and the callables that ``parts`` hold.

    ``parts`` are objects of the engine by name; a method that an object itself replaces is noticed too.
    """

    def __init__(self, parts: Mapping[str, object]) -> None:
        self._parts = parts
        self._code = dict(_functions())
        self._held = {name: _callables(part) for name, part in parts.items()}

    def replaced(self) -> tuple[str, ...]:
        """Return the names of those that are no longer what they were."""
        now = dict(_functions())
        functions = [name for name, code in self._code.items() if now.get(name) is not code]
        held = [name for name, part in self._parts.items() if _callables(part) != self._held[name]]
        return (*functions, *held)


def _functions() -> Iterator[tuple[str, CodeType]]:
    for place, module in list(sys.modules.items()):
        if _is_model(place):
            yield from _in(place, module)
            for name, member in list(vars(module).items()):
                if isinstance(member, type) and member.__module__ == place:
                    yield from _in(f"{place}.{name}", member)


def _is_model(module: str) -> bool:
    return module.partition(".")[0] == "sim"


def _in(place: str, holder: object) -> Iterator[tuple[str, CodeType]]:
    for name, member in list(vars(holder).items()):
        inner = member.fget if isinstance(member, property) else getattr(member, "__func__", member)
        if isinstance(inner, FunctionType):
            yield f"{place}.{name}", inner.__code__


def _callables(part: object) -> dict[str, object]:
    return {name: value for name, value in vars(part).items() if callable(value)}
