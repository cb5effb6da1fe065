"""Edits of names: of topics and services, and of what a class defines."""

import ast
from collections.abc import Iterable

from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import Function, NotSimpleError, SourceEditor, name_of


def rename(source: SourceEditor, line: int, name: str, new: str) -> None:
    """Change the topic or service of the endpoint that is created at a line, if a string names it."""
    _rename(source, source.around(ast.Call, line), name, new)


def rename_publisher(source: SourceEditor, _line: int, name: str, new: str) -> None:
    """Change the topic of the one publisher that a file creates for it, if a string names it."""
    calls = source.nodes(ast.Call)
    made = (each for each in calls if ast.unparse(each.func).endswith(".create_publisher"))
    _rename(source, made, name, new)


@asked_of_file
def served_at(source: SourceEditor, name: str) -> tuple[str, int]:
    """Return the function that creates a service, or "the program", and the line; "" and 0 for none."""
    functions: list[Function] = [*source.nodes(ast.FunctionDef), *source.nodes(ast.AsyncFunctionDef)]
    for call in source.nodes(ast.Call):
        if ast.unparse(call.func).endswith(".create_service") and _naming(call, name):
            around = [each for each in functions if call in ast.walk(each)]
            return around[-1].name if around else "the program", call.lineno
    return "", 0


@asked_of_file
def made_for(source: SourceEditor, line: int) -> tuple[int, ...]:
    """Return the lines that make the clients for which a line calls ``wait_for_service()``."""
    calls = (each.func for each in source.around(ast.Call, line))
    waits = (each for each in calls if isinstance(each, ast.Attribute) and each.attr == "wait_for_service")
    names = {ast.unparse(each.value) for each in waits}
    made = (each for each in source.nodes(ast.Assign) if names & set(map(ast.unparse, each.targets)))
    return tuple(each.value.lineno for each in made)


@asked_of_file
def asked_within(source: SourceEditor, first: int, last: int, made: int) -> int:
    """Return the only line from one to another that calls the client which a line makes; 0 for none."""
    makes = (each for each in source.nodes(ast.Assign) if each.value.lineno == made)
    names = {f"{ast.unparse(target)}.{way}" for each in makes for target in each.targets for way in _ASKS}
    calls = (each for each in source.nodes(ast.Call) if first <= each.lineno <= last)
    lines = {each.lineno for each in calls if ast.unparse(each.func) in names}
    return lines.pop() if len(lines) == 1 else 0


_ASKS = ("call", "call_async")


def _rename(source: SourceEditor, calls: Iterable[ast.Call], name: str, new: str) -> None:
    texts = [each for call in calls for each in _naming(call, name)]
    if len(texts) != 1:
        raise NotSimpleError
    quote = source.code_of(texts[0])[-1]
    is_relative = texts[0].value != name and name.rpartition("/")[0] == new.rpartition("/")[0]
    source.replace(texts[0], f"{quote}{new.rpartition('/')[2] if is_relative else new}{quote}")


def _naming(call: ast.Call, name: str) -> list[ast.Constant]:
    """Return the strings among a call's arguments that may be the name of a topic or service."""
    arguments = (*call.args, *(each.value for each in call.keywords))
    texts = (each for each in arguments if isinstance(each, ast.Constant) and isinstance(each.value, str))
    return [each for each in texts if each.value in (name, name.rpartition("/")[2], name[1:])]


def rename_definition(source: SourceEditor, line: int, is_taken: bool) -> None:
    """Begin the name of a method or class attribute that a line defines with ``my_``, and all its uses.

    Not that of a method which the file hands over as a callback, unless the name ``is_taken`` for sure.
    """
    names = [
        each.targets[0] if isinstance(each, ast.Assign) else name_of(each)
        for owner in source.nodes(ast.ClassDef)
        for each in owner.body
        if each.lineno == line and isinstance(each, ast.Assign | ast.FunctionDef | ast.AsyncFunctionDef)
    ]
    if len(names) != 1 or not isinstance(names[0], ast.Name):
        raise NotSimpleError
    handed_over = {ast.unparse(each) for call in source.nodes(ast.Call) for each in call.args}
    if not is_taken and f"self.{names[0].id}" in handed_over:
        raise NotSimpleError
    source.insert_before(names[0], "my_")
    for used in source.nodes(ast.Attribute):
        if used.attr == names[0].id and ast.unparse(used.value) == "self":
            source.replace(used, f"self.my_{used.attr}")
