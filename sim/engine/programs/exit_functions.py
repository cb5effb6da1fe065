"""Exit functions of programs (``atexit``): those of one of several programs run when that program ends."""

import atexit
import sys
from collections.abc import Callable, Mapping
from types import FrameType, SimpleNamespace
from typing import Any

from sim.probes import own_code
from sim.ros.middleware.process import current_process, process_local

_ExitCall = tuple[Callable[..., object], tuple[Any, ...], Mapping[str, Any]]


def share_exit_functions() -> None:
    """Keep the exit functions of several programs apart, for ``run_exit_functions``. Call it once.

    All others run at the end of the run: those of an only program, of Python's and installed modules, and
    those registered during an import.
    """
    register, unregister = atexit.register, atexit.unregister

    def register_here(function: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Callable[..., Any]:
        if current_process().number == 0 or _serves_all(sys._getframe(1)):
            return register(function, *args, **kwargs)
        if not callable(function):
            raise TypeError("the first argument must be callable")
        process_local(_calls).append((function, args, kwargs))
        return function

    def unregister_here(function: Callable[..., Any]) -> None:
        own = process_local(_calls)
        own[:] = [call for call in own if call[0] != function]
        unregister(function)

    atexit.register = register_here
    atexit.unregister = unregister_here


def run_exit_functions() -> None:
    """Run those of the calling thread's program, the last first; report their exceptions."""
    own = process_local(_calls)
    while own:
        function, args, kwargs = own.pop()
        try:
            function(*args, **kwargs)
        except (Exception, SystemExit, KeyboardInterrupt) as error:  # noqa: BLE001 -- as under CPython
            _tell(error, function)


def _calls() -> list[_ExitCall]:
    return []


def _serves_all(caller: FrameType) -> bool:
    if own_code.is_library(caller) or not own_code.is_own(caller):
        return True
    return any(own_code.module_root(frame) == "importlib" for frame in own_code.outwards(caller))


def _tell(error: BaseException, function: Callable[..., object]) -> None:
    unraisable: Any = SimpleNamespace(
        exc_type=type(error),
        exc_value=error,
        exc_traceback=error.__traceback__,
        err_msg="Exception ignored in an exit function",
        object=function,
    )
    sys.unraisablehook(unraisable)
