"""Runs a learner's file as ``python FILE ARGS`` would, and tells in one sentence how it ended."""

import ast
import runpy
import sys
import threading
import traceback
import warnings
from dataclasses import dataclass
from pathlib import Path

from sim.clock import Stopped


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a program ended."""

    sentence: str
    failed: bool


def run_program(path: str, arguments: tuple[str, ...]) -> Outcome:
    """Run the file in this thread, and wait for the threads that it leaves.

    A file that defines ``main`` and does nothing with it, as one for an entry point may, has it called.
    """
    sys.argv = [path, *arguments]
    warnings.formatwarning = _as_short_warning
    sys.path.insert(0, str(Path(path).parent))
    try:
        names = runpy.run_path(path, run_name="__main__")
        if callable(names.get("main")) and not _starts_itself(Path(path)):
            names["main"]()
        _join_left_threads()
    except SystemExit as exit_:
        return _exited(exit_)
    except (KeyboardInterrupt, Stopped):
        return Outcome("it was stopped", failed=False)
    except BaseException as error:  # noqa: BLE001 -- whatever a learner's program raises ends its run, not the engine
        _print_traceback(error, path)
        return Outcome(_failure(error, path), failed=True)
    return Outcome("the program returned", failed=False)


def _starts_itself(path: Path) -> bool:
    """Whether the file does more at its top level than to import, define and assign."""
    passive = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Assign)
    body = ast.parse(path.read_bytes()).body
    return any(not isinstance(each, (*passive, ast.AnnAssign)) and not _is_text(each) for each in body)


def _is_text(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _as_short_warning(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, line: str | None = None
) -> str:
    """A warning as Python prints it, but with the file's name alone."""
    source = f"\n  {line.strip()}" if line else ""
    return f"{Path(filename).name}:{lineno}: {category.__name__}: {message}{source}\n"


def _join_left_threads() -> None:
    for thread in threading.enumerate():
        if not thread.daemon and thread is not threading.current_thread():
            thread.join()


def _exited(exit_: SystemExit) -> Outcome:
    if exit_.code in {None, 0}:
        return Outcome("the program returned", failed=False)
    if isinstance(exit_.code, int):
        return Outcome(f"the program ended with exit code {exit_.code}", failed=True)
    return Outcome(f"the program ended: {exit_.code}", failed=True)


def _print_traceback(error: BaseException, path: str) -> None:
    """Print the traceback as Python would, from the learner's first frame on."""
    trace = error.__traceback__
    while trace is not None and trace.tb_frame.f_code.co_filename != path:
        trace = trace.tb_next
    traceback.print_exception(type(error), error, trace or error.__traceback__)


def _failure(error: BaseException, path: str) -> str:
    name = Path(path).name
    if isinstance(error, SyntaxError) and error.filename == path:
        return f"{name}:{error.lineno}: {error.msg}"
    line = 0
    for frame, number in traceback.walk_tb(error.__traceback__):
        if frame.f_code.co_filename == path:
            line = number
    place = f"{name}:{line}" if line else name
    return f"{place}: the program raised {type(error).__name__}: {error}"
