"""Loops that only ask for what another function sets: which function, and the edit that lets it run."""

import ast
from collections.abc import Iterable
from contextlib import suppress

from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.replies import is_idle
from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, indentation

_TELLS = ("print", "debug", "info", "warn", "warning", "error", "fatal")


@asked_of_file
def setters(source: SourceEditor, line: int) -> tuple[str, ...]:
    """Return the functions that set what a ``while`` waits for which only asks; constructors are left out."""
    try:
        loop = _asking(source, line)
    except NotSimpleError:
        return ()
    tests = [loop.test, *(each.test for each in loop.body if isinstance(each, ast.If))]
    asked = {ast.unparse(part) for test in tests for part in source.nodes(ast.expr, test)}
    functions = (each for each in source.nodes(ast.FunctionDef) if each.name != "__init__")
    return tuple(each.name for each in functions if asked & _set_by(source, each))


@asked_of_file
def only_sleeps(source: SourceEditor, line: int) -> bool:
    """Return whether a line is in a ``while True`` or ``while rclpy.ok()`` in which nothing is done."""
    around = [each for each in source.nodes(ast.While) if each.lineno <= line <= (each.end_lineno or 0)]
    return any(
        ast.unparse(each.test) in ("True", "1", "rclpy.ok()")
        and all(is_idle(part) and "spin" not in ast.unparse(part) for part in each.body)
        for each in around
    )


@asked_of_file
def enders(source: SourceEditor, line: int) -> tuple[tuple[str, str, int], ...]:
    """Return what ends the wait of a line: the functions, the calls there, and their lines.

    The wait is for an event, a future, a condition, a semaphore, an item of a queue, or room in it. What a
    function both takes and gives, such as a lock, it keeps meanwhile: that ends nobody's wait.
    """
    there = source.around(ast.expr, line)
    waits = {ast.unparse(each.func) for each in there if isinstance(each, ast.Call)}
    waits |= {f"{ast.unparse(each.value)}.wait" for each in there if isinstance(each, ast.Await)}
    parts = (each.rpartition(".") for each in waits)
    wakes = {f"{awaited}.{name}" for awaited, _, way in parts if awaited for name in _ENDS.get(way, ())}
    around = source.around(ast.ClassDef, line)
    own = around[-1] if around and all(each.startswith("self.") for each in wakes) else source.tree
    return tuple(
        (function.name, ast.unparse(each.func), each.lineno)
        for function in source.nodes(ast.FunctionDef, own)
        if not _does(source, function, waits)
        for each in source.nodes(ast.Call, function)
        if ast.unparse(each.func) in wakes
    )


@asked_of_file
def awaited_at(source: SourceEditor, line: int) -> str:
    """Return the one expression that a line awaits; "" if there is none, or another, or it is a call."""
    return _awaited(source, line)


def _awaited(source: SourceEditor, line: int) -> str:
    there = [each.value for each in source.around(ast.Await, line)]
    return ast.unparse(there[0]) if len(there) == 1 and isinstance(there[0], ast.Attribute | ast.Name) else ""


@asked_of_file
def never_set(source: SourceEditor, line: int) -> str:
    """Return the call that would end the wait of a line without a timeout, if the file has no such call.

    "" if it has one, if it uses what is waited for otherwise, as by handing it on, or did not make it.
    """
    there = [each for each in source.around(ast.Call, line) if not (each.args or each.keywords)]
    waits = [ast.unparse(each.func).rpartition(".") for each in there]
    for kind, (way, end, *others) in _ENDED_BY.items():
        awaited = {each for each, _, name in waits if name == way}
        last = awaited.pop().rpartition(".")[2] if len(awaited) == 1 else ""
        idle: list[ast.expr] = [each.context_expr for each in source.nodes(ast.withitem)]
        if _makers(source, last, (kind,), (way, *others), idle):
            return next(f"{each}.{end}()" for each, _, name in waits if name == way)
    return ""


@asked_of_file
def never_completed(source: SourceEditor, line: int) -> tuple[str, int]:
    """Return the future that a line awaits, and the line that makes it, if nothing in the file completes it.

    "" and 0 if something may, as what it is handed on to, or if the file does not make it.
    """
    future, makers = _future(source, line, ())
    return (future, makers[0].lineno) if makers else ("", 0)


