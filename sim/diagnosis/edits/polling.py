"""Edits of callbacks that wait or loop: they return, and continue at their next call."""

import ast
from collections.abc import Iterable, Iterator

from sim.diagnosis.edits.replies import check_rest, is_idle
from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, indentation

_WAIT = "wait_for_service"
_ONCE = {"cancel", "destroy_timer", "create_timer", "create_rate"}
"""What is done before a loop, and not again before each step."""


def look_again(source: SourceEditor, line: int) -> None:
    """Let a callback return instead of waiting at a line, if its condition does not hold yet.

    A service's callback returns its response as it is. Only for a statement of the callback's body, or of
    an ``if`` there, that only waits, or logs meanwhile, or returns if a wait for a service was in vain.
    """
    callback = source.callback_at(line)
    wait, path = _within_ifs(callback, line)
    if _asks_in_vain(source, wait):
        return
    missing, meanwhile = _condition(source, wait)
    before = [each for body, inside in path for each in body[: body.index(inside)]]
    if any(_stores(part) & _attributes(ast.parse(f"({missing})")) for part in before):
        raise NotSimpleError  # it would start again at each call
    local = {each.id for each in source.nodes(ast.Name, callback) if isinstance(each.ctx, ast.Store)}
    used = {each.id for each in source.nodes(ast.Name, wait)}
    if used & local or any(each.lineno == wait.lineno for each in meanwhile):
        raise NotSimpleError
    blank = indentation(wait)
    step = " " * (callback.body[0].col_offset - callback.col_offset)
    logs = "".join(source.lines_behind(each.lineno - 1, each) for each in meanwhile)
    response = f" {callback.args.args[2].arg}" if len(callback.args.args) == 3 else ""
    source.replace_lines(wait, wait, f"{blank}if {missing}:\n{logs}{blank}{step}return{response}\n")


def _asks_in_vain(source: SourceEditor, wait: ast.stmt) -> bool:
    """Let a statement that waits for a service and returns without it only ask; return whether it is one."""
    match wait:
        case ast.If(
            test=ast.UnaryOp(
                op=ast.Not(), operand=ast.Call(func=ast.Attribute(value=client, attr=name)) as call
            ),
            body=[*_, ast.Return()],
        ) if name == _WAIT:
            source.replace(call, f"{source.code_of(client)}.service_is_ready()")
            return True
    return False


def go_on_where_set(source: SourceEditor, line: int) -> None:
    """Move the statements after the wait at a line to the method that sets the awaited attribute.

    They run there once the wait would be over. Only for a loop that only waits for an attribute that one
    other method sets, and that the callback has reset before; if in an ``if``, then in the last one.
    """
    callback = source.callback_at(line)
    wait, path = _within_ifs(callback, line)
    body, before = path[-1][0], [each for body, inside in path for each in body[: body.index(inside)]]
    rest, awaited = body[body.index(wait) + 1 :], _attributes(wait)
    if any(inside is not body[-1] or getattr(inside, "orelse", ()) for body, inside in path[:-1]):
        raise NotSimpleError
    if not isinstance(wait, ast.While) or wait.orelse or not all(map(is_idle, wait.body)):
        raise NotSimpleError
    me, reset = callback.args.args[0].arg, set().union(*map(_stores, body[: body.index(wait)]))
    names = {each.id for each in source.nodes(ast.Name, wait.test)}
    if not awaited <= reset or names != {me} or "was_waiting" in source.text:
        raise NotSimpleError
    check_rest(callback, before, rest, "")
    methods = (each for each in source.nodes(ast.FunctionDef) if each.name != "__init__")
    setters = [each for each in methods if each is not callback and awaited & _stores(each)]
    if len(setters) != 1 or not rest or setters[0].args.args[0].arg != me:
        raise NotSimpleError
    first, last = setters[0].body[ast.get_docstring(setters[0]) is not None :][0], setters[0].body[-1]
    if isinstance(last, ast.Return) or source.callback_at(last.lineno) is not setters[0]:
        raise NotSimpleError
    waits = source.code_of(wait.test)
    blank, deeper = indentation(last), last.col_offset + callback.body[0].col_offset - callback.col_offset
    moved = source.lines_moved(wait.end_lineno or 0, rest[-1], deeper)
    source.replace_lines(wait, rest[-1], "")
    begin, end = f"was_waiting = {waits}", f"if was_waiting and {_negated(source, wait.test)}:"
    setting = source.lines_behind(first.lineno - 1, last)
    source.replace_lines(first, last, f"{blank}{begin}\n{setting}{blank}{end}\n{moved}")


