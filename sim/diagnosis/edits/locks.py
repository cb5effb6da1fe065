"""Edits of callbacks that take locks."""

import ast
from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

from sim.diagnosis.edits.polling import leave_out
from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.replies import future_of, is_at, plain_call
from sim.diagnosis.edits.source_editor import Function, NotSimpleError, SourceEditor, indentation


def take_together(source: SourceEditor, line: int, other: int) -> None:
    """Let the callback at a line take both locks at once, in the order of the callback at line ``other``.

    Only for a ``with`` inside a ``with``, in both callbacks.
    """
    outer, inner = _nested(source, line)
    first, second = (_lock(source, each) for each in _nested(source, other))
    if (_lock(source, outer), _lock(source, inner)) != (second, first):
        raise NotSimpleError
    source.replace(outer.items[0].context_expr, f"{first}, {second}")
    source.replace_lines(
        inner, inner, source.lines_moved(_header_end(inner), inner.body[-1], inner.col_offset)
    )


@asked_of_file
def locks_in_turn(source: SourceEditor) -> tuple[tuple[int, int, int, int, str, str], ...]:
    """Return pairs of methods that take two locks in opposite orders, with the locks in that of the first.

    Each by its line, and that of its inner ``with``. Methods that have a third lock in common exclude each
    other. The locks are made by the class itself.
    """
    return tuple(
        (one.lineno, first.line, two.lineno, second.line, first.outer, first.inner)
        for owner in source.nodes(ast.ClassDef)
        for one, two in combinations((each for each in owner.body if isinstance(each, ast.FunctionDef)), 2)
        for first in _taken_inside(source, one, _made_in(source, owner))
        for second in _taken_inside(source, two, _made_in(source, owner))
        if (first.outer, first.inner) == (second.inner, second.outer) and not first.held & second.held
    )


class _Taken(NamedTuple):
    """A lock that is taken inside another one, with all others that are held then."""

    outer: str
    inner: str
    line: int
    held: frozenset[str]


def _made_in(source: SourceEditor, owner: ast.ClassDef) -> set[str]:
    """Return the attributes to which a class assigns locks."""
    made = (each for each in source.nodes(ast.Assign, owner) if isinstance(each.value, ast.Call))
    return {
        ast.unparse(target)
        for each in made
        if ast.unparse(each.value).rpartition(".")[2] in ("Lock()", "RLock()")
        for target in each.targets
        if isinstance(target, ast.Attribute)
    }


def _taken_inside(source: SourceEditor, part: ast.AST, locks: set[str], *held: str) -> Iterator[_Taken]:
    """Yield each lock that a part of a method takes by ``with``, once for each that it has already."""
    for each in ast.iter_child_nodes(part):
        now = held
        for item in each.items if isinstance(each, ast.With) else ():
            if (lock := ast.unparse(item.context_expr)) in locks:
                others = ((outer, frozenset(now) - {outer}) for outer in now)
                yield from (_Taken(outer, lock, item.context_expr.lineno, rest) for outer, rest in others)
                now = (*now, lock)
        if not isinstance(each, ast.Lambda | ast.FunctionDef | ast.AsyncFunctionDef):
            yield from _taken_inside(source, each, locks, *now)


def take_before(source: SourceEditor, line: int, other: int) -> None:
    """Let the callback at a line take its locks by ``acquire`` in the order of that at line ``other``.

    The lock that it takes at the line is taken before the first one. Only where no ``try`` is between them.
    """
    function = source.function_at(line)
    taken = [each for each in function.body if _method_of(each, "acquire")]
    wanted = [each for each in taken if each.lineno == line]
    first, second = _order(source, other)
    if len(wanted) != 1 or _acquired(wanted[0]) != first or wanted[0] is taken[0]:
        raise NotSimpleError
    if _acquired(taken[0]) != second:
        raise NotSimpleError
    moved = source.lines_behind(line - 1, wanted[0])
    source.replace_lines(wanted[0], wanted[0], "")
    source.replace_lines(taken[0], taken[0], moved + source.lines_behind(taken[0].lineno - 1, taken[0]))