@asked_of_file
def completers(source: SourceEditor, line: int) -> tuple[tuple[str, str, int], ...]:
    """Return what completes the future that a line awaits, as ``enders``, if nothing else of the file may.

    The program hands these functions over once each, as callbacks may be, and does not call them.
    """
    completes = [each for each in source.nodes(ast.Call) if ast.unparse(each.func).endswith(".set_result")]
    future, makers = _future(source, line, [each.func for each in completes])
    last = future.rpartition(".")[2]
    found = []
    with suppress(NotSimpleError):
        for each in completes if makers else ():
            call = ast.unparse(each.func)
            if call.rpartition(".")[0].rpartition(".")[2] == last:
                function = source.uncalled_at(each.lineno)
                if len(source.uses_of(function)) != 1:
                    raise NotSimpleError
                found.append((function.name, call, each.lineno))
        return tuple(found)
    return ()


def _future(source: SourceEditor, line: int, calls: Iterable[ast.expr]) -> tuple[str, list[ast.Assign]]:
    """Return the future that a line awaits, and what makes it, if all else asks, awaits, or ``calls`` it."""
    future = _awaited(source, line)
    idle = [each.value for each in source.nodes(ast.Await)]
    idle += [each.value for each in calls if isinstance(each, ast.Attribute)]
    asking = ("done", "result", "cancelled", "exception", "add_done_callback")
    return future, _makers(source, future.rpartition(".")[2], ("Future", "create_future"), asking, idle)


@asked_of_file
def asked_at(source: SourceEditor, line: int) -> int:
    """Return the line of the ``call_async()`` whose future a line awaits; 0 for none."""
    future = _awaited(source, line)
    around = source.around(ast.AsyncFunctionDef, line)
    where = around[-1] if around and "." not in future else source.tree
    made = [each for each in source.nodes(ast.Assign, where) if future in map(ast.unparse, each.targets)]
    values = {each.lineno: ast.unparse(each.value).partition("(")[0] for each in made}
    asks = {line: value for line, value in values.items() if value != "None"}
    return min(asks, default=0) if all(each.endswith(".call_async") for each in asks.values()) else 0


def _makers(
    source: SourceEditor,
    last: str,
    kinds: tuple[str, ...],
    asking: tuple[str, ...],
    idle: Iterable[ast.expr],
) -> list[ast.Assign]:
    """Return the statements that make what has a name, by a call of some kinds, if all else only asks it.

    That is by its methods ``asking``, or where it is one of the expressions ``idle``.
    """
    named: list[ast.expr] = [each for each in source.nodes(ast.Attribute) if each.attr == last]
    named += [each for each in source.nodes(ast.Name) if each.id == last]
    made = [
        each
        for each in source.nodes(ast.Assign)
        if isinstance(each.value, ast.Call) and ast.unparse(each.value.func).rpartition(".")[2] in kinds
        if any(ast.unparse(target).rpartition(".")[2] == last for target in each.targets)
    ]
    known = {id(target) for each in made for target in each.targets} | {id(each) for each in idle}
    known |= {id(each.value) for each in source.nodes(ast.Attribute) if each.attr in asking}
    return made if all(id(each) in known for each in named) else []


def wait_at_most(source: SourceEditor, line: int) -> None:
    """Give the only wait at a line, one without a timeout, a short one."""
    wait = source.call_at(line, "wait".__eq__)
    source.replace(wait, f"{source.code_of(wait.func)}(timeout=0.1)")


@asked_of_file
def parties_at(source: SourceEditor, line: int) -> tuple[str, int, tuple[str, ...]]:
    """Return the barrier at which a line waits, its parties (0: unknown), and the functions that do."""
    with suppress(NotSimpleError):
        parties, gate = _barrier(source, line)
        waits = [each for each in source.nodes(ast.Call) if ast.unparse(each.func) == f"{gate}.wait"]
        functions = tuple(source.function_at(each.lineno).name for each in waits)
        return gate, int(ast.unparse(parties)), functions
    return "", 0, ()


def set_parties(source: SourceEditor, line: int, parties: int) -> None:
    """Give the barrier at which a line waits another number of parties."""
    source.replace(_barrier(source, line)[0], str(parties))