def _within_ifs(
    callback: ast.FunctionDef, line: int
) -> tuple[ast.stmt, list[tuple[list[ast.stmt], ast.stmt]]]:
    """Return the statement at a line, and the bodies from the callback's to its own, each with its part."""
    statement = _statement_at(callback, line)
    path = [(callback.body, statement)]
    while isinstance(statement, ast.If) and (statement.test.end_lineno or 0) < line:
        body = next(each for each in (statement.orelse, statement.body) if each and each[0].lineno <= line)
        statement = next((each for each in body if line <= (each.end_lineno or 0)), statement)
        path.append((body, statement))
    return statement, path


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
        case ast.Expr(value=ast.Call(func=ast.Attribute(value=client, attr=name))) if name == _WAIT:
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
        case ast.Compare(left=left, ops=[ast.Is()], comparators=[other]):
            return f"{source.code_of(left)} is not {source.code_of(other)}"
        case ast.Name() | ast.Attribute() | ast.Call() | ast.Subscript():
            return f"not {source.code_of(condition)}"
    return f"not ({source.code_of(condition)})"


def leave_out(source: SourceEditor, line: int) -> None:
    """Remove the statement at a line of a method that only calls a function."""
    statement = source.statement_at(line)
    bodies = (getattr(each, "body", ()) for each in source.nodes(ast.stmt, source.function_at(line)))
    around = [each for each in bodies if statement in each]
    if not around or not isinstance(statement, ast.Expr) or not isinstance(statement.value, ast.Call):
        raise NotSimpleError
    is_alone = len(around[-1]) == 1
    if any(each.body == [statement] for each in source.nodes(ast.While)):
        raise NotSimpleError  # the loop would compute for ever
    source.replace_lines(statement, statement, f"{indentation(statement)}pass\n" if is_alone else "")


def step_by_step(source: SourceEditor, line: int) -> None:
    """Replace the endless loop at a line by one step of it; where the loop ends, the callback returns.

    Only if no step needs what the callback sets before the loop. The callback's timer gets the period of the
    loop's pauses.
    """
    callback = source.callback_at(line)
    loop = _statement_at(callback, line)
    if not isinstance(loop, ast.While) or loop.orelse or not _is_endless(loop.test):
        raise NotSimpleError
    place, steps = callback.body.index(loop), [each for each in loop.body if not is_idle(each)]
    if all(isinstance(each, ast.If) and isinstance(each.body[0], ast.Break) for each in steps):
        raise NotSimpleError  # it only waits, which look_again() is for
    made = _keep_pace(source, callback, [each for each in loop.body if is_idle(each)])
    _check_steps([each for each in callback.body[:place] if each is not made], steps)
    rest = callback.body[place + 1 :]
    source.replace_lines(loop, (rest or [loop])[-1], _one_step(source, loop, rest))


def one_round_a_call(source: SourceEditor, line: int, least: int = 0) -> None:
    """Replace the ``for`` around a line by one round of it at each call of the callback; then it begins anew.

    Only for a loop over literals, of so many rounds at least, that ends the body of a timer's callback. The
    timer gets the period of the loop's pauses.
    """
    callback = source.callback_at(line)
    loop, timers, steps = (
        _statement_at(callback, line),
        _timers_of(source, callback),
        f"{callback.name}_steps",
    )
    pauses = [each for each in getattr(loop, "body", ()) if is_idle(each)]
    if not isinstance(loop, ast.For) or loop.orelse or loop is not callback.body[-1] or len(pauses) != 1:
        raise NotSimpleError
    names = {ast.unparse(each) for each in ast.walk(loop.iter) if isinstance(each, ast.Name | ast.Attribute)}
    is_left = any(isinstance(each, ast.Break) for each in _ends(loop.body))
    if names - {"range"} or is_left or len(timers) != 1 or steps in source.text:
        raise NotSimpleError
    if _rounds(loop.iter) < least:
        raise NotSimpleError  # the callback has pauses between its loops
    made = _keep_pace(source, callback, pauses)
    _check_steps([each for each in callback.body[:-1] if each is not made], loop.body)
    me, blank = callback.args.args[0].arg, indentation(loop)
    begin = f"{blank}{source.code_of(loop.target)} = next({me}.{steps})\n"
    source.replace_lines(loop, loop, begin + _one_step(source, loop, []))
    making = source.statement_at(timers[0].lineno)
    source.insert_before(making, f"{me}.{steps} = cycle({source.code_of(loop.iter)})\n{indentation(making)}")
    source.import_names("itertools", ["cycle"])


def _rounds(iterable: ast.expr) -> int:
    match iterable:
        case ast.List(elts=items) | ast.Tuple(elts=items):
            return len(items)
        case ast.Call(func=ast.Name(id="range"), args=[ast.Constant(value=int(number))]):
            return number
    return 0


def _check_steps(before: list[ast.stmt], steps: list[ast.stmt]) -> None:
    """Raise NotSimpleError if the statements before a loop cannot be run before each step of it."""
    inside = [each for part in steps for each in ast.walk(part)]
    earlier = [each for part in before for each in ast.walk(part)]
    called = {each.func.attr for each in earlier if isinstance(each, ast.Call) and hasattr(each.func, "attr")}
    local = {each.id for each in earlier if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)}
    stored = {stored for part in before for stored in _stores(part)}
    needed = {ast.unparse(each) for each in inside if isinstance(each, ast.Name | ast.Attribute)}
    kept = {each.partition(".")[0] for each in (local | stored) & needed}
    if kept - _made_anew(before, inside) or called & _ONCE:
        raise NotSimpleError
    if any(isinstance(each, ast.Yield | ast.Await) for each in inside):
        raise NotSimpleError