def take_by_with(source: SourceEditor, line: int) -> None:
    """Take the lock of the ``acquire`` at a line by ``with``, up to the last statement that releases it.

    Only for statements of one function's body, and a lock that is not taken there again.
    """
    function = source.function_at(line)
    taken = [each for each in function.body if each.lineno == line and _method_of(each, "acquire")]
    if len(taken) != 1:
        raise NotSimpleError
    lock = _acquired(taken[0])
    behind = function.body[function.body.index(taken[0]) + 1 :]
    parts = [each for part in behind for each in source.nodes(ast.Expr, part)]
    releases = [each for each in parts if _method_of(each, "release", lock)]
    again = [each for each in parts if _method_of(each, "acquire", lock)]
    if again or not releases or releases[-1] is not behind[-1] or len(behind) < 2:
        raise NotSimpleError
    edited = SourceEditor(source.text)
    for each in releases[:-1]:
        leave_out(edited, each.lineno)
    inside = SourceEditor(edited.result())
    *_, last, _ = inside.function_at(line).body
    body = inside.lines_moved(line, last, last.col_offset + 4)
    source.replace_lines(taken[0], behind[-1], f"{indentation(taken[0])}with {lock}:\n{body}")


def take_by_one_with(source: SourceEditor, line: int, other: int) -> None:
    """Take two locks that ``finally`` releases by one ``with``, in the order of the callback at ``other``.

    Only for an ``acquire`` and its ``try`` as all there is in the ``try`` of another one, but for what is
    before it, which is done with both locks then.
    """
    body = source.function_at(line).body
    places = [place for place, each in enumerate(body[1:], 1) if is_at(each, line)]
    if not places or not isinstance(body[places[0]], ast.Try):
        raise NotSimpleError
    outer, around = body[places[0] - 1], body[places[0]]
    held = _released_by(around, _acquired(outer))
    if len(held) < 2:
        raise NotSimpleError
    *before, inner, within = held
    inside = _released_by(within, _acquired(inner))
    first, second = _order(source, other)
    if inner.lineno != line or (_acquired(inner), _acquired(outer)) != (first, second):
        raise NotSimpleError
    column = outer.col_offset + 4
    kept = source.lines_moved(around.lineno, before[-1], column) if before else ""
    kept += source.lines_moved(within.lineno, inside[-1], column)
    source.replace_lines(outer, around, f"{indentation(outer)}with {first}, {second}:\n{kept}")


def _released_by(statement: ast.stmt, lock: str) -> list[ast.stmt]:
    """Return the body of a ``try`` of which the ``finally`` releases a lock, and nothing else."""
    match statement:
        case ast.Try(body=body, handlers=[], orelse=[], finalbody=[last]) if _method_of(
            last, "release", lock
        ):
            return body
    raise NotSimpleError


def _order(source: SourceEditor, line: int) -> tuple[str, str]:
    """Return the lock that a function takes first by ``acquire``, and the one that it takes at a line."""
    statements = source.nodes(ast.Expr, source.function_at(line))
    taken = sorted((each for each in statements if _method_of(each, "acquire")), key=lambda each: each.lineno)
    at = [each for each in taken if each.lineno == line]
    if len(at) != 1 or at[0] is taken[0]:
        raise NotSimpleError
    return _acquired(taken[0]), _acquired(at[0])


def _method_of(node: ast.AST, method: str, lock: str = "") -> ast.expr | None:
    """Return the object of a statement that only calls a method, if it is ``lock`` ("": any); else None."""
    match node:
        case ast.Expr(value=ast.Call(func=ast.Attribute(value=found, attr=name), args=[], keywords=[])):
            return found if name == method and lock in ("", ast.unparse(found)) else None
    return None


def _acquired(statement: ast.stmt) -> str:
    found = _method_of(statement, "acquire")
    if found is None:
        raise NotSimpleError
    return ast.unparse(found)


