"""Evaluates the simple expressions that a ``setup.py`` is made of, without running it."""

from __future__ import annotations

import ast
import os.path
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from glob import glob
from pathlib import Path
from typing import Any

from sim.packages.errors import PackageError

_LONGEST = 100_000
"""Limit for the characters or items of a value, which a few lines can double again and again."""
_WIDE = re.compile(r"[%{][^%{}]*(\d{4}|\*)|\{[^{}]*\{")
"""A format field of thousands of columns, or with a computed width."""


@dataclass(slots=True)
class Expressions:
    """The names of a Python file, with their values as far as these can be evaluated.

    ``path`` is the file; globs and listings are relative to its folder.
    """

    path: Path
    names: dict[str, Any] = field(default_factory=dict)
    _imported: dict[str, str] = field(default_factory=dict)
    _unreadable: dict[str, PackageError] = field(default_factory=dict)

    def value(self, node: ast.expr) -> Any:
        """Return the value of an expression.

        Raises:
            PackageError: the expression has more than constants, names, joins, globs and loops over these.
        """
        read = _READERS.get(type(node))
        if read is None:
            raise self.trouble(node)
        try:
            value = read(self, node)
        except (TypeError, ValueError, LookupError, AttributeError, OSError, NotImplementedError) as error:
            raise PackageError(f"{self.place(node)}: {_written(node)} fails: {error}") from None
        except (MemoryError, OverflowError, RecursionError):
            raise PackageError(f"{self.place(node)}: an expression in it becomes too large") from None
        if isinstance(value, (str, bytes, list, tuple, dict)) and len(value) > _LONGEST:
            raise PackageError(f"{self.place(node)}: an expression in it becomes too large")
        return value

    def carry_out(self, statement: ast.stmt) -> None:
        """Evaluate an import, an assignment or an addition to a list; ignore any other statement."""
        match statement:
            case ast.Import(names=aliases):
                for alias in aliases:
                    name = alias.name if alias.asname else alias.name.split(".")[0]
                    self._imported[alias.asname or name] = name
            case ast.ImportFrom(module=str(module), names=aliases):
                for alias in aliases:
                    self._imported[alias.asname or alias.name] = f"{module}.{alias.name}"
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                self._assign(name, value)
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as value):
                self._assign(name, value)
            case ast.AugAssign(target=ast.Name(id=name) as target, op=ast.Add(), value=value):
                added = ast.BinOp(ast.Name(name, ast.Load()), ast.Add(), value)
                self._assign(name, ast.copy_location(added, target))
            case ast.Expr(
                value=ast.Call(func=ast.Attribute(value=ast.Name(id=name), attr=deed), args=[item])
            ) if deed in {"append", "extend"} and isinstance(self.names.get(name), list):
                added_items = item if deed == "extend" else ast.List([item], ast.Load())
                self._add(name, ast.copy_location(added_items, item))

    def _assign(self, name: str, value: ast.expr) -> None:
        self._unreadable.pop(name, None)
        try:
            self.names[name] = self.value(value)
        except PackageError as error:
            self.names.pop(name, None)
            self._unreadable[name] = error

    def _add(self, name: str, items: ast.expr) -> None:
        try:
            self.names[name] = [*self.names[name], *self.value(items)]
        except PackageError as error:
            del self.names[name]
            self._unreadable[name] = error

    def name(self, node: ast.Name) -> Any:
        """Return the value of a name."""
        if node.id in self._unreadable:
            raise self._unreadable[node.id]
        if node.id not in self.names:
            raise self.trouble(node)
        return self.names[node.id]

    def full_name(self, node: ast.expr) -> str:
        """Return an imported function's full name, such as ``os.path.join``; empty if it is not imported."""
        if isinstance(node, ast.Attribute):
            owner = self.full_name(node.value)
            return f"{owner}.{node.attr}" if owner else ""
        return self._imported.get(node.id, "") if isinstance(node, ast.Name) else ""

    def call(self, node: ast.Call) -> Any:
        """Return the value of a call of a known function."""
        function = _FUNCTIONS.get(self.full_name(node.func))
        if function is None and isinstance(node.func, ast.Name) and node.func.id in _BUILT_IN:
            function = _BUILT_IN[node.func.id]
        if function is not None:
            options = {each.arg: self.value(each.value) for each in node.keywords if each.arg}
            return function(self.path.parent, *map(self.value, node.args), **options)
        if isinstance(node.func, ast.Attribute) and node.func.attr in _TEXT_METHODS:
            text = self.value(node.func.value)
            if isinstance(text, str) and not _WIDE.search(text):
                return getattr(text, node.func.attr)(*map(self.value, node.args))
        raise self.trouble(node)

    def items(self, nodes: list[ast.expr]) -> list[Any]:
        """Return the items of a list, with ``*others`` unpacked."""
        found: list[Any] = []
        for each in nodes:
            if isinstance(each, ast.Starred):
                found.extend(self.value(each.value))
            else:
                found.append(self.value(each))
        return found

    def mapping(self, node: ast.Dict) -> dict[Any, Any]:
        """Return a dictionary, with ``**others`` unpacked."""
        found: dict[Any, Any] = {}
        for key, value in zip(node.keys, node.values, strict=True):
            found.update(self.value(value) if key is None else {self.value(key): self.value(value)})
        return found

    def comprehension(self, node: ast.ListComp) -> list[Any]:
        """Return the list of a comprehension with one loop over one name."""
        loop, *others = node.generators
        if others or not isinstance(loop.target, ast.Name) or loop.ifs:
            raise self.trouble(node)
        found = []
        for each in self.value(loop.iter):
            inside = Expressions(self.path, {**self.names, loop.target.id: each}, self._imported)
            found.append(inside.value(node.elt))
        return found

    def binary(self, node: ast.BinOp) -> Any:
        """Return a sum, or a text formatted by ``%``."""
        if isinstance(node.op, ast.Add):
            return self.value(node.left) + self.value(node.right)
        if isinstance(node.op, ast.Mod):
            text = self.value(node.left)
            if isinstance(text, str) and not _WIDE.search(text):
                return text % self.value(node.right)
        raise self.trouble(node)

    def text(self, node: ast.JoinedStr) -> str:
        """Return the value of an f-string."""
        return "".join(
            str(self.value(each.value if isinstance(each, ast.FormattedValue) else each))
            for each in node.values
        )

    def place(self, node: ast.expr) -> str:
        """Return the file and line of an expression."""
        return f"{self.path}:{node.lineno}"

    def trouble(self, node: ast.expr) -> PackageError:
        """Return the error for an expression that cannot be evaluated."""
        return PackageError(
            f"{self.place(node)}: {_written(node)} cannot be read without running the file; "
            "write it as constants, names, os.path.join and glob"
        )


