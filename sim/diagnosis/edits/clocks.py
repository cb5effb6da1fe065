"""Questions and edits of programs that keep times of a simulated clock."""

import ast

from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import NotSimpleError, SourceEditor, indentation

_JUMP = """
{blanks}self.jumps = self.get_clock().create_jump_callback(
{blanks}    JumpThreshold(
{blanks}        min_forward=None, min_backward=Duration(nanoseconds=-1), on_clock_change=False
{blanks}    ),
{blanks}    post_callback=self.on_jump,
{blanks})

{outer}def on_jump(self, jump):
"""
_SHIFT = """{blanks}if self.{name} is not None:
{blanks}    self.{name} += jump.delta
"""


@asked_of_file
def kept_at(source: SourceEditor, name: str) -> int:
    """Return the first line that gives the attribute of a node a time, and not None; 0 for none."""
    lines = (each.lineno for each in _assignments(source, name) if not _is_none(each))
    return min(lines, default=0)


def follow_jumps(source: SourceEditor, line: int, *names: str) -> None:
    """Set these attributes of the class at a line back when its clock is, by a jump callback."""
    owner = source.owner_of(source.function_at(line))
    methods = [] if owner is None else [each for each in owner.body if isinstance(each, ast.FunctionDef)]
    begin = next((each for each in methods if each.name == "__init__"), None)
    if begin is None or ".jumps" in source.text or "on_jump" in source.text:
        raise NotSimpleError
    inside = source.nodes(ast.stmt, begin)
    if not all(any(each in inside for each in _assignments(source, name)) for name in names):
        raise NotSimpleError
    last, outer = begin.body[-1], indentation(begin)
    blanks = indentation(last)
    code = f"{blanks}{source.code_of(last)}{source.comment_behind(last)}"
    code += _JUMP.format(blanks=blanks, outer=outer)
    source.replace_lines(
        last, last, code + "".join(_SHIFT.format(blanks=blanks, name=each) for each in names)
    )
    source.import_names("rclpy.duration", ["Duration"])
    source.import_names("rclpy.clock", ["JumpThreshold"])  # what is inserted last at a place comes first


def _assignments(source: SourceEditor, name: str) -> list[ast.Assign | ast.AnnAssign]:
    found: list[ast.Assign | ast.AnnAssign] = [*source.nodes(ast.Assign), *source.nodes(ast.AnnAssign)]
    return [each for each in found if f"self.{name}" in map(ast.unparse, _targets(each))]


def _targets(statement: ast.Assign | ast.AnnAssign) -> list[ast.expr]:
    return statement.targets if isinstance(statement, ast.Assign) else [statement.target]


def _is_none(statement: ast.Assign | ast.AnnAssign) -> bool:
    value = statement.value
    return value is None or (isinstance(value, ast.Constant) and value.value is None)
