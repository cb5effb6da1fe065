"""Edits of callbacks that wait for a condition: they return, and look again when they are called again."""

import ast

from sim.diagnosis.edits.replies import is_idle
from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, indentation

_WAIT = "wait_for_service"


def look_again(source: SourceEditor, line: int) -> None:
    """Have a timer's callback return where it would wait at a line, if what it waits for is not there yet.

    Only for a statement of the callback's body that does nothing but wait, or log meanwhile.
    """
    callback = source.callback_at(line)
    wait = next((each for each in callback.body if each.lineno <= line <= (each.end_lineno or 0)), None)
    if wait is None:
        raise NotSimpleError
    missing, meanwhile = _condition(source, wait)
    local = {each.id for each in source.nodes(ast.Name, callback) if isinstance(each.ctx, ast.Store)}
    used = {each.id for each in source.nodes(ast.Name, wait)}
    if used & local or any(each.lineno == wait.lineno for each in meanwhile):
        raise NotSimpleError
    blank = indentation(wait)
    step = " " * (wait.col_offset - callback.col_offset)
    logs = "".join(source.lines_behind(each.lineno - 1, each) for each in meanwhile)
    source.replace_lines(wait, wait, f"{blank}if {missing}:\n{logs}{blank}{step}return\n")


def _condition(source: SourceEditor, wait: ast.stmt) -> tuple[str, list[ast.stmt]]:
    """What is true as long as a statement waits, as code; and what it logs meanwhile."""
    match wait:
        case ast.Expr(value=ast.Call(func=ast.Attribute(value=client, attr=name), args=[], keywords=[])):
            if name == _WAIT:
                return f"not {source.code_of(client)}.service_is_ready()", []
        case ast.While(
            test=ast.UnaryOp(op=ast.Not(), operand=ast.Call(func=ast.Attribute(value=client, attr=name))),
            orelse=[],
        ) if name == _WAIT and all(isinstance(each, ast.Expr) or is_idle(each) for each in wait.body):
            logs = [each for each in wait.body if not is_idle(each)]
            return f"not {source.code_of(client)}.service_is_ready()", logs
        case ast.While(
            test=ast.Constant(value=True),
            body=[ast.If(test=found, body=[ast.Break()], orelse=[]), *more],
            orelse=[],
        ) if all(map(is_idle, more)):
            return _negated(source, found), []
        case ast.While(test=ast.UnaryOp(op=ast.Not()), orelse=[]) if all(map(is_idle, wait.body)):
            return source.code_of(wait.test), []
    raise NotSimpleError


def _negated(source: SourceEditor, condition: ast.expr) -> str:
    match condition:
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            return source.code_of(operand)
        case ast.Name() | ast.Attribute() | ast.Call() | ast.Subscript():
            return f"not {source.code_of(condition)}"
    return f"not ({source.code_of(condition)})"
