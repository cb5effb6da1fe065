"""Edits of action servers: what executes a goal, what ends one that is cancelled, and its result."""

import ast

from sim.diagnosis.edits.functions import add_at_end, defined_at
from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, indentation


def end_if_cancelled(source: SourceEditor, line: int, server: tuple[str, int]) -> None:
    """Let the loop around a line of an execute callback end the goal once it is cancelled.

    ``server`` is where the ActionServer is made, which names the callback and the action; in the same file.
    """
    callback, action = source.function_at(line), _action_of(source, source.function_at(line).name, server[1])
    loops: list[ast.For | ast.While] = [*source.nodes(ast.For, callback), *source.nodes(ast.While, callback)]
    around = [each for each in loops if each.lineno <= line <= (each.end_lineno or 0)]
    asks = any(each.attr == "is_cancel_requested" for each in source.nodes(ast.Attribute, callback))
    if not around or asks or len(callback.args.args) != 1 + source.is_method(callback):
        raise NotSimpleError
    goal, first = callback.args.args[-1].arg, max(around, key=lambda each: each.lineno).body[0]
    margin = indentation(first)
    source.insert_before(
        first,
        f"if {goal}.is_cancel_requested:\n{margin}    {goal}.canceled()\n"
        f"{margin}    return {action}.Result()\n{margin}",
    )


def execute_accepted_goals(source: SourceEditor, line: int) -> None:
    """Leave out the ``handle_accepted_callback`` of the action server that is made at a line."""
    for call in source.nodes(ast.Call, source.statement_at(line)):
        given = [*call.args, *(each.value for each in call.keywords)]
        for each in call.keywords:
            before = [other for other in given if _place(other) < _place(each.value)]
            if each.arg == "handle_accepted_callback" and before:
                source.cut_behind(max(before, key=_place), each.value)
                return
    raise NotSimpleError


def return_result(source: SourceEditor, line: int, server: tuple[str, int]) -> None:
    """End the execute callback that is defined at a line by returning a result.

    ``server`` is where the ActionServer is made.
    """
    callback = defined_at(source, line)
    if source.nodes(ast.Return, callback):
        raise NotSimpleError
    add_at_end(source, callback, f"return {_action_of(source, callback.name, server[1])}.Result()")


def _place(node: ast.expr) -> tuple[int, int]:
    return node.lineno, node.col_offset


def _action_of(source: SourceEditor, callback: str, line: int) -> str:
    """Return the name of the action whose server is made at a line with a callback."""
    for call in source.nodes(ast.Call):
        given = [*call.args, *(each.value for each in call.keywords)]
        named = [ast.unparse(each).rpartition(".")[2] for each in given]
        if call.lineno == line and callback in named and len(call.args) > 1:
            return source.code_of(call.args[1])
    raise NotSimpleError
