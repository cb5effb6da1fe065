"""Edits of callbacks that wait or loop: they return, and continue at their next call."""

import ast
from textwrap import dedent, indent

from sim.diagnosis.edits.replies import check_rest, is_idle
from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, indentation

_WAIT = "wait_for_service"


def look_again(source: SourceEditor, line: int) -> None:
    """Let a callback return instead of waiting at a line, if its condition does not hold yet.

    Only for a statement of the callback's body that only waits, or logs while it waits, or that returns if a
    wait for a service was in vain.
    """
    callback = source.callback_at(line)
    wait = _statement_at(callback, line)
    if _asks_in_vain(source, wait):
        return
    missing, meanwhile = _condition(source, wait)
    before = callback.body[: callback.body.index(wait)]
    if any(_stores(part) & _attributes(wait) for part in before):
        raise NotSimpleError  # it would start again at each call
    local = {each.id for each in source.nodes(ast.Name, callback) if isinstance(each.ctx, ast.Store)}
    used = {each.id for each in source.nodes(ast.Name, wait)}
    if used & local or any(each.lineno == wait.lineno for each in meanwhile):
        raise NotSimpleError
    blank = indentation(wait)
    step = " " * (wait.col_offset - callback.col_offset)
    logs = "".join(source.lines_behind(each.lineno - 1, each) for each in meanwhile)
    source.replace_lines(wait, wait, f"{blank}if {missing}:\n{logs}{blank}{step}return\n")


def _asks_in_vain(source: SourceEditor, wait: ast.stmt) -> bool:
    """Let a statement that waits for a service and returns without it only ask; return whether it is one."""
    match wait:
        case ast.If(
            test=ast.UnaryOp(
                op=ast.Not(), operand=ast.Call(func=ast.Attribute(value=client, attr=name)) as call
            ),
            body=[*_, ast.Return(value=None)],
        ) if name == _WAIT:
            source.replace(call, f"{source.code_of(client)}.service_is_ready()")
            return True
    return False


def go_on_where_set(source: SourceEditor, line: int) -> None:
    """Move the statements after the wait at a line to the method that sets the awaited attribute.

    Only for a loop that only waits for an attribute that one other method sets.
    """
    callback = source.callback_at(line)
    wait = _statement_at(callback, line)
    place = callback.body.index(wait)
    rest, awaited = callback.body[place + 1 :], _attributes(wait)
    if not isinstance(wait, ast.While) or wait.orelse or not all(map(is_idle, wait.body)):
        raise NotSimpleError
    check_rest(callback, callback.body[:place], rest, "")
    methods = (each for each in source.nodes(ast.FunctionDef) if each.name != "__init__")
    setters = [each for each in methods if each is not callback and awaited & _stores(each)]
    if len(setters) != 1 or not rest or setters[0].args.args[0].arg != callback.args.args[0].arg:
        raise NotSimpleError
    last = setters[0].body[-1]
    if isinstance(last, ast.Return) or source.callback_at(last.lineno) is not setters[0]:
        raise NotSimpleError
    moved = source.lines_behind(wait.end_lineno or 0, rest[-1])
    source.replace_lines(wait, rest[-1], "" if place else f"{indentation(wait)}pass\n")
    source.replace_lines(last, last, source.lines_behind(last.lineno - 1, last) + moved)


def _statement_at(callback: ast.FunctionDef, line: int) -> ast.stmt:
    found = [each for each in callback.body if each.lineno <= line <= (each.end_lineno or 0)]
    if len(found) != 1:
        raise NotSimpleError
    return found[0]


def _attributes(part: ast.AST) -> set[str]:
    """Return the attributes in a loop's condition, or in another part of the source."""
    inside = ast.walk(part.test if isinstance(part, ast.While) else part)
    return {ast.unparse(each) for each in inside if isinstance(each, ast.Attribute)}


def _stores(part: ast.AST) -> set[str]:
    inside = (each for each in ast.walk(part) if isinstance(each, ast.Attribute))
    return {ast.unparse(each) for each in inside if isinstance(each.ctx, ast.Store)}


def _condition(source: SourceEditor, wait: ast.stmt) -> tuple[str, list[ast.stmt]]:
    """Return the condition, as code, under which a statement waits, and its logging statements."""
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
        case ast.While(test=ast.UnaryOp(op=ast.Not()) | ast.Compare(), orelse=[]) if all(
            map(is_idle, wait.body)
        ):
            return source.code_of(wait.test), []
    raise NotSimpleError


def _negated(source: SourceEditor, condition: ast.expr) -> str:
    match condition:
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            return source.code_of(operand)
        case ast.Name() | ast.Attribute() | ast.Call() | ast.Subscript():
            return f"not {source.code_of(condition)}"
    return f"not ({source.code_of(condition)})"


def leave_out(source: SourceEditor, line: int) -> None:
    """Remove the statement at a line of a method that only calls a function."""
    statement = source.statement_at(line)
    around = [each for each in ast.walk(source.function_at(line)) if statement in getattr(each, "body", ())]
    if not around or not isinstance(statement, ast.Expr) or not isinstance(statement.value, ast.Call):
        raise NotSimpleError
    is_alone = len(getattr(around[-1], "body", ())) == 1
    source.replace_lines(statement, statement, f"{indentation(statement)}pass\n" if is_alone else "")


def step_by_step(source: SourceEditor, line: int) -> None:
    """Replace the endless loop at a line, which ends a callback's body, by one step of it.

    Only if no step needs a variable from before the loop, and nothing leaves the loop.
    """
    callback = source.callback_at(line)
    loop = callback.body[-1]
    if not isinstance(loop, ast.While) or loop.lineno != line or loop.orelse or not _is_endless(loop.test):
        raise NotSimpleError
    inside = [each for part in loop.body for each in ast.walk(part)]
    if any(isinstance(each, ast.Break | ast.Continue | ast.Yield | ast.Await) for each in inside):
        raise NotSimpleError
    before = (each for part in callback.body[:-1] for each in ast.walk(part))
    local = {each.id for each in before if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)}
    if local & {each.id for each in inside if isinstance(each, ast.Name)} or loop.body[0].lineno == line:
        raise NotSimpleError
    if any(isinstance(each, ast.Constant) and "\n" in str(each.value) for each in inside):
        raise NotSimpleError  # the lines of a string must not move
    steps = [each for each in loop.body if not is_idle(each)]
    text = "".join(source.lines_behind(each.lineno - 1, each) for each in steps)
    source.replace_lines(loop, loop, indent(dedent(text), indentation(loop)) or f"{indentation(loop)}pass\n")


def _is_endless(test: ast.expr) -> bool:
    return bool(isinstance(test, ast.Constant) and test.value) or ast.unparse(test) == "rclpy.ok()"
