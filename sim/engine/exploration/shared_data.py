"""Finds the lines of a source file that use data which several threads may share."""

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

_MUTATES = re.compile(
    "add|append(left)?|clear|discard|extend(left)?|insert|pop(item|left)?|remove|reverse|rotate|setdefault|"
    "sort|update|heap(push|pop|ify|replace|pushpop)|insort|next"
)
"""Names of methods that change their object, and of functions that change their first argument."""
_Function: TypeAlias = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda


@dataclass
class SharedData:
    """The accesses of a source file to attributes, globals and nonlocal names.

    ``lines`` has for each line its names, an attribute's with a dot in front, and whether each is written.
    ``written`` are the names that functions other than ``__init__`` assign or change in place; all others are
    constant once the program runs. Aliases by local names are not followed. Objects that a function creates
    itself are left out.

    ``split`` has the lines that read a name, then call something, and then write the name: CPython can switch
    threads in between. Reading a field of an argument counts as a call, as it is one on rclpy's messages.
    """

    lines: defaultdict[int, dict[str, bool]] = field(default_factory=lambda: defaultdict(dict))
    written: set[str] = field(default_factory=set)
    split: dict[int, str] = field(default_factory=dict)

    def note(self, name: str, line: int, *, writes: bool, counts: bool) -> None:
        """Add an access; a write that ``counts`` adds the name to ``written``."""
        self.lines[line][name] = writes or self.lines[line].get(name, False)
        if writes and counts:
            self.written.add(name)


def shared_data(source: str) -> SharedData:
    """Return the accesses of a source file, none if it cannot be parsed."""
    found = SharedData()
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError):
        return found
    for function in ast.walk(tree):
        if isinstance(function, _Function):
            _FunctionAccesses(function, found).collect()
    return found


class _FunctionAccesses:
    """The accesses of one function."""

    def __init__(self, function: _Function, found: SharedData) -> None:
        self._nodes = list(_inside(function))
        self._counts = getattr(function, "name", "") != "__init__"
        self._found = found
        stored = {each.id for each in self._names() if isinstance(each.ctx, ast.Store)}
        arguments = {each.arg for each in ast.walk(function.args) if isinstance(each, ast.arg)}
        declared = {
            name for each in self._nodes if isinstance(each, ast.Global | ast.Nonlocal) for name in each.names
        }
        self._arguments = arguments - {"self"}
        self._locals = (stored | arguments) - declared
        self._made = {
            target.id
            for each in self._nodes
            if isinstance(each, ast.Assign) and _makes_object(each.value)
            for target in each.targets
            if isinstance(target, ast.Name)
        }

    def _names(self) -> Iterator[ast.Name]:
        return (each for each in self._nodes if isinstance(each, ast.Name))

    def collect(self) -> None:
        """Add the function's accesses to ``found``."""
        for node in self._nodes:
            match node:
                case ast.Attribute() | ast.Name():
                    self._note(node, writes=not isinstance(node.ctx, ast.Load))
                case ast.Subscript(value=value, ctx=ast.Store() | ast.Del()):
                    self._note(value, writes=True)
                case ast.Call(func=called, args=arguments) if _MUTATES.fullmatch(_last_name(called)):
                    for changed in [called.value] if isinstance(called, ast.Attribute) else arguments[:1]:
                        self._note(changed, writes=True)

        for node in self._nodes:
            match node:
                case ast.AugAssign(target=target, value=value) | ast.Assign(targets=[target], value=value):
                    self._note_split(node, target, value)

    def _note_split(self, node: ast.stmt, target: ast.expr, value: ast.expr) -> None:
        shared = ast.unparse(_without_index(target))
        is_read = isinstance(node, ast.AugAssign)
        for each in _in_order(value):
            if is_read and self._leaves(each):
                for name in self._found.lines.get(target.end_lineno or target.lineno, ()):
                    if shared.rpartition(".")[2] == name.removeprefix("."):
                        self._found.split[target.end_lineno or target.lineno] = name
                return
            is_read = is_read or (isinstance(each, ast.Attribute | ast.Name) and ast.unparse(each) == shared)

    def _leaves(self, node: ast.expr) -> bool:
        """Return whether CPython may switch threads at a node."""
        if isinstance(node, ast.Attribute):
            return isinstance(node.value, ast.Name) and node.value.id in self._arguments
        return isinstance(node, ast.Call)

    def _note(self, node: ast.expr, *, writes: bool) -> None:
        node = _without_index(node)
        root: ast.expr = node
        while isinstance(root, ast.Attribute | ast.Subscript):
            root = root.value
        if isinstance(root, ast.Name) and root.id in self._made:
            return
        line = node.end_lineno or node.lineno
        if isinstance(node, ast.Attribute):
            self._found.note(f".{node.attr}", line, writes=writes, counts=self._counts)
        elif isinstance(node, ast.Name) and node.id not in self._locals:
            self._found.note(node.id, line, writes=writes, counts=self._counts)


def _without_index(node: ast.expr) -> ast.expr:
    while isinstance(node, ast.Subscript):
        node = node.value
    return node


def _in_order(node: ast.expr) -> Iterator[ast.expr]:
    """Yield an expression and those in it, in the order of their evaluation."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.expr) and not isinstance(child, ast.Lambda):
            yield from _in_order(child)
    yield node


def _inside(function: ast.AST) -> Iterator[ast.AST]:
    """Yield the nodes of a function without those of nested functions."""
    for child in ast.iter_child_nodes(function):
        yield child
        if not isinstance(child, _Function):
            yield from _inside(child)


def _last_name(node: ast.expr) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def _makes_object(value: ast.expr) -> bool:
    """Return whether a value is a call of something named like a class: ``Twist()``."""
    return isinstance(value, ast.Call) and _last_name(value.func)[:1].isupper()