def _made_anew(before: list[ast.stmt], inside: list[ast.AST]) -> set[str]:
    """Return the variables that are made alike at each call, such as a message, and that no step changes."""
    alike: set[str] = set()
    changed = _set_in(inside)
    changed |= {_root(each.func) for each in inside if isinstance(each, ast.Call)}
    for part in before:
        nodes = list(ast.walk(part))
        makers = {ast.unparse(each.func).rpartition(".")[2] for each in nodes if isinstance(each, ast.Call)}
        is_alike = all(each[:1].isupper() for each in makers)
        is_alike &= not any(isinstance(each, ast.Name) and each.id == "self" for each in nodes)
        (alike if is_alike else changed).update(_set_in(nodes))
    return alike - changed


def _set_in(nodes: list[ast.AST]) -> set[str]:
    return {_root(each) for each in nodes if isinstance(getattr(each, "ctx", None), ast.Store | ast.Del)}


def _root(node: ast.AST) -> str:
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return node.id if isinstance(node, ast.Name) else ""


def _one_step(source: SourceEditor, loop: ast.While | ast.For, rest: list[ast.stmt]) -> str:
    """Return the lines of a loop's body without its pauses, which return where the loop ends or begins anew.

    What follows the loop is where it ends.
    """
    ends = list(_ends(loop.body))
    breaks = [each for each in ends if isinstance(each, ast.Break)]
    if rest and (len(breaks) != 1 or not _is_plain(source, loop, breaks[0])):
        raise NotSimpleError
    ending = SourceEditor(source.text)
    for each in ends:
        code = ""
        if rest and isinstance(each, ast.Break):
            code = source.lines_moved(loop.end_lineno or 0, rest[-1], each.col_offset).lstrip()
        is_over = code and isinstance(rest[-1], ast.Return)
        ending.replace(each, code.rstrip() if is_over else f"{code}{code and indentation(each)}return")
    edited = SourceEditor(ending.result())
    stepped = next(each for each in edited.nodes(type(loop)) if each.lineno == loop.lineno)
    header = stepped.test if isinstance(stepped, ast.While) else stepped.iter
    line, text = header.end_lineno or 0, ""
    if stepped.body[0].lineno == line:
        raise NotSimpleError
    for part in stepped.body:
        text += "" if is_idle(part) else edited.lines_moved(line, part, stepped.col_offset)
        line = part.end_lineno or 0
    return text or f"{indentation(loop)}pass\n"


def _ends(statements: Iterable[ast.AST]) -> Iterator[ast.Break | ast.Continue]:
    """Yield the statements that end a step of the loop with these statements."""
    for each in statements:
        if isinstance(each, ast.Break | ast.Continue):
            yield each
        elif isinstance(each, ast.For | ast.While):
            yield from _ends(each.orelse)
        elif isinstance(each, ast.If | ast.With | ast.Try | ast.ExceptHandler | ast.Match | ast.match_case):
            yield from _ends(ast.iter_child_nodes(each))


def _is_plain(source: SourceEditor, loop: ast.While | ast.For, end: ast.stmt) -> bool:
    """Return whether a statement is alone on its line, and what is around it in a loop only decides."""
    around = (each for each in ast.walk(loop) if isinstance(each, ast.With | ast.Try))
    is_alone = source.text.splitlines()[end.lineno - 1].startswith(f"{indentation(end)}break")
    return is_alone and all(end not in ast.walk(each) for each in around)


def _keep_pace(source: SourceEditor, callback: ast.FunctionDef, pauses: list[ast.stmt]) -> ast.stmt | None:
    """Give a callback's timer the period of the pauses, where the source tells both as numbers.

    Returns the statement that makes a rate only for these pauses, which is removed.
    """
    match pauses, _timers_of(source, callback):
        case [ast.Expr(value=ast.Call(func=ast.Attribute(value=rate), args=[]))], [timer]:
            uses = [each for each in source.nodes(ast.expr) if ast.unparse(each) == ast.unparse(rate)]
            made = [each for each in source.nodes(ast.Assign) if each.targets[0] in uses]
            match [each.value for each in made]:
                case [ast.Call(args=[ast.Constant() as frequency])] if len(uses) == 2:
                    source.replace(timer.args[0], f"1 / {source.code_of(frequency)}")
                    source.replace_lines(made[0], made[0], "")
                    return made[0]
        case [ast.Expr(value=ast.Call(args=[ast.Constant() as pause]))], [timer]:
            source.replace(timer.args[0], source.code_of(pause))
    return None


def _timers_of(source: SourceEditor, callback: ast.FunctionDef) -> list[ast.Call]:
    name = f"{callback.args.args[0].arg}.{callback.name}"
    made = (each for each in source.nodes(ast.Call) if ast.unparse(each.func).endswith(".create_timer"))
    return [each for each in made if name in map(ast.unparse, each.args[1:])]


def _is_endless(test: ast.expr) -> bool:
    return bool(isinstance(test, ast.Constant) and test.value) or ast.unparse(test) == "rclpy.ok()"
