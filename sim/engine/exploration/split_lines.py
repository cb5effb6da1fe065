"""Lets threads switch in lines that read shared data, call something, and write the data after that."""

import ast
import builtins
from collections.abc import Callable

from sim.engine.exploration.shared_data import SharedData

_BETWEEN = "__cbtui_between__"
"""The function that such a line calls when all but its write is done."""


def split_lines(tree: ast.Module, data: SharedData, between: Callable[[object, str], object]) -> ast.Module:
    """Have ``between`` called in front of the write in each line of ``data.split``.

    It gets the value, which it hands on, and the name of what is written.
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
