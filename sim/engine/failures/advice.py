"""Advice to a learner whose program failed or did nothing, as a clause."""

import ast
import builtins
import linecache
import re
import sys
from collections.abc import Iterable
from difflib import get_close_matches
from types import FrameType, ModuleType

from sim.engine.failures.missing_names import on_missing_name, on_newer
from sim.ros.exceptions import NotInitializedException, ParameterNotDeclaredException
from sim.ros.middleware.process import current_process


def advice_on(error: BaseException, frame: FrameType | None) -> str:
    """Return advice on an exception that was raised in ``frame``; empty where its text is enough."""
    match error:
        case ModuleNotFoundError(name=str(name)):
            from sim.engine.failures.missing import on_missing

            advice = on_newer(name) or on_missing(name)
        case ImportError(name=str(module), msg=str(text)) if module in sys.modules:
            missing = text.split("'")[1]
            advice = on_missing_name(module, missing) or _nearest(missing, dir(sys.modules[module]))
        case NameError(name=str(name)) if frame is not None:
            advice = _misplaced_in(frame, name) or _unimported(name) or _nearest(name, _names_of(frame))
        case AttributeError(name=str(name), obj=ModuleType() as module):
            advice = on_missing_name(module.__name__, name) or _nearest(name, dir(module))
        case AttributeError(name=str(name), obj=obj):
            advice = on_newer(name) or _on_unready_node(name, obj) or _nearest(name, dir(obj))
        case TypeError(args=[str(text)]) if "unexpected keyword argument '" in text:
            advice = on_newer(text.split("'")[-2])
        case ParameterNotDeclaredException() if frame is not None:
            advice = _nearest(str(error).rpartition(": ")[2], _parameters_of(frame.f_locals.get("self")))
        case NotInitializedException():
            advice = "call rclpy.init() before the first node is made, at the beginning of main()"
        case _ if type(error).__module__ == "_curses":
            advice = "curses draws on a whole terminal, which no run has; print, and read keys with termios"
        case _:
            advice = ""
    return advice


def _on_unready_node(attribute: str, obj: object) -> str:
    from sim.ros.node.node import Node

    if attribute.startswith("_") and isinstance(obj, Node) and "_agenda" not in vars(obj):
        return f"{type(obj).__name__}.__init__ has to call super().__init__('name of the node') first"
    return ""


def _parameters_of(node: object) -> Iterable[str]:
    from sim.ros.node.node import Node

    return node.get_parameters_by_prefix("") if isinstance(node, Node) else ()


def _nearest(name: str, known: Iterable[str]) -> str:
    close = get_close_matches(name, [each for each in known if not each.startswith("_")], n=1, cutoff=0.7)
    return f"did you mean {close[0]!r}?" if close else ""


def _unimported(name: str) -> str:
    """Return advice on a class of rclpy that the program has not imported."""
    homes = {}
    for module, known in [*sys.modules.items()]:
        found = getattr(known, "__dict__", {}).get(name)
        if re.fullmatch(r"rclpy\.[a-z]\w*", module) and isinstance(found, type):
            homes[module] = found.__module__.rpartition(".")[2] != module.rpartition(".")[2], len(module)
    return f"write from {min(homes, key=homes.__getitem__)} import {name}" if homes else ""


def _names_of(frame: FrameType) -> list[str]:
    return [*frame.f_locals, *frame.f_globals, *dir(builtins)]


def _misplaced_in(frame: FrameType, name: str) -> str:
    """Return advice on a function that is in a class of the frame's module instead of the module."""
    for owner in frame.f_globals.values():
        function = vars(owner).get(name) if isinstance(owner, type) else None
        code = getattr(function, "__code__", None)
        if code is not None and code.co_filename == frame.f_code.co_filename:
            return _misplaced(name, code.co_firstlineno, owner.__name__)
    return ""


def misplaced(name: str, source: str) -> str:
    """Return advice on a function that is inside a class of a file; empty if there is none."""
    for owner in ast.parse(source).body:
        if isinstance(owner, ast.ClassDef):
            for each in owner.body:
                if isinstance(each, ast.FunctionDef) and each.name == name:
                    return _misplaced(name, each.lineno, owner.name)
    return ""


def _misplaced(name: str, line: int, owner: str) -> str:
    return f"the {name}() of line {line} is indented into the class {owner}; move it to the left margin"


def never_spun(path: str) -> str:
    """Return advice if the calling thread's program created callbacks and never spun; else an empty text."""
    process = current_process()
    if process.callbacks == 0 or process.spins > 0:
        return ""
    if any(map(_SPINS.match, linecache.getlines(path))):
        return (
            "the program returned without coming to its spin(), so none of its callbacks ran; "
            "an exception may have been caught on the way"
        )
    return "the program returned without spinning, so none of its callbacks ran; end it with rclpy.spin(node)"


_SPINS = re.compile(r"[^#]*\bspin(_once|_until_future_complete)?\(")
