"""Edits of the values that a program gives to the fields of a message."""

import ast

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor


def write_float(source: SourceEditor, line: int, name: str) -> None:
    """Make what a line gives to a field a float: an integer gets ``.0``, all else goes through ``float``."""
    statement = source.statement_at(line)
    values = [each.value for each in source.nodes(ast.keyword, statement) if each.arg == name]
    if isinstance(statement, ast.Assign) and any(
        isinstance(each, ast.Attribute) and each.attr == name for each in statement.targets
    ):
        values.append(statement.value)
    if len(values) != 1:
        raise NotSimpleError
    code = source.code_of(values[0])
    source.replace(values[0], f"{code}.0" if code.lstrip("-").isdecimal() else f"float({code})")
