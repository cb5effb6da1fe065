"""Lets threads switch inside lines that read shared data, call something, and then write the data."""

import ast
import builtins
from collections.abc import Callable

from sim.engine.exploration.shared_data import SharedData

_BETWEEN = "__cbtui_between__"
"""The built-in function that such a line calls before its write."""


def split_lines(tree: ast.Module, data: SharedData, between: Callable[[object, str], object]) -> ast.Module:
    """Insert a call of ``between`` before the write in each line of ``data.split``.

    ``between`` gets the value and the written name, and returns the value.
    """
    setattr(builtins, _BETWEEN, between)
    _Splitting(data).visit(tree)
    return ast.fix_missing_locations(tree)


class _Splitting(ast.NodeTransformer):
    def __init__(self, data: SharedData) -> None:
        self._data = data

    def visit_AugAssign(self, node: ast.AugAssign) -> ast.AugAssign:
        node.value = self._split(node.target, node.value)
        return node

    def visit_Assign(self, node: ast.Assign) -> ast.Assign:
        node.value = self._split(node.targets[0], node.value)
        return node

    def _split(self, target: ast.expr, value: ast.expr) -> ast.expr:
        written = self._data.split.get(target.end_lineno or target.lineno)
        if written is None:
            return value
        called = ast.Call(ast.Name(_BETWEEN, ast.Load()), [value, ast.Constant(written)], [])
        return ast.copy_location(called, target)
