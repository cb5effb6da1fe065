"""Runs a learner's file as ``python FILE ARGS`` would, and describes in one sentence how it ended."""

from __future__ import annotations

import ast
import importlib.util
import inspect
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from sim.engine.failures.advice import misplaced, never_spun
from sim.engine.failures.failure import Failure, failure, place_of
from sim.engine.programs.ending import run_thread_exit_functions
from sim.engine.programs.source import NothingToRunError, compiled, edited, read_source
from sim.engine.stdio.output import finish_lines
from sim.interpreter.exception_text import error_line
from sim.ros.context.signals import deliver_sigint
from sim.ros.middleware.process import Process, current_process, process_of

if TYPE_CHECKING:
    from sim.launch import ProcessSpec
    from sim.packages import Executable

STOPPED = "it was stopped"
"""The sentence on a program that was asked to end."""

_INTERRUPTED = -signal.SIGINT
"""The exit code that others see: Python ends itself by the signal of a KeyboardInterrupt nobody takes."""


@dataclass(frozen=True, slots=True)
class ProgramSpec:
    """What to run: the file ``path`` as a script, or ``function`` of the module ``module``.

    ``folder`` is where imports look first. ``arguments`` follow the program's own name.
    """

    path: str
    folder: str
    arguments: tuple[str, ...] = ()
    module: str = ""
    function: str = ""


def script(path: str, arguments: tuple[str, ...] = ()) -> ProgramSpec:
    """Return the program of a file as Python runs it: the target of a link imports from its own folder."""
    return ProgramSpec(path, str(Path(path).resolve().parent), arguments)


def program_of(found: Executable | ProcessSpec, arguments: Sequence[str]) -> ProgramSpec:
    """Return an executable of a package, or a process of a launch, as a program."""
    return ProgramSpec(
        str(found.path), str(found.folder), tuple(arguments), module=found.module, function=found.function
    )


@dataclass(frozen=True, slots=True)
class ProgramOutcome:
    """How a program ended: a sentence, whether it failed, the exit code, and the exception ("" for none).

    ``failure`` has the exception's source line and advice.
    """

    sentence: str
    failed: bool
    status: int = 0
    error: str = ""
    failure: Failure | None = None


def run_program(
    program: ProgramSpec, on_raised: Callable[[ProgramOutcome], None] = lambda _outcome: None
) -> ProgramOutcome:
    """Run a program in this thread, and wait for the threads that it leaves; ``on_raised`` before that.

    If a file only defines ``main``, as a module with an entry point may, ``main`` is called.
    """
    warnings.formatwarning = _as_short_warning
    if program.folder not in sys.path:
        sys.path.insert(0, program.folder)
    outcome = _outcome_of(program)
    if outcome.failure is not None:
        on_raised(outcome)
    if outcome.status == _INTERRUPTED:
        deliver_sigint(current_process())  # ends spins on other threads
    for _ in range(2):  # Ctrl-C while main waits for its threads does not end these
        with suppress(KeyboardInterrupt):
            _join_left_threads()
            break
    finish_lines()
    return outcome


def _outcome_of(program: ProgramSpec) -> ProgramOutcome:
    try:
        status = _status(_load(program)())
        _join_left_threads()
    except SystemExit as exit_:
        return _exited(exit_, program)
    except NothingToRunError as error:
        return ProgramOutcome(str(error), failed=True, status=1)
    except KeyboardInterrupt:
        return ProgramOutcome(STOPPED, failed=False, status=_INTERRUPTED)
    except BaseException as error:  # noqa: BLE001 -- an error of a learner's program ends its run, not the engine
        traceback.print_exception(error)
        told = failure(error, program.path, program.folder)
        return ProgramOutcome(told.sentence, failed=True, status=1, error=error_line(error), failure=told)
    return ProgramOutcome(never_spun(program.path) or _returned(), failed=status != 0, status=status)


def _returned() -> str:
    at = current_process().shut_down_at
    return f"the program returned, as rclpy was shut down ({at})" if at else "the program returned"


