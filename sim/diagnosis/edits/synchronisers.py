"""Edits of where a program makes a synchroniser of ``message_filters``."""

import ast

from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor

_EXACT, _APPROXIMATE = "TimeSynchronizer", "ApproximateTimeSynchronizer"


def allow_slop(source: SourceEditor, line: int, slop: str) -> None:
    """Let the synchroniser that is made at a line take stamps that are less than ``slop`` seconds apart."""
    made = _made_at(source, line)
    given = [*made.args[2:3], *(each.value for each in made.keywords if each.arg == "slop")]
    if given:
        source.replace(given[0], slop)
        return
    source.replace(made.func, source.code_of(made.func).replace(_EXACT, _APPROXIMATE))
    if isinstance(made.func, ast.Name):
        source.import_names("message_filters", [_APPROXIMATE], instead_of=_EXACT)
    arguments = [*made.args, *(each.value for each in made.keywords)]
    source.insert_behind(max(arguments, key=lambda each: (each.lineno, each.col_offset)), f", slop={slop}")


def lengthen_queues(source: SourceEditor, line: int) -> None:
    """Let the synchroniser that is made at a line keep ten times as many messages of each topic."""
    made = _made_at(source, line)
    size = next((each.value for each in made.keywords if each.arg == "queue_size"), made.args[-1])
    if made.args[1:2]:
        size = made.args[1]
    if not isinstance(size, ast.Constant) or not isinstance(size.value, int):
        raise NotSimpleError
    source.replace(size, str(10 * size.value))


def _made_at(source: SourceEditor, line: int) -> ast.Call:
    made = source.call_at(line, (_EXACT, _APPROXIMATE).__contains__)
    if not made.args:
        raise NotSimpleError
    return made
