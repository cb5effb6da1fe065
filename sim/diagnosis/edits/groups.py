"""Edits of the callback group of what a program makes."""

import ast

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor

_GROUP = "MutuallyExclusiveCallbackGroup"


def give_own_group(source: SourceEditor, *lines: int) -> None:
    """Give what is made at each of the lines, such as a timer, a callback group of its own."""
    for made in {_made_at(source, line) for line in lines}:
        values = [*made.args, *(each.value for each in made.keywords)]
        given = [each.value for each in made.keywords if each.arg == "callback_group"]
        if ast.unparse(made.func).endswith("create_timer"):
            given += made.args[2:3]
        if given:
            source.replace(given[0], f"{_GROUP}()")
        else:
            last = max(values, key=lambda each: (each.lineno, each.col_offset))
            source.insert_behind(last, f", callback_group={_GROUP}()")
    source.import_names("rclpy.callback_groups", [_GROUP])


def _made_at(source: SourceEditor, line: int) -> ast.Call:
    made = [
        call
        for call in source.nodes(ast.Call)
        if call.lineno <= line <= (call.end_lineno or 0) and _makes(ast.unparse(call.func))
    ]
    if len(made) != 1:
        raise NotSimpleError
    return made[0]


def _makes(function: str) -> bool:
    name = function.rpartition(".")[2]
    return name.startswith("create_") or name in ("ActionServer", "ActionClient")
