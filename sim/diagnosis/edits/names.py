"""Edits of the names of topics and services."""

import ast

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor


def rename(source: SourceEditor, line: int, name: str, new: str) -> None:
    """Change the topic or service of the endpoint that is created at a line, if a string names it."""
    texts = [
        argument
        for call in source.nodes(ast.Call)
        if call.lineno <= line <= (call.end_lineno or 0)
        for argument in (*call.args, *(each.value for each in call.keywords))
        if isinstance(argument, ast.Constant)
        and isinstance(argument.value, str)
        and argument.value in (name, name.rpartition("/")[2], name[1:])
    ]
    if len(texts) != 1:
        raise NotSimpleError
    quote = source.code_of(texts[0])[-1]
    is_relative = texts[0].value != name and name.rpartition("/")[0] == new.rpartition("/")[0]
    source.replace(texts[0], f"{quote}{new.rpartition('/')[2] if is_relative else new}{quote}")
