"""Edits of callbacks that take locks."""

import ast
import re

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor


def take_together(source: SourceEditor, line: int, other: int) -> None:
    """Let the callback at a line take both locks at once, in the order of the callback at line ``other``.

    Only for a ``with`` inside a ``with``, in both callbacks.
    """
    outer, inner = _nested(source, line)
    first, second = (_lock(source, each) for each in _nested(source, other))
    if (_lock(source, outer), _lock(source, inner)) != (second, first):
        raise NotSimpleError
    has_text = any(isinstance(each, ast.Constant) and "\n" in str(each.value) for each in ast.walk(inner))
    if has_text or inner.body[0].lineno == inner.lineno:  # the lines of a string must not move
        raise NotSimpleError
    deeper = inner.body[0].col_offset - inner.col_offset
    body = source.lines_behind(inner.items[0].context_expr.end_lineno or 0, inner.body[-1])
    source.replace(outer.items[0].context_expr, f"{first}, {second}")
    source.replace_lines(inner, inner, re.sub(f"(?m)^ {{{deeper}}}", "", body))


def _nested(source: SourceEditor, line: int) -> tuple[ast.With, ast.With]:
    """Return the ``with`` around the one at a line, and that one."""
    blocks = [
        each
        for each in source.nodes(ast.With, source.function_at(line))
        if each.lineno <= line <= (each.end_lineno or 0)
    ]
    blocks.sort(key=lambda each: each.lineno)
    if len(blocks) != 2 or blocks[1] not in blocks[0].body:
        raise NotSimpleError
    return blocks[0], blocks[1]


def _lock(source: SourceEditor, with_: ast.With) -> str:
    if len(with_.items) != 1 or with_.items[0].optional_vars is not None:
        raise NotSimpleError
    return source.code_of(with_.items[0].context_expr)


def make_reentrant(source: SourceEditor, line: int) -> None:
    """Replace the lock that is taken at a line by an ``RLock``, which its holder may take again."""
    blocks = [each for each in source.nodes(ast.With) if each.lineno <= line <= each.body[0].lineno]
    if not blocks:
        raise NotSimpleError
    name = _lock(source, blocks[-1])
    made = [
        each.value
        for each in source.nodes(ast.Assign)
        if len(each.targets) == 1 and ast.unparse(each.targets[0]) == name
    ]
    match made:
        case [
            ast.Call(func=ast.Attribute(value=ast.Name(id="threading"), attr="Lock"), args=[], keywords=[])
        ]:
            source.replace(made[0], "threading.RLock()")
        case [ast.Call(func=ast.Name(id="Lock"), args=[], keywords=[])]:
            source.replace(made[0], "RLock()")
            source.import_names("threading", ["RLock"], instead_of="Lock")
        case _:
            raise NotSimpleError
