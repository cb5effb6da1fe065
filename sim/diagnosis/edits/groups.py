"""Edits of the callback group of what a program makes."""

import ast

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor

_GROUP = "MutuallyExclusiveCallbackGroup"


def give_own_group(source: SourceEditor, line: int) -> None:
    """Give what is made at a line, such as a timer, a callback group of its own."""
    made = [
        call
        for call in source.nodes(ast.Call)
        if call.lineno <= line <= (call.end_lineno or 0) and _makes(ast.unparse(call.func))
    ]
    if len(made) != 1:
        raise NotSimpleError
    values = [*made[0].args, *(each.value for each in made[0].keywords)]
    given = [each.value for each in made[0].keywords if each.arg == "callback_group"]
    if ast.unparse(made[0].func).endswith("create_timer"):
        given += made[0].args[2:3]
    if given:
        source.replace(given[0], f"{_GROUP}()")
    else:
        last = max(values, key=lambda each: (each.lineno, each.col_offset))
        source.insert_behind(last, f", callback_group={_GROUP}()")
    source.import_names("rclpy.callback_groups", [_GROUP])


def _makes(function: str) -> bool:
    name = function.rpartition(".")[2]
    return name.startswith("create_") or name in ("ActionServer", "ActionClient")