def _barrier(source: SourceEditor, line: int) -> tuple[ast.Constant, str]:
    waits = ast.unparse(source.call_at(line, "wait".__eq__).func)
    for each in source.nodes(ast.Assign):
        match each.value:
            case ast.Call(func=ast.Attribute(attr="Barrier"), args=[ast.Constant(value=int()) as parties]):
                if waits == f"{(gate := ast.unparse(each.targets[0]))}.wait":
                    return parties, gate
    raise NotSimpleError


def _does(source: SourceEditor, function: ast.FunctionDef, calls: set[str]) -> bool:
    return any(ast.unparse(each.func) in calls for each in source.nodes(ast.Call, function))


_ENDS = {
    **dict.fromkeys(("wait", "wait_for"), ("set", "notify", "notify_all", "set_result")),
    "result": ("set_result",),
    "acquire": ("release",),
    "get": ("put", "put_nowait"),
    "put": ("get", "get_nowait"),
}
"""The methods that end the wait in a method of the same object."""


_ENDED_BY = {
    "Event": ("wait", "set", "is_set", "clear"),
    "Condition": ("wait", "notify", "acquire", "release"),
    "Queue": ("get", "put", "empty", "full", "qsize", "task_done"),
}
"""By the class of what is waited for: the method that waits, the one that ends it, and those that do not."""


def event_setters(file: str, line: int) -> tuple[str, ...]:
    """Return the functions that end the wait of a line."""
    return tuple(dict.fromkeys(function for function, _, _ in enders(file, line)))


@asked_of_file
def sleeps(source: SourceEditor, line: int) -> bool:
    """Return whether a ``while`` that only asks lets time pass in each round."""
    with suppress(NotSimpleError):
        return _sleeps(_asking(source, line))
    return False


def _set_by(source: SourceEditor, function: ast.FunctionDef) -> set[str]:
    """Return the attributes and global variables that a function sets, or changes by an item or a method."""
    shared = {name for each in source.nodes(ast.Global, function) for name in each.names}
    stored = (
        each for each in source.nodes(ast.expr, function) if isinstance(vars(each).get("ctx"), ast.Store)
    )
    items = (each.value if isinstance(each, ast.Subscript) else each for each in stored)
    calls = (each.func for each in source.nodes(ast.Call, function))
    changed = (each.value for each in calls if isinstance(each, ast.Attribute) and each.attr in _CHANGES)
    return {name for name in map(ast.unparse, (*items, *changed)) if "." in name or name in shared}


_CHANGES = ("add", "append", "extend", "put", "put_nowait", "set", "set_result", "update")
"""The methods that change what a loop may ask."""


def sleep_in_loop(source: SourceEditor, line: int) -> None:
    """Let the ``while`` at a line that only asks sleep in each round, if it does not yet."""
    loop = _asking(source, line)
    if _sleeps(loop):
        raise NotSimpleError
    has_time = any(name.name == "time" for each in source.nodes(ast.Import) for name in each.names)
    sleep, last = "time.sleep(0.01)" if has_time else "sleep(0.01)", loop.body[-1]
    if isinstance(last, ast.Pass):
        source.replace(last, sleep)
    else:
        source.insert_behind(last, f"\n{indentation(last)}{sleep}")
    if not has_time:
        source.import_names("time", ["sleep"])


def _sleeps(loop: ast.While) -> bool:
    calls = (each.func for each in ast.walk(loop.test) if isinstance(each, ast.Call))
    waits = any(isinstance(each, ast.Attribute) and each.attr.startswith("wait") for each in calls)
    return waits or any(is_idle(each) and not isinstance(each, ast.Pass) for each in loop.body)


def _asking(source: SourceEditor, line: int) -> ast.While:
    """Return the innermost ``while`` around a line if all it does is to ask, to log, and to let time pass."""
    loops = source.around(ast.While, line)
    if not loops or not all(is_idle(each) or _asks_or_logs(each) for each in loops[-1].body):
        raise NotSimpleError
    return loops[-1]


def _asks_or_logs(statement: ast.stmt) -> bool:
    match statement:
        case ast.If(body=[ast.Break()], orelse=[]):
            return True
        case ast.Expr(value=ast.Call(func=ast.Attribute(attr=name) | ast.Name(id=name))):
            return name in _TELLS
    return False
