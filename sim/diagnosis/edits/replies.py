"""Edits of callbacks that wait for a reply: they continue in a done-callback, or await it."""

import ast
from contextlib import suppress

from sim.diagnosis.edits.groups import give_own_group
from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import Function, NotSimpleError, SourceEditor, indentation

_SPIN = "spin_until_future_complete"
_IDLE = ("sleep", "sleep_for", "spin_once")


def go_on_in_done_callback(source: SourceEditor, line: int) -> None:
    """Move the statements after the wait at a line into a done-callback of the future.

    Only if the wait is a statement of the callback's body, and no later statement needs a variable from
    before it.
    """
    callback = source.callback_at(line)
    place = next((place for place, each in enumerate(callback.body) if is_at(each, line)), None)
    if place is None:
        raise NotSimpleError
    wait, rest = callback.body[place], callback.body[place + 1 :]
    if rest and rest[0].lineno == wait.end_lineno:
        raise NotSimpleError
    future, begin, first = _handed_over(source, wait, callback)
    if not future.isidentifier():
        raise NotSimpleError
    check_rest(callback, callback.body[:place], rest, future)
    inner = indentation(wait)
    comment = source.comment_behind(wait)
    if not rest and not first:
        source.replace_lines(wait, wait, f"{inner}{begin.partition(' = ')[2] or 'pass'}{comment}\n")
        return
    lines = [
        *([f"{inner}{begin}{comment}"] if begin else []),
        *_done_callback(source, callback, future, inner),
        *([f"{inner}{first}"] if first else []),
    ]
    last = rest[-1] if rest else wait
    kept = source.lines_behind(wait.end_lineno or 0, last)
    source.replace_lines(wait, last, "\n".join(lines) + "\n" + kept)


def use_in_done_callback(source: SourceEditor, line: int, attribute: str) -> None:
    """Move the use of a result at a line, and what follows it, into a done-callback of the future.

    Only if the callback itself has the future in a variable, as in ``go_on_in_done_callback``.
    """
    callback = source.callback_at(line)
    found = {ast.unparse(each) for each in futures_used(source, line, attribute)}
    future = found.pop() if len(found) == 1 else ""
    uses = (
        place
        for place, each in enumerate(callback.body)
        if any(ast.unparse(call) == f"{future}.result()" for call in source.nodes(ast.Call, each))
    )
    place = next(uses, None)
    if place is None or not future.isidentifier():
        raise NotSimpleError
    rest = callback.body[place:]
    check_rest(callback, callback.body[:place], rest, future)
    lines = _done_callback(source, callback, future, indentation(rest[0]))
    kept = source.lines_behind(rest[0].lineno - 1, rest[-1])
    source.replace_lines(rest[0], rest[-1], "\n".join(lines) + "\n" + kept)


def futures_used(source: SourceEditor, line: int, attribute: str) -> list[ast.expr]:
    """Return the futures whose ``result()`` is what an attribute is asked of at a line.

    That is asked itself, by a name, or of a function that returns nothing else.
    """
    within: ast.AST = source.tree
    with suppress(NotSimpleError):
        within = source.function_at(line)
    asked = [each.value for each in source.around(ast.Attribute, line) if each.attr == attribute]
    names = {ast.unparse(each) for each in asked}
    named = [
        each.value for each in source.nodes(ast.Assign, within) if names & set(map(ast.unparse, each.targets))
    ]
    called = {
        ast.unparse(each.func).rpartition(".")[2] for each in (*asked, *named) if isinstance(each, ast.Call)
    }
    ends = [source.nodes(ast.Return, each) for each in source.nodes(ast.FunctionDef) if each.name in called]
    returned = [each[0].value for each in ends if len(each) == 1]
    return [
        each.func.value
        for each in (*asked, *named, *returned)
        if isinstance(each, ast.Call) and isinstance(each.func, ast.Attribute) and each.func.attr == "result"
    ]


