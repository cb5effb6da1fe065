"""Runs a learner's file as ``python FILE ARGS`` would, and tells in one sentence how it ended."""

import ast
import importlib.util
import sys
import threading
import traceback
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

from sim.clock import Stopped
from sim.engine.advice import advice_on, silence
from sim.engine.output import ProcessStream

_INTERRUPTED = 130


@dataclass(frozen=True, slots=True)
class Program:
    """What to run: the file ``path`` as a script, or ``function`` of the module ``module``.

    ``folder`` is where imports look first. ``arguments`` are those behind the program's own name.
    """

    path: str
    folder: str
    arguments: tuple[str, ...] = ()
    module: str = ""
    function: str = ""


class NothingToRunError(Exception):
    """A file that neither does anything nor defines ``main``; the text says which."""


def script(path: str, arguments: tuple[str, ...] = ()) -> Program:
    """The program that a file is, as Python runs it."""
    return Program(path, str(Path(path).parent), arguments)


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a program ended: a sentence, whether that was a failure, and the exit code."""

    sentence: str
    failed: bool
    status: int = 0


def run_program(program: Program) -> Outcome:
    """Run it in this thread, and wait for the threads that it leaves.

    A file that defines ``main`` and does nothing with it, as one for an entry point may, has it called.
    """
    warnings.formatwarning = _as_short_warning
    if program.folder not in sys.path:
        sys.path.insert(0, program.folder)
    outcome = _outcome_of(program)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, ProcessStream):
            stream.finish()
    return outcome


def _outcome_of(program: Program) -> Outcome:
    try:
        status = _status(_load(program)())
        _join_left_threads()
    except SystemExit as exit_:
        return _exited(exit_)
    except NothingToRunError as error:
        return Outcome(f"{error}; add a main(), and call it or not", failed=True, status=1)
    except (KeyboardInterrupt, Stopped):
        return Outcome("it was stopped", failed=False, status=_INTERRUPTED)
    except BaseException as error:  # noqa: BLE001 -- whatever a learner's program raises ends its run, not the engine
        _print_traceback(error, program.path)
        return Outcome(_failure(error, program.path), failed=True, status=1)
    return Outcome(silence() or "the program returned", failed=status != 0, status=status)


def _load(program: Program) -> Callable[[], object]:
    """What has to be called to run the program."""
    if program.function:
        names = _namespace(program, program.module)
        exec(_code(program), names)
        entry: Callable[[], object] = names[program.function]
        return entry
    return lambda: _run_script(program)


def _run_script(program: Program) -> object:
    names = _namespace(program, "__main__")
    exec(_code(program), names)
    if _starts_itself(Path(program.path)):
        return None
    if not callable(names.get("main")):
        name = Path(program.path).name
        raise NothingToRunError(f"{name} defines no main() and runs nothing at its top level")
    return names["main"]()


def _code(program: Program) -> CodeType:
    return compile(Path(program.path).read_bytes(), program.path, "exec", dont_inherit=True)


def _namespace(program: Program, name: str) -> dict[str, Any]:
    """The globals of a module of its own: two programs of one file share nothing."""
    spec = importlib.util.spec_from_file_location(name, program.path)
    assert spec is not None
    module: ModuleType = importlib.util.module_from_spec(spec)
    if name == "__main__":
        module.__spec__ = None
        sys.modules[name] = module
    return vars(module)


def _status(returned: object) -> int:
    """The exit code of a program whose entry point returned that: ``sys.exit`` is called with it."""
    return returned if isinstance(returned, int) else 0 if returned is None else 1


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
    me = threading.current_thread()
    process = getattr(me, "ros_process", None)
    for thread in threading.enumerate():
        if not thread.daemon and thread is not me and getattr(thread, "ros_process", None) is process:
            thread.join()


def _exited(exit_: SystemExit) -> Outcome:
    if exit_.code in {None, 0}:
        return Outcome("the program returned", failed=False)
    if isinstance(exit_.code, int):
        return Outcome(f"the program ended with exit code {exit_.code}", failed=True, status=exit_.code)
    return Outcome(f"the program ended: {exit_.code}", failed=True, status=1)


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
    return f"{place}: the program raised {type(error).__name__}: {error}{advice_on(error)}"
