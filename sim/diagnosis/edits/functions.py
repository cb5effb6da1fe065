"""Edits of a callback's parameters, of what it returns, and of whether it is a coroutine."""

import ast
from collections.abc import Sequence

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, indentation, name_of

_PARAMETERS = {
    "create_timer": (),
    "create_subscription": ("message",),
    "create_service": ("request", "response"),
    "add_done_callback": ("future",),
}


def fit_parameters(source: SourceEditor, line: int) -> None:
    """Give the callback that is defined at a line the number of parameters that it is called with.

    Its parameters keep their names; one is removed only if it is not used. A method is given the ``self``
    that it lacks, a lambda all that it lacks. A service's callback that is given its response returns it.
    """
    lambdas = [
        each for each in source.nodes(ast.Lambda) if each.lineno == line and not ast.unparse(each.args)
    ]
    if lambdas:
        begin = f"lambda {', '.join(_parameters(source, lambdas[0]))}"
        source.replace(lambdas[0], source.code_of(lambdas[0]).replace("lambda", begin, 1))
        return
    callback = defined_at(source, line)
    wanted, given = _parameters(source, callback), callback.args.args
    own = _own(source, callback)
    has_own = any(each.arg in ("self", "cls") for each in given[:own])
    lacks_self = own > 0 and not has_own and len(given) <= len(wanted)
    own -= lacks_self
    surplus, missing = given[own + len(wanted) :], wanted[len(given) - own :]
    used = {each.id for each in source.nodes(ast.Name, callback)}
    is_plain = ast.unparse(callback.args) == ", ".join(map(ast.unparse, given))
    if not is_plain or used & {each.arg for each in surplus} or not (surplus or missing or lacks_self):
        raise NotSimpleError
    if lacks_self and given:
        source.insert_before(given[0], "self, ")
    if missing and given:
        source.insert_behind(given[-1], "".join(f", {each}" for each in missing))
    elif not given:
        empty = name_of(callback)
        assert empty.end_col_offset is not None
        empty.end_col_offset += len("()")
        if source.code_of(empty) != f"{callback.name}()":
            raise NotSimpleError
        source.replace(empty, f"{callback.name}({', '.join(['self'] * lacks_self + [*missing])})")
    elif surplus == given:
        source.replace(surplus[0], "")
        if surplus[1:]:
            source.cut_behind(surplus[0], surplus[-1])
    elif surplus:
        source.cut_behind(given[own + len(wanted) - 1], surplus[-1])
    if "response" in missing and not source.nodes(ast.Return, callback):
        add_at_end(source, callback, "return response")


def _own(source: SourceEditor, callback: ast.FunctionDef) -> int:
    """Return how many of a callback's parameters nobody passes: 1, for ``self``, of a method."""
    is_static = any(ast.unparse(each) == "staticmethod" for each in callback.decorator_list)
    return 1 if source.is_method(callback) and not is_static else 0


def hand_over_function(source: SourceEditor, line: int) -> None:
    """Hand over the function itself, not what its call returned, where a callback is made at a line."""
    called = [
        argument
        for made in source.nodes(ast.Call)
        if isinstance(made.func, ast.Attribute) and made.func.attr in _PARAMETERS and made.lineno == line
        for argument in made.args
        if isinstance(argument, ast.Call) and isinstance(argument.func, ast.Name | ast.Attribute)
    ]
    if len(called) != 1 or called[0].args or called[0].keywords:
        raise NotSimpleError
    source.replace(called[0], source.code_of(called[0].func))


def _parameters(source: SourceEditor, callback: ast.FunctionDef | ast.Lambda) -> Sequence[str]:
    """Return the parameters of a callback, by the call in which the program uses it."""
    name = callback.name if isinstance(callback, ast.FunctionDef) else ""
    found = {
        call.func.attr
        for call in source.nodes(ast.Call)
        if isinstance(call.func, ast.Attribute)
        and call.func.attr in _PARAMETERS
        and any(
            each is callback or (name and ast.unparse(each).rpartition(".")[2] == name) for each in call.args
        )
    }
    if len(found) != 1:
        raise NotSimpleError
    return _PARAMETERS[found.pop()]


def return_response(source: SourceEditor, line: int) -> None:
    """End the service's callback that is defined at a line by returning its response."""
    callback = defined_at(source, line)
    returns = source.nodes(ast.Return, callback)
    if len(callback.args.args) != 2 + _own(source, callback) or returns:
        raise NotSimpleError
    add_at_end(source, callback, f"return {callback.args.args[-1].arg}")


def await_coroutine(source: SourceEditor, line: int) -> None:
    """Await what a line makes by its only call of an ``async def``; its function becomes one, too.

    The program itself does not call that function: rclpy awaits it.
    """
    coroutines = {each.name for each in source.nodes(ast.AsyncFunctionDef)}
    call = source.call_at(line, coroutines.__contains__)
    inside = (ast.Call, ast.Attribute, ast.Subscript, ast.keyword, ast.Lambda, ast.GeneratorExp, ast.ListComp)
    parts = (part for each in source.nodes(ast.AST) if isinstance(each, inside) for part in ast.walk(each))
    if sum(part is call for part in parts) != 1:  # as a call, it is inside itself
        raise NotSimpleError
    if isinstance(source.function_at(line), ast.FunctionDef):
        function = source.uncalled_at(line)
        if source.nodes(ast.Yield, function):
            raise NotSimpleError
        source.insert_before(function, "async ")
    source.insert_before(call, "await ")


def add_at_end(source: SourceEditor, callback: ast.FunctionDef, statement: str) -> None:
    """Add a statement at the end of a function."""
    last = callback.body[-1]
    kept = source.lines_behind(last.lineno - 1, last)
    source.replace_lines(last, last, f"{kept}{indentation(last)}{statement}\n")


def defined_at(source: SourceEditor, line: int) -> ast.FunctionDef:
    """Return the function that is defined at a line, if the program itself does not call it."""
    callback = source.uncalled_at(line)
    if callback.lineno != line:
        raise NotSimpleError
    return callback
