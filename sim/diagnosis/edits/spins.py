"""Calls of ``spin()`` that spin less than was meant, and the edits that mend them."""

import ast
from collections.abc import Collection, Iterator
from typing import Any

from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, indentation

_ENTITIES = ("create_timer", "create_subscription", "create_service", "create_client")


def spins_in_turn(file: str) -> tuple[int, ...]:
    """Return the lines of ``spin()`` in turn, if a file has such in one place only, else ()."""
    return tuple(each.lineno for each in _read(file)[1])


def never_made(file: str, made: Collection[int]) -> list[str]:
    """Return the classes of nodes that only a ``spin(Name())`` after another makes, and that made no entity.

    ``made`` are the lines of the file at which entities were made; if it has no such lines, it has been
    changed since, and nothing is known.
    """
    source, spins = _read(file)
    nodes = [argument for spin in spins[1:] for argument in getattr(spin.value, "args", ())]
    names = {ast.unparse(each.func) for each in nodes if isinstance(each, ast.Call)}
    if not names or not all(_makes(source, source.tree, [line]) for line in made):
        return []
    classes = [each for each in source.nodes(ast.ClassDef) if each.name in names]
    return [each.name for each in classes if _makes(source, each) and not _makes(source, each, made)]


def _makes(source: SourceEditor, part: ast.AST, lines: Collection[int] | None = None) -> bool:
    """Return whether a part of a source makes an entity, at one of the lines if some are given."""
    calls = source.nodes(ast.Call, part)
    makers = [each for each in calls if ast.unparse(each.func).rpartition(".")[2] in _ENTITIES]
    at = {line for each in makers for line in range(each.lineno, (each.end_lineno or 0) + 1)}
    return bool(at if lines is None else at.intersection(lines))


@asked_of_file
def _read(source: SourceEditor) -> tuple[SourceEditor, list[ast.Expr]]:
    """Return a source, and its statements that spin in turn if they are in one place only."""
    found = _spins_in_turn(source)
    return source, found[0] if len(found) == 1 else []


@asked_of_file
def taken_away(source: SourceEditor, line: int) -> tuple[int, str, str, str]:
    """Return the line of the ``add_node`` that takes a node from the executor that was given it before.

    With the node and both executors, as the source has them; (0, "", "", "") for none. The node is of the
    class that is around ``line``, if one is.
    """
    around = [each.name for each in source.nodes(ast.ClassDef) if line in _lines(each)]
    makers = {ast.unparse(target): made for target, made in _assigned(source)}
    for body in _bodies(source):
        given: dict[str, str] = {}
        for statement in body:
            match statement:
                case ast.Expr(value=ast.Call(func=ast.Attribute(value=by, attr="add_node"), args=[added])):
                    node, executor = ast.unparse(added), ast.unparse(by)
                    is_meant = not around or makers.get(node, "") in around
                    if is_meant and given.setdefault(node, executor) != executor:
                        return statement.lineno, node, given[node], executor
                case ast.Expr(value=ast.Call(func=ast.Attribute(attr="remove_node"), args=[removed])):
                    given.pop(ast.unparse(removed), None)
    return 0, "", "", ""


@asked_of_file
def started_late(source: SourceEditor) -> tuple[int, int]:
    """Return the lines of a ``spin()``, and behind it that of the start of a thread that spins; or zeros."""
    threads = {
        ast.unparse(each.targets[0])
        for each in source.nodes(ast.Assign)
        if isinstance(each.value, ast.Call) and any(_is_spin(part) for part in each.value.keywords)
    }
    for body in _bodies(source):
        spins = [each for each in body if _spins(each, _spinning(source))]
        for statement in body if spins else ():
            match statement:
                case ast.Expr(value=ast.Call(func=ast.Attribute(value=thread, attr="start"))):
                    if ast.unparse(thread) in threads and statement.lineno > spins[0].lineno:
                        return spins[0].lineno, statement.lineno
    return 0, 0


@asked_of_file
def spun_in_threads(source: SourceEditor) -> tuple[int, ...]:
    """Return the lines that make threads whose function is one that spins."""
    makers = (each for each in source.nodes(ast.Call) if any(map(_is_spin, each.keywords)))
    return tuple(each.lineno for each in makers)


def _is_spin(part: ast.keyword) -> bool:
    return part.arg == "target" and ast.unparse(part.value).rpartition(".")[2] == "spin"


def _lines(part: ast.stmt) -> range:
    return range(part.lineno, (part.end_lineno or 0) + 1)