def let_go_during_wait(source: SourceEditor, line: int) -> None:
    """Take the call or the wait at a line out of the ``with`` of a lock, which is taken again after it.

    Only if what is called or waited for is known without the lock.
    """
    block, *more = _around(source, line)
    lock, function = _lock(source, block), source.function_at(line)
    waits = [each for each in block.body if is_at(each, line)]
    if more or not waits or not _is_lock(source, lock):
        raise NotSimpleError
    wait, blank = waits[0], indentation(block)
    first, begin = (block, _header_end(block)) if wait is block.body[0] else (wait, wait.lineno - 1)
    outside, inside = source.lines_moved(begin, wait, block.col_offset), ""
    call, awaited = plain_call(wait), _awaited_call(wait)
    known = call or awaited
    if known is None:
        future_of(wait)
    elif _is_of_self(source, known, function):
        raise NotSimpleError
    elif call is not None and not _only_names(wait, call):
        if "reply" in {each.id for each in source.nodes(ast.Name, function)}:
            raise NotSimpleError
        asked = source.code_of(call)
        outside = f"{blank}reply = {asked}\n"
        inside = source.lines_behind(begin, wait).replace(asked, "reply", 1)
    if inside or wait is not block.body[-1]:
        outside += f"{blank}with {lock}:\n"
    source.replace_lines(first, wait, outside + inside)


def _awaited_call(statement: ast.stmt) -> ast.Call | None:
    """Return the ``client.call_async(request)`` that a statement only awaits; else None."""
    match statement:
        case (
            ast.Expr(value=ast.Await(value=call))
            | ast.Assign(targets=[ast.Name()], value=ast.Await(value=call))
        ):
            if isinstance(call, ast.Call) and ast.unparse(call.func).endswith(".call_async") and call.args:
                return call
    return None


def keeps_lock(source: SourceEditor, line: int) -> bool:
    """Return whether a line is inside a ``with`` of a lock that the source makes."""
    try:
        return any(_is_lock(source, _lock(source, block)) for block in _around(source, line))
    except NotSimpleError:
        return False


def _is_lock(source: SourceEditor, lock: str) -> bool:
    makers = {ast.unparse(each).rpartition(".")[2] for each in _made(source, lock)}
    return bool(makers) and makers <= {"Lock()", "RLock()"}


def release_during_wait(source: SourceEditor, line: int) -> None:
    """Release the lock that is taken by ``acquire`` before the call at a line, and take it again after that.

    Only for one lock, and if what is called is known without it.
    """
    function = source.function_at(line)
    taken = [each for each in source.nodes(ast.Expr, function) if _method_of(each, "acquire")]
    wait = source.statement_at(line)
    call, lock = plain_call(wait), {_acquired(each) for each in taken}
    after = [each for each in source.nodes(ast.Expr, function) if _method_of(each, "release")]
    is_held = any(each.lineno < line for each in taken) and any(each.lineno > line for each in after)
    if call is None or len(lock) != 1 or not is_held or _is_of_self(source, call, function):
        raise NotSimpleError
    (name,), blank = lock, indentation(wait)
    kept = source.lines_behind(wait.lineno - 1, wait)
    source.replace_lines(wait, wait, f"{blank}{name}.release()\n{kept}{blank}{name}.acquire()\n")


def _is_of_self(source: SourceEditor, call: ast.Call, function: Function) -> bool:
    """Return whether a request is made of what the object has, which others may change."""
    me = {each.arg for each in function.args.args[:1]}
    return bool(me & {each.id for each in source.nodes(ast.Name, call.args[0])})


def _only_names(statement: ast.stmt, call: ast.Call) -> bool:
    """Return whether a statement only calls, and at most gives the result a local name."""
    match statement:
        case ast.Expr(value=value) | ast.Assign(targets=[ast.Name()], value=value):
            return value is call
    return False


def _header_end(block: ast.With) -> int:
    """Return the last line of a ``with`` before its body, which is on lines of its own."""
    end = block.items[-1].context_expr.end_lineno or 0
    if block.body[0].lineno <= end:
        raise NotSimpleError
    return end