def _load(program: ProgramSpec) -> Callable[[], object]:
    """Return the function that runs the program."""
    if program.function:
        source = _source(program)
        names = _namespace(program, program.module)
        exec(compiled(source, program.path), names)
        if not callable(names.get(program.function)):
            missing = f"defines no {program.function}(), which its package names as its entry point"
            raise NothingToRunError(_on_no_entry(program, source, program.function, missing))
        return _entry(program, names[program.function])
    return lambda: _run_script(program)


def _source(program: ProgramSpec) -> str:
    return edited.get(program.path) or read_source(Path(program.path))


def _run_script(program: ProgramSpec) -> object:
    source = _source(program)
    names = _namespace(program, "__main__")
    exec(compiled(source, program.path), names)
    if _starts_itself(source):
        return None
    if not callable(names.get("main")):
        missing = "defines no main() and runs nothing at its top level; add a main() that spins a node"
        raise NothingToRunError(_on_no_entry(program, source, "main", missing))
    return _entry(program, names["main"])()


def _on_no_entry(program: ProgramSpec, source: str, function: str, otherwise: str) -> str:
    name = Path(program.path).name
    found = misplaced(function, source)
    return f"{name}: {found}" if found else f"{name} {otherwise}"


def _entry(program: ProgramSpec, function: Callable[..., object]) -> Callable[[], object]:
    """Return a function if it can be called as an entry point, without arguments."""
    try:
        inspect.signature(function).bind()
    except TypeError as error:
        line = getattr(getattr(function, "__code__", None), "co_firstlineno", 1)
        raise NothingToRunError(
            f"{Path(program.path).name}:{line}: an entry point is called without arguments ({error}); "
            "give each a default, as in main(args=None)"
        ) from None
    return function


def _namespace(program: ProgramSpec, name: str) -> dict[str, Any]:
    """Return the globals of a new module: two programs of one file share nothing."""
    spec = importlib.util.spec_from_file_location(name, program.path)
    assert spec is not None
    module: ModuleType = importlib.util.module_from_spec(spec)
    if name == "__main__":
        module.__spec__ = None
        sys.modules[name] = module
    return vars(module)


def _status(returned: object) -> int:
    """Return the exit code for a value that an entry point returned, as ``sys.exit`` does."""
    return returned if isinstance(returned, int) else 0 if returned is None else 1


def _starts_itself(source: str) -> bool:
    """Return whether the top level of a file does more than import, define and assign."""
    passive = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Assign)
    body = ast.parse(source).body
    return any(not isinstance(each, (*passive, ast.AnnAssign)) and not _is_text(each) for each in body)


def _is_text(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)


def _as_short_warning(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, line: str | None = None
) -> str:
    """Format a warning as Python does, but with the file's name instead of its path."""
    source = f"\n  {line.strip()}" if line else ""
    return f"{Path(filename).name}:{lineno}: {category.__name__}: {message}{source}\n"


def _join_left_threads() -> None:
    process = current_process()
    if process.number == 0:
        run_thread_exit_functions()
        for reference in process.finish_pools:
            finish = reference()
            if finish is not None:
                finish()
    for thread in threads_left_by(current_process()):
        thread.join()


def threads_left_by(process: Process) -> list[threading.Thread]:
    """Return the threads of a process that Python waits for: neither daemons nor the calling one.

    In a run of several programs the threads of a pool end with the run.
    """
    pooled = pooled_threads()
    return [
        each
        for each in threading.enumerate()
        if not each.daemon
        and each is not threading.current_thread()
        and process_of(each) is process
        and (process.number == 0 or each.ident not in pooled)
    ]


def pooled_threads() -> set[int | None]:
    """Return the identifiers of the worker threads of all thread pools."""
    pools = sys.modules.get("concurrent.futures.thread")
    return {each.ident for each in getattr(pools, "_threads_queues", ())}


def _exited(exit_: SystemExit, program: ProgramSpec) -> ProgramOutcome:
    if exit_.code in {None, 0}:
        return ProgramOutcome("the program returned", failed=False)
    found = place_of(exit_, program.path, program.folder)
    place = f" ({found})" if found else ""
    if isinstance(exit_.code, int):
        sentence = f"the program ended with exit code {exit_.code}{place}"
        return ProgramOutcome(sentence, failed=True, status=exit_.code)
    return ProgramOutcome(f"the program ended: {exit_.code}{place}", failed=True, status=1)