def _assigned(source: SourceEditor) -> Iterator[tuple[ast.expr, str]]:
    """Yield what calls are assigned to, one by one, with the functions that are called."""
    for each in source.nodes(ast.Assign):
        pairs = [(each.targets[0], each.value)]
        if isinstance(each.targets[0], ast.Tuple) and isinstance(each.value, ast.Tuple):
            pairs = list(zip(each.targets[0].elts, each.value.elts, strict=False))
        for target, value in pairs:
            if isinstance(value, ast.Call):
                yield target, ast.unparse(value.func)


def spin_together(source: SourceEditor, line: int) -> None:
    """Spin all nodes that are spun in turn, first at a line, by one executor there.

    Only if each is spun by ``rclpy.spin(node)``, or each by an executor; the first of these gets all nodes.
    """
    spins = next((each for each in _spins_in_turn(source) if each[0].lineno == line), [])
    calls = [each.value for each in spins if isinstance(each.value, ast.Call)]
    nodes = [source.code_of(argument) for each in calls for argument in each.args]
    if nodes and len(nodes) == len(spins):
        names = {each.id for each in source.nodes(ast.Name)}
        executor = next(each for each in ("executor", "one_executor") if each not in names)
        lines = [f"{executor} = SingleThreadedExecutor()"]
        lines += [*(f"{executor}.add_node({each})" for each in nodes), f"{executor}.spin()"]
        blank = indentation(spins[0])
        source.replace_lines(spins[0], spins[0], "".join(f"{blank}{each}\n" for each in lines))
        source.import_names("rclpy.executors", ["SingleThreadedExecutor"])
    elif not nodes and spins:
        first, *others = (ast.unparse(each.func).removesuffix(".spin") for each in calls)
        for adding in source.nodes(ast.Attribute):
            if adding.attr == "add_node" and ast.unparse(adding.value) in others:
                source.replace(adding.value, first)
    else:
        raise NotSimpleError
    for each in spins[1:]:
        source.replace_lines(each, each, "")


def spin_beside(source: SourceEditor, line: int) -> None:
    """Spin the node of a rate that sleeps in a loop at a line in a thread that begins before the loop.

    Only if the rate is an attribute of the node, or an assignment tells whose rate it is.
    """
    around = [each for each in source.around(ast.stmt, line) if isinstance(each, ast.While | ast.For)]
    makers = {
        ast.unparse(each.targets[0]): each.value.func.value
        for each in source.nodes(ast.Assign)
        if isinstance(each.value, ast.Call) and isinstance(each.value.func, ast.Attribute)
        if each.value.func.attr == "create_rate"
    }
    match source.statement_at(line):
        case ast.Expr(value=ast.Call(func=ast.Attribute(value=rate, attr="sleep"))) if around:
            node = makers.get(ast.unparse(rate)) or getattr(rate, "value", None)
            if node is not None:
                _start_spinning(source, source.code_of(node), around[0])
                return
    raise NotSimpleError


def spin_node_beside(source: SourceEditor, line: int) -> None:
    """Spin the only node that a program makes, and spins nowhere, in a thread that begins before a loop."""
    loops = [each for each in source.nodes(ast.While) if each.lineno == line]
    kinds = {each.name for each in source.nodes(ast.ClassDef) if "Node" in map(_last_name, each.bases)}
    made = [
        each
        for each in source.nodes(ast.Assign)
        if isinstance(each.value, ast.Call) and _last_name(each.value.func) in {"Node", "create_node", *kinds}
    ]
    spins = any("spin" in _last_name(each.func) for each in source.nodes(ast.Call))
    if spins or not loops or len(made) != 1 or not isinstance(made[0].targets[0], ast.Name):
        raise NotSimpleError
    where, there = (source.around(ast.FunctionDef, each) for each in (line, made[0].lineno))
    if where != there or made[0].lineno > line:
        raise NotSimpleError
    _start_spinning(source, made[0].targets[0].id, loops[0])


def _last_name(expression: ast.expr) -> str:
    return ast.unparse(expression).rpartition(".")[2]


def _start_spinning(source: SourceEditor, node: str, before: ast.stmt) -> None:
    spins = f"Thread(target=rclpy.spin, args=({node},), daemon=True).start()"
    source.insert_before(before, f"{spins}\n{indentation(before)}")
    source.import_names("threading", ["Thread"])


