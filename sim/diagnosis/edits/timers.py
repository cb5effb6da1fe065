"""Edits of timers that are never due, or always; whether a rate's timer stays, a guard triggers itself."""

import ast

from sim.diagnosis.edits.functions import add_at_end
from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor


def keep_the_fraction(source: SourceEditor, line: int) -> None:
    """Divide by ``/`` in place of ``//`` in what a call at a line gets first."""
    calls = [each for each in source.nodes(ast.Call, source.statement_at(line)) if each.args]
    periods = [each.args[0] for each in calls if isinstance(each.args[0], ast.BinOp)]
    whole = [each for each in periods if isinstance(each.op, ast.FloorDiv)]
    if len(whole) != 1:
        raise NotSimpleError
    source.replace(whole[0], f"{source.code_of(whole[0].left)} / {source.code_of(whole[0].right)}")


@asked_of_file
def triggered_at(source: SourceEditor, made: int, callback: int) -> int:
    """Return the line at which the function of a line triggers the guard that another makes; 0 for none."""
    targets = (each for made_by in source.around(ast.Assign, made) for each in made_by.targets)
    triggers = {f"{ast.unparse(each)}.trigger" for each in targets}
    try:
        calls = source.nodes(ast.Call, source.function_at(callback))
    except NotSimpleError:
        return 0
    return min((each.lineno for each in calls if ast.unparse(each.func) in triggers), default=0)


@asked_of_file
def keeps_rate(source: SourceEditor, line: int) -> bool:
    """Return whether the function around a line makes a rate, and does not destroy it."""
    try:
        calls = source.nodes(ast.Call, source.function_at(line))
    except NotSimpleError:
        return False
    called = {ast.unparse(each.func).rpartition(".")[2] for each in calls}
    return "create_rate" in called and "destroy_rate" not in called


def destroy_rate(source: SourceEditor, line: int) -> None:
    """End the function around a line by destroying the only rate that it makes; it has no ``return``."""
    function = source.function_at(line)
    made = [each for each in function.body if isinstance(each, ast.Assign) and _makes_rate(each)]
    match made:
        case [ast.Assign(targets=[ast.Name(id=rate)], value=ast.Call(func=ast.Attribute(value=node)))]:
            if source.nodes(ast.Return, function) or not isinstance(function, ast.FunctionDef):
                raise NotSimpleError
            add_at_end(source, function, f"{source.code_of(node)}.destroy_rate({rate})")
        case _:
            raise NotSimpleError


def _makes_rate(statement: ast.Assign) -> bool:
    call = statement.value
    return isinstance(call, ast.Call) and ast.unparse(call.func).endswith(".create_rate")


@asked_of_file
def sim_time_set_at(source: SourceEditor) -> int:
    """Return the line of the only call that sets ``use_sim_time`` to ``True``; 0 for none or several."""
    found = _sim_time_on(source)
    return found[0].lineno if len(found) == 1 else 0


@asked_of_file
def sleeps_by_clock_at(source: SourceEditor) -> int:
    """Return the line of the first sleep by the clock of a node; 0 for none."""
    calls = [each for each in source.nodes(ast.Call) if ast.unparse(each.func).endswith(_CLOCK_SLEEPS)]
    return min((each.lineno for each in calls), default=0)


_CLOCK_SLEEPS = (".get_clock().sleep_for", ".get_clock().sleep_until")


def leave_sim_time_off(source: SourceEditor, line: int) -> None:
    """Set ``use_sim_time`` to ``False`` at a line."""
    for each in _sim_time_on(source):
        if each.lineno == line:
            source.replace(each, "False")


def _sim_time_on(source: SourceEditor) -> list[ast.Constant]:
    """Return the ``True`` of each call that names ``use_sim_time`` first."""
    calls = [each for each in source.nodes(ast.Call) if each.args]
    values = [
        value
        for call in calls
        if isinstance(call.args[0], ast.Constant) and call.args[0].value == "use_sim_time"
        for value in (*call.args[1:], *(each.value for each in call.keywords))
    ]
    return [each for each in values if isinstance(each, ast.Constant) and each.value is True]
