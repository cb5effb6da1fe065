"""Edits Python source at the positions of its syntax tree, so that comments and layout stay."""

import ast
import re
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from textwrap import indent
from typing import TypeAlias, TypeVar

Function: TypeAlias = ast.FunctionDef | ast.AsyncFunctionDef
Positioned: TypeAlias = ast.stmt | ast.expr | ast.alias | ast.arg
Node = TypeVar("Node", bound=ast.AST)
Line = TypeVar("Line", bound=ast.stmt | ast.expr)


class NotSimpleError(Exception):
    """The source does not have the simple shape that an edit needs."""


@dataclass(eq=False)
class SourceEditor:
    """A source and its edits, all at positions of the unedited text.

    Raises:
        NotSimpleError: the text is not Python, or its lines do not end in plain newlines.
    """

    text: str
    _edits: list[tuple[int, int, bytes]] = field(default_factory=list)
    _imported: dict[str, set[str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        try:
            self.tree = ast.parse(self.text)
        except (SyntaxError, ValueError, RecursionError):
            raise NotSimpleError from None
        if "\r" in self.text or "\f" in self.text:
            raise NotSimpleError
        self._lines = self.text.encode().splitlines(keepends=True)

    # finding

    def nodes(self, kind: type[Node], within: ast.AST | None = None) -> list[Node]:
        """Return the nodes of a kind, in the whole source or a part."""
        return [each for each in ast.walk(within or self.tree) if isinstance(each, kind)]

    def around(self, kind: type[Line], line: int) -> list[Line]:
        """Return the nodes of a kind that a line is a part of, the outer ones first."""
        return [each for each in self.nodes(kind) if each.lineno <= line <= (each.end_lineno or 0)]

    def call_at(self, line: int, fits: Callable[[str], bool]) -> ast.Call:
        """Return the only call at a line of a function with a fitting name, without what precedes its dot."""
        calls = self.around(ast.Call, line)
        found = [each for each in calls if fits(ast.unparse(each.func).rpartition(".")[2])]
        if len(found) != 1:
            raise NotSimpleError
        return found[0]

    def function_at(self, line: int) -> Function:
        """Return the innermost function around a line, without its decorators."""
        functions: list[Function] = [*self.nodes(ast.FunctionDef), *self.nodes(ast.AsyncFunctionDef)]
        around = [each for each in functions if each.lineno <= line <= (each.end_lineno or each.lineno)]
        if not around:
            raise NotSimpleError
        return max(around, key=lambda each: each.lineno)

    def statement_at(self, line: int) -> ast.stmt:
        """Return the innermost statement at a line."""
        if not (around := self.around(ast.stmt, line)):
            raise NotSimpleError
        return around[-1]

    def callback_at(self, line: int) -> ast.FunctionDef:
        """Return the method around a line, if the program itself does not call it."""
        function = self.uncalled_at(line)
        if not self.is_method(function) or not function.args.args:
            raise NotSimpleError
        return function

    def uncalled_at(self, line: int) -> ast.FunctionDef:
        """Return the function around a line, be it a method, if the program itself does not call it."""
        function = self.function_at(line)
        calls = [each.func for each in self.nodes(ast.Call)]
        called = {each.attr for each in calls if isinstance(each, ast.Attribute)}
        called |= {each.id for each in calls if isinstance(each, ast.Name)}
        if not isinstance(function, ast.FunctionDef) or function.decorator_list or function.name in called:
            raise NotSimpleError
        return function

    def uses_of(self, function: Function) -> list[tuple[ast.expr, ast.Call | None]]:
        """Return where a function is named outside its definition, each time with the call if it is called.

        Raises:
            NotSimpleError: another function has the same name.
        """
        functions: list[Function] = [*self.nodes(ast.FunctionDef), *self.nodes(ast.AsyncFunctionDef)]
        if sum(each.name == function.name for each in functions) > 1:
            raise NotSimpleError
        calls = {each.func: each for each in self.nodes(ast.Call)}
        kind = "attr" if self.is_method(function) else "id"
        uses = (each for each in self.nodes(ast.expr) if getattr(each, kind, "") == function.name)
        return [(each, calls.get(each)) for each in uses]

    def is_method(self, function: Function) -> bool:
        """Return whether a function is a method of a class."""
        return self.owner_of(function) is not None

    def owner_of(self, function: Function) -> ast.ClassDef | None:
        """Return the class of which a function is a method; None for no method."""
        return next((each for each in self.nodes(ast.ClassDef) if function in each.body), None)

    def code_of(self, node: Positioned) -> str:
        """Return the text of a node."""
        start, end = self._span(node)
        return b"".join(self._lines)[start:end].decode()

    def lines_behind(self, line: int, last: ast.stmt) -> str:
        """Return the lines after a line, up to the end of a statement, with their comments."""
        return b"".join(self._lines[line : last.end_lineno]).decode()

    def lines_moved(self, line: int, last: ast.stmt, column: int) -> str:
        """Return the lines after a line, up to the end of a statement, which is moved to a column.

        Raises:
            NotSimpleError: one of these lines begins inside a string.
        """
        assert last.end_lineno is not None
        for each in self.nodes(ast.Constant):
            is_within = line < each.lineno < (each.end_lineno or 0) <= last.end_lineno
            if is_within and "\n" in str(each.value):
                raise NotSimpleError
        lines, deeper = self.lines_behind(line, last), last.col_offset - column
        return indent(lines, " " * -deeper) if deeper < 0 else re.sub(f"(?m)^ {{0,{deeper}}}", "", lines)

    def comment_behind(self, statement: ast.stmt) -> str:
        """Return the comment at the end of a statement's last line, after two blanks; "" for none."""
        assert statement.end_lineno is not None
        text = self._lines[statement.end_lineno - 1][statement.end_col_offset :].decode().strip()
        return f"  {text}" if text else ""

    # editing

    def replace(self, node: Positioned, new: str) -> None:
        """Replace a node by a text."""
        self._edits.append((*self._span(node), new.encode()))

    def insert_behind(self, node: Positioned, new: str) -> None:
        """Insert a text after a node."""
        end = self._span(node)[1]
        self._edits.append((end, end, new.encode()))

    def insert_before(self, node: Positioned, new: str) -> None:
        """Insert a text before a node."""
        start = self._span(node)[0]
        self._edits.append((start, start, new.encode()))

    def cut_behind(self, node: Positioned, last: Positioned) -> None:
        """Remove the text after a node, up to the end of another."""
        self._edits.append((self._span(node)[1], self._span(last)[1], b""))

    def replace_lines(self, first: ast.stmt, last: ast.stmt, new: str) -> None:
        """Replace the lines from one statement to another.

        Raises:
            NotSimpleError: something else is on these lines.
        """
        assert last.end_lineno is not None
        before = self._lines[first.lineno - 1][: first.col_offset]
        behind = self._lines[last.end_lineno - 1][last.end_col_offset :].strip()
        if before.strip() or not (behind == b"" or behind.startswith(b"#")):
            raise NotSimpleError
        self._edits.append(
            (self._offset(first.lineno, 0), self._offset(last.end_lineno + 1, 0), new.encode())
        )

    def import_names(self, module: str, names: Iterable[str], instead_of: str = "") -> None:
        """Import names from a module that the source does not import yet, each once.

        They replace the name ``instead_of`` if all its uses are replaced by the edits so far.
        """
        imports = [each for each in self.tree.body if isinstance(each, ast.ImportFrom)]
        ours = [each for each in imports if each.module == module]
        known = {alias.name for each in ours for alias in each.names if alias.asname is None}
        missing = sorted(set(names) - known - self._imported.get(module, set()))
        if not missing:
            return
        self._imported[module] = {*missing, *self._imported.get(module, ())}
        uses = [self._span(each) for each in self.nodes(ast.Name) if each.id == instead_of]
        replaced = [use for use in uses for start, end, _ in self._edits if start <= use[0] and use[1] <= end]
        gone = [alias for each in ours for alias in each.names if alias.name == instead_of]
        if gone and len(replaced) == len(uses):
            self.replace(gone[0], ", ".join(missing))
        elif ours:
            self.insert_behind(ours[0].names[-1], "".join(f", {each}" for each in missing))
        else:
            self._import_anew(module, missing)

    def _import_anew(self, module: str, names: Iterable[str]) -> None:
        before = [each for each in self.tree.body if isinstance(each, ast.Import | ast.ImportFrom)]
        if not before:
            raise NotSimpleError
        root, line = module.partition(".")[0], f"from {module} import {', '.join(names)}"
        related = [each for each in before if root <= _module(each) < module]
        if root in sys.stdlib_module_names:
            related = [each for each in before if _module(each).partition(".")[0] in sys.stdlib_module_names]
            if not related:
                self.insert_before(before[0], f"{line}\n\n")
                return
        self.insert_behind((related or before)[-1], f"\n{line}")

    def result(self) -> str:
        """Return the edited text.

        Raises:
            NotSimpleError: two edits overlap, or the result is not Python.
        """
        data = b"".join(self._lines)
        upto = len(data)
        for start, end, new in sorted(self._edits, key=lambda edit: edit[:2], reverse=True):
            if end > upto:
                raise NotSimpleError
            data = data[:start] + new + data[end:]
            upto = start
        text = data.decode()
        SourceEditor(text)
        return text

    # positions

    def _offset(self, line: int, column: int) -> int:
        return sum(map(len, self._lines[: line - 1])) + column

    def _span(self, node: Positioned) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return (
            self._offset(node.lineno, node.col_offset),
            self._offset(node.end_lineno, node.end_col_offset),
        )


def _module(statement: ast.Import | ast.ImportFrom) -> str:
    return statement.module or "" if isinstance(statement, ast.ImportFrom) else statement.names[0].name


def name_of(function: Function) -> ast.Name:
    """Return the name in the line that defines a function, as a node of its own."""
    start = function.col_offset + len("def " if isinstance(function, ast.FunctionDef) else "async def ")
    end = start + len(function.name.encode())
    line = function.lineno
    return ast.Name(function.name, lineno=line, col_offset=start, end_lineno=line, end_col_offset=end)


def indentation(statement: ast.stmt) -> str:
    """Return the blanks before a statement."""
    return " " * statement.col_offset