@asked_of_file
def spin_past(source: SourceEditor) -> tuple[int, str]:
    """Return the line of the first ``rclpy.spin(node)`` that spins past the executor that was given the node.

    With that executor, as the source has it; (0, "") if there is none. The source has to show that nothing
    else can spin the executor: it is not handed on.
    """
    attributes = [each for each in source.nodes(ast.Attribute) if isinstance(each.ctx, ast.Load)]
    of_what = {each.value: each.attr for each in attributes}
    members: dict[str, set[str]] = {}
    for part in source.nodes(ast.expr):
        if isinstance(part, ast.Name | ast.Attribute) and isinstance(part.ctx, ast.Load):
            members.setdefault(ast.unparse(part), set()).add(of_what.get(part, ""))
    calls = [(each, ast.unparse(each.func)) for each in source.nodes(ast.Call) if len(each.args) == 1]
    having = {
        ast.unparse(call.args[0]): name.removesuffix(".add_node")
        for call, name in calls
        if name.endswith(".add_node") and members.get(name.removesuffix(".add_node"), {""}) <= _SPIN_NOTHING
    }
    for call, name in calls:
        if name in _SPIN_OF_NODE and not call.keywords and ast.unparse(call.args[0]) in having:
            return call.lineno, having[ast.unparse(call.args[0])]
    return 0, ""


_SPIN_OF_NODE = ("rclpy.spin", "spin")
_SPIN_NOTHING = {"add_node", "remove_node", "get_nodes", "wake", "shutdown"}


def spin_executor(source: SourceEditor, line: int, executor: str) -> None:
    """Spin an executor in place of the ``rclpy.spin(node)`` at a line."""
    match source.statement_at(line):
        case ast.Expr(value=ast.Call(func=function) as call) if ast.unparse(function) in _SPIN_OF_NODE:
            source.replace(call, f"{executor}.spin()")
        case _:
            raise NotSimpleError


def _spins_in_turn(source: SourceEditor) -> list[list[ast.Expr]]:
    """Return the statements that spin, if a body has several, for each such body."""
    spinning = _spinning(source)
    spins = ([each for each in body if _spins(each, spinning)] for body in _bodies(source))
    return [each for each in spins if len(each) > 1]


def _spinning(source: SourceEditor) -> set[str]:
    """Return the functions that spin: rclpy's, and those of the executors that a source assigns."""
    executors = (ast.unparse(target) for target, maker in _assigned(source) if maker.endswith("Executor"))
    return {*_SPIN_OF_NODE, *(f"{each}.spin" for each in executors)}


def _bodies(source: SourceEditor) -> Iterator[list[Any]]:
    """Yield the bodies of a source: statements that follow each other."""
    for statement in source.nodes(ast.AST):
        for body in (getattr(statement, name, ()) for name in ("body", "orelse", "finalbody")):
            if isinstance(body, list):
                yield body


def _spins(statement: ast.stmt, spinning: set[str]) -> bool:
    match statement:
        case ast.Expr(value=ast.Call(func=function, args=arguments, keywords=[])):
            is_rclpys = ast.unparse(function) in _SPIN_OF_NODE
            return ast.unparse(function) in spinning and len(arguments) == is_rclpys
    return False


@asked_of_file
def loop_of_spin_once(source: SourceEditor) -> int:
    """Return the line of the loop that calls ``spin_once()``; 0 if a file has several such, or none."""
    calls = [each for each in source.nodes(ast.Call) if _last_name(each.func) == "spin_once"]
    loops = {loop.lineno for each in calls for loop in source.around(ast.While, each.lineno)[-1:]}
    return loops.pop() if len(loops) == 1 else 0


@asked_of_file
def starving_loop(source: SourceEditor) -> tuple[int, str, tuple[str, ...]]:
    """Return the line and function of the loop of a coroutine that spins and never awaits, and the others.

    Only if nothing else in the file spins, and there are other coroutines; else (0, "", ()).
    """
    functions = source.nodes(ast.AsyncFunctionDef)
    calls = [each for each in source.nodes(ast.Call) if isinstance(each.func, ast.Attribute)]
    spins = [each for each in calls if ast.unparse(each.func).rpartition(".")[2].startswith("spin")]
    for function in functions if len(spins) == 1 and len(functions) > 1 else ():
        for loop in source.nodes(ast.While, function):
            if spins[0] in source.nodes(ast.Call, loop) and not source.nodes(ast.Await, loop):
                others = tuple(each.name for each in functions if each is not function)
                return loop.lineno, function.name, others
    return 0, "", ()


def await_in_loop(source: SourceEditor, line: int) -> None:
    """Let asyncio run its other tasks in each round of the loop at a line."""
    loop = source.statement_at(line)
    names = {name.asname or name.name for each in source.nodes(ast.Import) for name in each.names}
    if not isinstance(loop, ast.While) or "asyncio" not in names:
        raise NotSimpleError
    source.insert_behind(loop.body[-1], f"\n{indentation(loop.body[-1])}await asyncio.sleep(0)")
