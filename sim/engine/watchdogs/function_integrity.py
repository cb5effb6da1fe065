"""Finds functions of the engine that a program has replaced, which could falsify the trace."""

import sys
from collections.abc import Iterator, Mapping
from types import CodeType, FunctionType


class FunctionIntegrity:
    """Remembers the code of the model's functions and methods, and the callables of ``parts``.

    ``parts`` are objects of the engine by name; a method that is replaced on an object is found, too.
    """

    def __init__(self, parts: Mapping[str, object]) -> None:
        self._parts = parts
        self._code = dict(_functions())
        self._held = dict(self._callables())

    def replaced(self) -> tuple[str, ...]:
        """Return the names of the functions that were replaced since."""
        code, held = dict(_functions()), dict(self._callables())
        functions = [name for name, was in self._code.items() if code.get(name) is not was]
        callables = [name for name in {**self._held, **held} if held.get(name) != self._held.get(name)]
        return (*functions, *callables)

    def _callables(self) -> Iterator[tuple[str, object]]:
        for place, part in self._parts.items():
            yield from ((f"{place}.{name}", each) for name, each in vars(part).items() if callable(each))


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