def _around(source: SourceEditor, line: int) -> list[ast.With]:
    """Return the ``with`` blocks around a line, the outermost first."""
    blocks = [each for each in source.nodes(ast.With, source.function_at(line)) if is_at(each, line)]
    if not blocks:
        raise NotSimpleError
    return sorted(blocks, key=lambda each: each.lineno)


def _nested(source: SourceEditor, line: int) -> tuple[ast.With, ast.With]:
    """Return the ``with`` around the one at a line, and that one."""
    blocks = _around(source, line)
    if len(blocks) != 2 or blocks[1] not in blocks[0].body:
        raise NotSimpleError
    return blocks[0], blocks[1]


def _lock(source: SourceEditor, with_: ast.With) -> str:
    if len(with_.items) != 1 or with_.items[0].optional_vars is not None:
        raise NotSimpleError
    return source.code_of(with_.items[0].context_expr)


def _made(source: SourceEditor, lock: str) -> list[ast.expr]:
    """Return what makes a lock of that name."""
    assigned = (each for each in source.nodes(ast.Assign) if len(each.targets) == 1)
    return [each.value for each in assigned if ast.unparse(each.targets[0]) == lock]


def make_reentrant(source: SourceEditor, line: int, before: int = 0) -> None:
    """Replace the lock that is taken at a line by an ``RLock``, which its holder may take again.

    Where it is taken by ``acquire``, only if another function takes it, too: else it was never released. At
    a line with a decorator, that takes it, at the line ``before``.
    """
    functions = source.nodes(ast.FunctionDef)
    line = before if any(each.lineno == line for one in functions for each in one.decorator_list) else line
    lock, here = _taken_at(source, line), list(ast.walk(source.function_at(line)))
    taken = [each for each in source.nodes(ast.Expr) if _method_of(each, "acquire", lock)]
    if taken and all(each in here for each in taken):
        raise NotSimpleError
    _reentrant(source, lock)


def take_early(source: SourceEditor, line: int, other: int, *callers: int) -> None:
    """Take the lock of a line before the one that is taken at line ``other``, by the ``with`` of that.

    The ``with`` is around one of the lines ``callers``, from which the function is called that takes the
    lock of the line. That takes it again: it becomes an ``RLock``.
    """
    wanted, held = _taken_at(source, line), _taken_at(source, other)
    blocks = [each for each in source.nodes(ast.With) if any(is_at(each, caller) for caller in callers)]
    around = [each for each in blocks if _lock(source, each) == held]
    owners = {
        source.owner_of(source.function_at(each)) for each in (line, *(block.lineno for block in around))
    }
    if len(around) != 1 or len(owners) != 1:
        raise NotSimpleError
    source.replace(around[0].items[0].context_expr, f"{wanted}, {held}")
    _reentrant(source, wanted)


def make_one(source: SourceEditor, line: int, other: int) -> None:
    """Let the locks that are taken at two lines be one ``RLock``, if the same function makes both."""
    names = {_taken_at(source, each) for each in (line, other)}
    made = {name: value for name in names for value in _made(source, name)}
    ordered = sorted(made, key=lambda name: made[name].lineno)
    makers = {ast.unparse(each) for each in made.values()}
    functions = {source.function_at(each.lineno) for each in made.values()}
    if len(made) != 2 or len(functions) != 1 or not makers <= {"threading.Lock()", "Lock()"}:
        raise NotSimpleError
    source.replace(made[ordered[1]], ordered[0])
    _reentrant(source, ordered[0])


def _taken_at(source: SourceEditor, line: int) -> str:
    """Return the lock that is taken at a line."""
    blocks = [each for each in source.nodes(ast.With) if each.lineno <= line <= each.body[0].lineno]
    return _lock(source, blocks[-1]) if blocks else _acquired(source.statement_at(line))


def _reentrant(source: SourceEditor, lock: str) -> None:
    made = _made(source, lock)
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
