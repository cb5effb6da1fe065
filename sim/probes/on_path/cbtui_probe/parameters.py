"""Hooks the setting of parameters, to tell what their callbacks do wrong."""

from __future__ import annotations

import dis
import sys
import threading
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .callbacks import is_own
from .recorder import now
from .unseen import UNSEEN

if TYPE_CHECKING:
    from types import FrameType

    from .recorder import Recorder

_ADVICE = "return the value from a pre-set callback, or refuse what was asked for"
_LOOK = "look at the results that set_parameters() returns"
_SETTERS = ("set_parameters", "set_parameters_atomically")


def watch_parameters(node_class: Any, recorder: Recorder) -> None:
    """Report once each parameter that an on-set callback overrules, that one gives no answer, and refusals.

    A refusal is reported where the program makes nothing of the answer that says so.
    """
    set_all = node_class._set_parameters_atomically_common
    here = threading.local()
    told: set[tuple[int, str]] = set()

    @wraps(set_all)
    def set_known(node: Any, parameters: Any, *args: Any, **kwargs: Any) -> Any:
        outer = getattr(here, "parameters", {})
        own = {(id(node), each.name): each for each in parameters}
        for key in (own.keys() & outer.keys()) - told:
            if node._parameters.get(key[1]) is not outer[key]:  # else it is stored: a post-set callback
                told.add(key)
                problem = _overruled(key[1], sys._getframe(1))
                text = f"{problem}: what was asked for is stored last; {_ADVICE}"
                kind, entity = "overruled", recorder.here.entity
                recorder.put("notice", now(), "WARN", text, entity, False, kind, problem, _ADVICE)
        here.parameters = {**outer, **own}
        try:
            with UNSEEN:
                result = set_all(node, parameters, *args, **kwargs)
        finally:
            here.parameters = outer
        has_answer = result.reason != "Callback returned an invalid type"
        if not has_answer and (key := (id(node), "")) not in told:
            told.add(key)
            problem, advice, place = _unanswered(node._on_set_parameters_callbacks)
            text, entity = f"{problem}; {advice}", recorder.here.entity
            recorder.put("notice", now(), "WARN", text, entity, False, "unanswered", problem, advice, place)
        file, line = ("", 0)
        if has_answer and not result.successful:
            file, line = _makes_nothing_of_it(sys._getframe(1))
        if line and (key := (line, file)) not in told:
            told.add(key)
            names, reason = [each.name for each in parameters], result.reason and f": {result.reason}"
            problem = f"{', '.join(names)} {'was' if len(names) == 1 else 'were'} refused{reason}"
            text = f"{problem} ({Path(file).name}:{line}); {_LOOK}"
            kind, entity = "refusal overlooked", recorder.here.entity
            recorder.put("notice", now(), "WARN", text, entity, False, kind, problem, _LOOK, (file, line))
        return result

    node_class._set_parameters_atomically_common = set_known


def _makes_nothing_of_it(frame: FrameType | None) -> tuple[str, int]:
    """The program's own line that sets parameters and drops the answer; "" and 0 if it does not."""
    called = ""
    while frame is not None and not is_own(frame):
        called, frame = frame.f_code.co_name, frame.f_back
    if frame is not None and called in _SETTERS:
        code = dis.get_instructions(frame.f_code)
        if next((each.opname for each in code if each.offset > frame.f_lasti), "") == "POP_TOP":
            return frame.f_code.co_filename, frame.f_lineno
    return "", 0


def _overruled(name: str, frame: FrameType | None) -> str:
    while frame is not None and not is_own(frame):
        frame = frame.f_back
    place = ""
    if frame is not None:
        place = f" ({Path(frame.f_code.co_filename).name}:{frame.f_lineno}, in {frame.f_code.co_name})"
    return f"a parameter callback sets '{name}' while that is being set{place}"


def _unanswered(callbacks: Any) -> tuple[str, str, tuple[str, int]]:
    """What is wrong with an on-set callback that returned no result, what to do, and its line."""
    own = [each for each in callbacks if not getattr(each, "__module__", "").startswith("rclpy.")]
    only = own[0] if len(own) == 1 else None
    name, code = getattr(only, "__name__", "a parameter callback"), getattr(only, "__code__", None)
    return (
        f"{name} returned no SetParametersResult, so rclpy refuses what was to be set",
        f"end {name} with: return SetParametersResult(successful=True)",
        (code.co_filename, code.co_firstlineno) if code else ("", 0),
    )
