"""Edits of names: of topics and services, and of what a class defines."""

import ast
from collections.abc import Iterable

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, name_of


def rename(source: SourceEditor, line: int, name: str, new: str) -> None:
    """Change the topic or service of the endpoint that is created at a line, if a string names it."""
    calls = (each for each in source.nodes(ast.Call) if each.lineno <= line <= (each.end_lineno or 0))
    _rename(source, calls, name, new)


def rename_publisher(source: SourceEditor, _line: int, name: str, new: str) -> None:
    """Change the topic of the one publisher that a file creates for it, if a string names it."""
    calls = source.nodes(ast.Call)
    made = (each for each in calls if ast.unparse(each.func).endswith(".create_publisher"))
    _rename(source, made, name, new)


def _rename(source: SourceEditor, calls: Iterable[ast.Call], name: str, new: str) -> None:
    texts = [
        argument
        for call in calls
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


def rename_definition(source: SourceEditor, line: int) -> None:
    """Begin the name of a method or class attribute that a line defines with ``my_``, and all its uses."""
    names = [
        each.targets[0] if isinstance(each, ast.Assign) else name_of(each)
        for owner in source.nodes(ast.ClassDef)
        for each in owner.body
        if each.lineno == line and isinstance(each, ast.Assign | ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    if len(names) != 1 or not isinstance(names[0], ast.Name):
        raise NotSimpleError
    source.insert_before(names[0], "my_")
    for used in source.nodes(ast.Attribute):
        if used.attr == names[0].id and ast.unparse(used.value) == "self":
            source.replace(used, f"self.my_{used.attr}")