def _done_callback(source: SourceEditor, callback: ast.FunctionDef, future: str, inner: str) -> list[str]:
    """Return the lines that end a callback with a done-callback of a future, and that begin that."""
    me = callback.args.args[0].arg
    name = next(each for each in ("on_reply", f"{callback.name}_reply") if each not in source.text)
    return [
        f"{inner}{future}.add_done_callback({me}.{name})",
        "",
        f"{indentation(callback)}def {name}({me}, {future}):",
    ]


@asked_of_file
def decides_on_parameters(source: SourceEditor, line: int) -> bool:
    """Return whether a line is in a callback that accepts parameters or not: rclpy does not await it."""
    names = {
        ast.unparse(argument).rpartition(".")[2]
        for call in source.nodes(ast.Call)
        if ast.unparse(call.func).endswith(".add_on_set_parameters_callback")
        for argument in call.args
    }
    with suppress(NotSimpleError):
        return source.function_at(line).name in names
    return False


@asked_of_file
def calls_on_parameters(source: SourceEditor) -> tuple[str, int]:
    """Return the only callback of parameters that waits in ``Client.call``, and the line; "" for none."""
    adds = (each for each in source.nodes(ast.Call) if "_set_parameters_callback" in ast.unparse(each.func))
    names = {ast.unparse(argument).rpartition(".")[2] for call in adds for argument in call.args}
    found = {
        (function.name, call.lineno)
        for function in source.nodes(ast.FunctionDef)
        for call in source.nodes(ast.Call, function)
        if function.name in names and ast.unparse(call.func).endswith(".call")
    }
    return found.pop() if len(found) == 1 else ("", 0)


def await_reply(source: SourceEditor, line: int, made: int) -> None:
    """Let what waits for a reply at a line await it, as a coroutine, and so all that calls that.

    The callbacks among these get groups of their own; ``made`` is the line that makes what calls one of them.
    """
    waiting = source.function_at(line)
    statement = _innermost(waiting, line)
    call = plain_call(statement)
    if call is not None:
        begin, end = _await(source, call)
        source.replace(call, f"{begin}{_asynchronous(source, call)}{end}")
    else:
        awaited = f"await {future_of(statement)}{source.comment_behind(statement)}"
        source.replace_lines(statement, statement, f"{indentation(statement)}{awaited}\n")
    coroutines: list[Function] = []
    callers, makers = [(waiting, line)], [made]
    for function, at in callers:
        if function.decorator_list or any(is_at(each, at) for each in source.nodes(ast.With, function)):
            raise NotSimpleError  # it would keep a lock while others run on its thread
        if function in coroutines:
            continue
        uses = source.uses_of(function)
        if function.name.startswith("__") or (coroutines and not uses):
            raise NotSimpleError  # nobody would await it
        coroutines.append(function)
        if isinstance(function, ast.FunctionDef):
            source.insert_before(function, "async ")
        for use, call in uses:
            if call is None:
                makers.append(use.lineno)
            else:
                begin, end = _await(source, call)
                source.insert_before(call, begin)
                source.insert_behind(call, end)
                callers.append((source.function_at(call.lineno), call.lineno))
    give_own_group(source, *makers)


def _await(source: SourceEditor, call: ast.Call) -> tuple[str, str]:
    """Return what to write before and after a call to await it."""
    unfit = [*source.nodes(ast.Lambda), *source.nodes(ast.JoinedStr)]
    if any(call in ast.walk(each) for each in unfit):
        raise NotSimpleError
    asked = {each.value for each in source.nodes(ast.Attribute)}
    asked |= {each.value for each in source.nodes(ast.Subscript)}
    return ("(await ", ")") if call in asked else ("await ", "")


def is_at(statement: ast.stmt, line: int) -> bool:
    """Return whether a line is one of a statement's."""
    return statement.lineno <= line <= (statement.end_lineno or statement.lineno)


