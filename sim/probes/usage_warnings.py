"""Records where a program misuses what rclpy gives it, though nothing fails."""

import threading
import warnings
from collections.abc import Callable, Sequence
from inspect import isasyncgenfunction, isgeneratorfunction
from pathlib import Path
from typing import Any, Protocol

from sim.probes.loop_variables import SharedVariables
from sim.probes.own_code import call_into_ros, is_result_dropped, is_written, place_of_caller
from sim.probes.traced import TracedEntity, name_of
from sim.trace.events import NoticeKind

_AT_ONCE = 10_000_000
"""Nanoseconds after a request in which no reply can be expected; on virtual time none pass in between."""

_SETTERS = ("set_parameters", "set_parameters_atomically")

PUBLISHERS = 5
"""How many publishers of one topic and line are worth a warning, as is each time that these have doubled."""


class _Here(Protocol):
    entity: int
    begun: int


class UsageWarnings:
    """Warns once for each line, or number.

    ``here`` is the state of the calling thread, ``warn`` records a notice.
    """

    def __init__(self, now: Callable[[], int], here: _Here, warn: Callable[..., None]) -> None:
        self._now = now
        self._here = here
        self._warn = warn
        self._told: set[tuple[str, int, int]] = set()
        self._shared = SharedVariables()

    def result_check(self) -> Callable[[], None]:
        """Return what to call when the result of the request that is sent now is asked for and not there.

        It warns if the same call of a callback asks at once.
        """
        sent, by = self._now(), self._caller()

        def asked() -> None:
            if self._here.entity and self._caller() == by and self._now() - sent < _AT_ONCE:
                problem = "result() is asked for as soon as the request is sent, and is None"
                advice = "use it in a done-callback of the future"
                self._tell(("result",), NoticeKind.EARLY_RESULT, problem, advice)

        return asked

    def refused(self, names: Sequence[str], reason: str) -> None:
        """Warn if the program drops the answer that parameters were refused."""
        if is_result_dropped():
            were = "was" if len(names) == 1 else "were"
            problem = f"{', '.join(names)} {were} refused{reason and ': '}{reason}"
            advice = "look at the results that set_parameters() returns"
            self._tell(_SETTERS, NoticeKind.REFUSAL_OVERLOOKED, problem, advice)

    def publishers_kept(self, number: int, place: tuple[str, int]) -> None:
        """Warn of so many publishers of a topic that were made at a line; the more, the more seldom."""
        rounds, rest = divmod(number, PUBLISHERS)
        if self._here.entity and place[1] and rounds.bit_count() == 1 and rest == 0:
            problem = f"{number} publishers of a topic were made in callbacks, and none was destroyed"
            advice = "make one in __init__"
            self._tell_of(place, NoticeKind.PUBLISHERS_KEPT, problem, advice, number)

    def callback_made(self, callback: object, place: tuple[str, int], entity: int) -> None:
        """Warn if a callback shares a loop's variable with one made at its line before, or is a generator."""
        if (isgeneratorfunction(callback) or isasyncgenfunction(callback)) and place[1]:
            name = getattr(callback, "__name__", "the callback")
            problem = f"{name} has a yield in it, so calling it only makes a generator: nothing of it runs"
            advice, code = f"write {name} without yield", getattr(callback, "__code__", None)
            defined = (code.co_filename, code.co_firstlineno) if code else place
            self._tell_of(defined, NoticeKind.NEVER_ITERATED, problem, advice, entity=entity)
        for name in self._shared.of(callback, place):
            code = getattr(callback, "__code__")  # noqa: B009 - it is a function
            given = ", ".join((*code.co_varnames[: code.co_argcount], f"{name}={name}"))
            problem = (
                f"the callbacks made at one line share the loop's variable {name}, and all see its last value"
            )
            advice = f"bind it when each is made: def {code.co_name}({given})"
            if code.co_name == "<lambda>":
                advice = f"bind it when each is made: lambda {given}: …, or functools.partial"
            self._tell_of(place, NoticeKind.LATE_BOUND, problem, advice, entity=entity)

    def watch_coroutines(self) -> None:
        """Have Python tell of coroutines that are dropped before anything of them has run."""
        tell_in_general = warnings._warn_unawaited_coroutine  # type: ignore[attr-defined]

        def tell(coroutine: Any) -> None:
            if not self._never_awaited(coroutine):
                tell_in_general(coroutine)

        warnings._warn_unawaited_coroutine = tell  # type: ignore[attr-defined]

    def _never_awaited(self, coroutine: Any) -> bool:
        """Warn of a coroutine that a callback dropped, if the program's own code made it."""
        for file, line, function in (coroutine.cr_origin or ())[:1]:
            name = coroutine.__qualname__.rpartition(".")[2]
            if self._here.entity and is_written(file):
                problem = f"{function} calls {name}() without await, so nothing of {name} runs"
                advice = f"put await before {name}(), in an async def {function}"
                if function == "<lambda>":
                    problem = f"a lambda returns {name}(), which nobody awaits, so nothing of {name} runs"
                    advice = (
                        f"hand over an async def, or a functools.partial of {name}: rclpy awaits no other"
                    )
                self._tell_of((file, line), NoticeKind.NEVER_AWAITED, problem, advice)
                return True
        return False

    def result_of_rejected(self) -> None:
        """Warn that the result of a goal is asked for which the server has rejected."""
        problem = "the result of a goal is asked for that the server rejected: it is empty, with status 0"
        advice = "look at goal_handle.accepted first, and return if it is False"
        self._tell(("get_result", "get_result_async"), NoticeKind.REJECTION_OVERLOOKED, problem, advice)

    def node_destroyed_by_itself(self, name: str, entity: TracedEntity) -> None:
        """Warn that the callback on the calling thread destroys its own node."""
        self._warn(
            f"{name} destroyed itself in its own callback {name_of(entity)} ({place_of_caller()}): this call "
            "goes on to its end, and no callback of the node runs again; to end the program, call "
            "rclpy.shutdown() there"
        )

    def published_inactive(self, topic: str, *, is_node_active: bool) -> None:
        """Warn that a lifecycle publisher, though its node is active or as it is not, drops its messages."""
        problem = f"publish() on {topic} by a lifecycle publisher that is not active: nothing is sent"
        advice = "activate the node: trigger_activate() once trigger_configure() has succeeded"
        if is_node_active:
            advice = "end on_activate with: return super().on_activate(state), which activates the publishers"
        self._tell(("publish",), NoticeKind.INACTIVE, problem, advice, topic)

    def parameter_overruled(self, name: str) -> None:
        """Warn that a parameter callback on the calling thread sets a parameter that is being set."""
        problem = f"a parameter callback sets '{name}' while that is being set ({place_of_caller()})"
        advice = "return the value from a pre-set callback, or refuse what was asked for"
        told = {"kind": NoticeKind.OVERRULED, "problem": problem, "advice": advice}
        self._warn(f"{problem}: what was asked for is stored last; {advice}", self._here.entity, **told)

    def parameters_unanswered(self, callback: Callable[..., object]) -> None:
        """Warn of an on-set callback that returns no SetParametersResult."""
        name = getattr(callback, "__name__", "a parameter callback")
        code = getattr(callback, "__code__", None)
        problem = f"{name} returned no SetParametersResult, so rclpy refuses what was to be set"
        advice = f"end {name} with: return SetParametersResult(successful=True)"
        place = (code.co_filename, code.co_firstlineno) if code else ("", 0)
        self._tell_of(place, NoticeKind.UNANSWERED, problem, advice)

    def cancel_ignored(self, entity: TracedEntity, seconds: int) -> None:
        """Warn that an execute callback has gone on so long after the cancel of its goal was accepted."""
        problem = (
            f"{name_of(entity)} goes on {seconds} s after the cancel of its goal was accepted, and has not "
            "looked at is_cancel_requested"
        )
        advice = "look at it in each round, and if it is set, call canceled() and return a result"
        told = {"kind": NoticeKind.CANCEL_IGNORED, "problem": problem, "advice": advice}
        self._warn(f"{problem}; {advice}", entity.trace_id, **told)

    def many_made(self, number: int, kind: str) -> None:
        """Warn that callbacks keep creating entities of one kind; the node has ``number`` of them."""
        self._warn(
            f"a node has {number:,} {kind}, and its callbacks make more ({place_of_caller()}): each stays "
            "until it is destroyed; make what the node needs once, in __init__"
        )

    def parameters_unused(self, source: str, asked: Sequence[str], nodes: Sequence[str]) -> None:
        """Warn that a file, or an argument, has parameters for nodes of other names than there are."""
        if asked:
            there = f"; there is {', '.join(nodes)}" if nodes else ""
            self._warn(f"{source} sets nothing: no node is called {' or '.join(asked)} so far{there}")

    def _caller(self) -> tuple[int, int, int]:
        return threading.get_ident(), self._here.entity, self._here.begun

    def _tell(
        self, functions: Sequence[str], kind: NoticeKind, problem: str, advice: str, topic: str = ""
    ) -> None:
        called, file, line = call_into_ros()
        if called in functions and line:
            self._tell_of((file, line), kind, problem, advice, topic=topic)

    def _tell_of(
        self,
        place: tuple[str, int],
        kind: NoticeKind,
        problem: str,
        advice: str,
        number: int = 0,
        entity: int = 0,
        topic: str = "",
    ) -> None:
        if (*place, number) not in self._told:
            self._told.add((*place, number))
            told = {"kind": kind, "problem": problem, "advice": advice, "place": place, "topic": topic}
            self._warn(
                f"{problem} ({Path(place[0]).name}:{place[1]}); {advice}", entity or self._here.entity, **told
            )
