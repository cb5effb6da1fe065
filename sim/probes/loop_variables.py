"""Finds variables of a loop that callbacks made in it share: when called, they see the last value."""

import ast
import linecache
from functools import lru_cache
from types import CellType, CodeType, FunctionType
from weakref import ref


class SharedVariables:
    """Tells of each function made at a line which variables it shares with the one made before it.

    It keeps neither functions nor values alive.
    """

    def __init__(self) -> None:
        self._latest: dict[tuple[CodeType, tuple[str, int]], tuple[ref[FunctionType], dict[str, int]]] = {}

    def of(self, function: object, place: tuple[str, int]) -> list[str]:
        """Return the loop's variables that have changed since such a function was made at a line."""
        if not isinstance(function, FunctionType) or not function.__closure__ or not place[1]:
            return []
        cells = _cells(function)
        values = {name: id(_content(cell)) for name, cell in cells.items()}
        before, seen = self._latest.get((function.__code__, place), (None, {}))
        self._latest[function.__code__, place] = ref(function), values
        other = None if before is None else before()
        shared = {} if other is None else _cells(other)
        changed = [
            name for name, cell in cells.items() if shared.get(name) is cell and seen[name] != values[name]
        ]
        return [name for name in changed if name in _of_loops(*place)] if changed else []


def _cells(function: FunctionType) -> dict[str, CellType]:
    return dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))


def _content(cell: CellType) -> object:
    try:
        return cell.cell_contents
    except ValueError:  # not assigned yet
        return None


@lru_cache(maxsize=64)
def _of_loops(file: str, line: int) -> frozenset[str]:
    """Return what the loops around a line assign in each round: variables, and what is made of these."""
    try:
        tree = ast.parse("".join(linecache.getlines(file)))
    except (SyntaxError, ValueError):
        return frozenset()
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.expr | ast.stmt) and node.lineno <= line <= (node.end_lineno or 0):
            match node:
                case ast.For():
                    found |= _names(node.target)
                    for each in node.body:
                        if isinstance(each, ast.Assign) and found & _names(each.value):
                            found.update(name for target in each.targets for name in _names(target))
                case ast.ListComp() | ast.SetComp() | ast.DictComp() | ast.GeneratorExp():
                    found.update(name for each in node.generators for name in _names(each.target))
    return frozenset(found)


def _names(node: ast.expr) -> set[str]:
    return {each.id for each in ast.walk(node) if isinstance(each, ast.Name)}