def _written(node: ast.expr) -> str:
    try:
        return ast.unparse(node)
    except RecursionError:
        return "an expression that is nested deeply"


_READERS: Mapping[type[ast.expr], Callable[[Expressions, Any], Any]] = {
    ast.Constant: lambda _, node: node.value,
    ast.Name: Expressions.name,
    ast.Call: Expressions.call,
    ast.BinOp: Expressions.binary,
    ast.JoinedStr: Expressions.text,
    ast.List: lambda names, node: names.items(node.elts),
    ast.Tuple: lambda names, node: tuple(names.items(node.elts)),
    ast.Dict: Expressions.mapping,
    ast.ListComp: Expressions.comprehension,
}


def _glob(root: Path, pattern: str, *, recursive: bool = False) -> list[str]:
    if Path(pattern).is_absolute() or ".." in Path(pattern).parts:
        raise ValueError("it looks outside of the package")
    return sorted(glob(pattern, root_dir=root, recursive=recursive))  # noqa: PTH207 -- this is glob.glob itself


def _listing(root: Path, folder: str = ".") -> list[str]:
    return sorted(each.name for each in (root / folder).iterdir())


_FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "glob.glob": _glob,
    "os.listdir": _listing,
    "os.path.basename": lambda _, path: os.path.basename(path),  # noqa: PTH119 -- this is os.path.basename itself
    "os.path.join": lambda _, *parts: os.path.join(*parts),  # noqa: PTH118 -- this is os.path.join itself
}
_BUILT_IN: Mapping[str, Callable[..., Any]] = {
    "list": lambda _, items=(): list(items),
    "sorted": lambda _, items: sorted(items),
    "str": lambda _, value: str(value),
}
_TEXT_METHODS = frozenset(("format", "strip", "replace", "lower", "upper", "split"))
