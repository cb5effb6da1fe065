"""Questions and edits of programs that look transforms up."""

import ast

from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor


@asked_of_file
def looks_up(source: SourceEditor, line: int) -> bool:
    """Return whether the function around a line asks for transforms; True if there is no such function."""
    try:
        names = {each.attr for each in source.nodes(ast.Attribute, source.function_at(line))}
    except NotSimpleError:
        return True
    return any(each.startswith(("lookup_transform", "can_transform")) for each in names)


def ask_for_newest(source: SourceEditor, line: int) -> None:
    """Ask at a line for the newest transform there is, without waiting for a later one."""
    for each in source.nodes(ast.Call, source.statement_at(line)):
        match each:
            case ast.Call(func=ast.Attribute(attr="lookup_transform"), args=[_, _, time, *timeout]):
                last = each.keywords[-1].value if each.keywords else (timeout or [time])[-1]
                source.replace(time, "Time()")
                if last is not time:
                    source.cut_behind(time, last)
                source.import_names("rclpy.time", ["Time"])
                return
    raise NotSimpleError
