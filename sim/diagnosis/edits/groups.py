"""Edits of the callback group of what a program makes."""

import ast

from sim.diagnosis.edits.source_editor import SourceEditor

_GROUP = "MutuallyExclusiveCallbackGroup"


def give_own_group(source: SourceEditor, *lines: int) -> None:
    """Give what is made at each of the lines, such as a timer, a callback group of its own."""
    for made in {source.call_at(line, _makes) for line in lines}:
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


def _makes(name: str) -> bool:
    return name.startswith("create_") or name in ("ActionServer", "ActionClient")