def _innermost(callback: Function, line: int) -> ast.stmt:
    """Return the innermost statement at a line; the loop around it if that waits for a future."""
    around = [each for each in ast.walk(callback) if isinstance(each, ast.stmt) and is_at(each, line)]
    loops = [each for each in around if isinstance(each, ast.While) and _loop_future(each)]
    found = (loops or around)[-1]
    if isinstance(found, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        raise NotSimpleError
    return found


def _handed_over(source: SourceEditor, wait: ast.stmt, callback: ast.FunctionDef) -> tuple[str, str, str]:
    """Return a wait's future, the statement that creates it, and the one with its result; "" for none."""
    call = plain_call(wait)
    if call is None:
        return future_of(wait), "", ""
    names = {each.id for each in source.nodes(ast.Name, callback)}
    future = "future" if "future" not in names else "reply_future"
    begin = f"{future} = {_asynchronous(source, call)}"
    if isinstance(wait, ast.Expr) and wait.value is call:
        return future, begin, ""
    if isinstance(wait, ast.Assign) and wait.value is call and len(wait.targets) == 1:
        return future, begin, f"{source.code_of(wait.targets[0])} = {future}.result()"
    raise NotSimpleError


def plain_call(statement: ast.stmt) -> ast.Call | None:
    """Return the only ``client.call(request)`` in a simple statement; else None."""
    if isinstance(statement, ast.While | ast.If | ast.For | ast.With | ast.Try):
        return None
    calls = [each for each in ast.walk(statement) if isinstance(each, ast.Call)]
    found = [each for each in calls if isinstance(each.func, ast.Attribute) and each.func.attr == "call"]
    if len(found) != 1 or len(found[0].args) != 1 or found[0].keywords:
        return None
    return found[0]


def _asynchronous(source: SourceEditor, call: ast.Call) -> str:
    assert isinstance(call.func, ast.Attribute)
    return f"{source.code_of(call.func.value)}.call_async({source.code_of(call.args[0])})"


def future_of(wait: ast.stmt) -> str:
    """Return the future that a statement waits for, by spinning or in a loop."""
    if isinstance(wait, ast.Expr) and isinstance(wait.value, ast.Call):
        function = wait.value.func
        if isinstance(function, ast.Attribute) and function.attr == _SPIN:
            for each in wait.value.args[-1:]:
                more = {each.arg for each in wait.value.keywords} - {"timeout_sec"}
                if isinstance(each, ast.Name | ast.Attribute) and not more:
                    return ast.unparse(each)
    future = _loop_future(wait)
    if not future:
        raise NotSimpleError
    return future


def _loop_future(loop: ast.stmt) -> str:
    """Return the future of a ``while not future.done():`` that only pauses; "" for any other loop."""
    if not isinstance(loop, ast.While) or loop.orelse or not all(map(is_idle, loop.body)):
        return ""
    match loop.test:
        case ast.UnaryOp(
            op=ast.Not(), operand=ast.Call(func=ast.Attribute(value=ast.Name(id=future), attr="done"))
        ):
            return future
    return ""


def is_idle(statement: ast.stmt) -> bool:
    """Return whether a statement only lets time pass."""
    match statement:
        case ast.Pass():
            return True
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr=name) | ast.Name(id=name))):
            return name in _IDLE
    return False


def check_rest(callback: ast.FunctionDef, before: list[ast.stmt], rest: list[ast.stmt], future: str) -> None:
    """Raise NotSimpleError if the statements after the wait cannot be moved into a method."""
    me = callback.args.args[0].arg
    names = [each for part in before for each in ast.walk(part) if isinstance(each, ast.Name)]
    local = {each.arg for each in callback.args.args}
    local |= {each.id for each in names if isinstance(each.ctx, ast.Store)}
    for each in (node for part in rest for node in ast.walk(part)):
        if isinstance(each, ast.Return) and each.value is not None:
            raise NotSimpleError
        if isinstance(each, ast.Await | ast.Yield | ast.YieldFrom | ast.Nonlocal | ast.Global):
            raise NotSimpleError
        if isinstance(each, ast.Name) and each.id in local - {me, future}:
            raise NotSimpleError
