"""Describes what a thread on the virtual clock waits for without a timeout, and what to do about it."""

import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile

from sim.clock.virtual_threads import HeldResource, VirtualThread
from sim.engine.callback_positions import JOB, LOCK
from sim.engine.waited_lock import decorated, first_line, name_at, taking
from sim.engine.watchdogs.thread_positions import place_of
from sim.interpreter.function_marks import calls_the_program
from sim.probes import own_code
from sim.probes.own_code import called_by_own, outwards, own_frame, place_text
from sim.quantities.durations import timestamp
from sim.trace.events import EntityId, Notice, NoticeKind, Severity, SourcePlace, ThreadId
from sim.trace.model import RESULT

ONE_ORDER = "take locks in the same order everywhere"
_AWAITS = threading.Condition.wait.__code__
"""The function in which every wait of Python's library ends that is not for a lock."""


@dataclass(frozen=True, slots=True)
class WaitProblem:
    """The problem of a wait, and advice on it. ``is_deadlock``: whether it can never end.

    ``place`` is the line of the wait if the positions of threads may not tell it.
    """

    problem: str
    advice: str
    is_deadlock: bool
    place: SourcePlace = ("", 0)

    def notice(self, t: int, entity: EntityId) -> Notice:
        """Return the notice of the problem; ``entity`` is the callback that waits (0: none)."""
        text, fields = f"{self.problem}; {self.advice}", (self.problem, self.advice, self.place)
        if self.is_deadlock:
            text = f"deadlock: {text}"
            return Notice(t, Severity.ERROR, text, entity, False, NoticeKind.DEADLOCK, *fields)
        return Notice(t, Severity.WARN, text, entity, False, NoticeKind.ENDLESS_WAIT, *fields)


def deadlock_of_cycle(cycle: Sequence[VirtualThread]) -> WaitProblem:
    """Describe threads that wait for each other's locks or ends, or one that waits for its own lock."""
    chain = ", and ".join(waits(each) for each in cycle)
    if any(_waits_for_end(each) for each in cycle):
        advice = "let go of locks before you wait for a thread to end"
    elif len(cycle) > 1:
        advice = ONE_ORDER
    elif _is_left(cycle[0].wants):
        advice = "let go of it on every way out, by with, and before an await"
    else:
        advice = "take it once, let go of it before (by with, and before an await), or use threading.RLock"
    return WaitProblem(chain, advice, is_deadlock=True)


def deadlock_of_last(thread: VirtualThread) -> WaitProblem:
    """Describe a thread that waits when no other thread of its program is left to end the wait."""
    problem = f"{waits(thread)}, and no thread of the program is left that could end that"
    return WaitProblem(problem, _cure(thread), is_deadlock=True)


def long_wait(thread: VirtualThread, since: int) -> WaitProblem:
    """Describe a thread that has waited since a moment for what another thread might still do."""
    return WaitProblem(f"{waits(thread)}, since {timestamp(since)}", _cure(thread), is_deadlock=False)


def hung_notice(
    t: int, entity: EntityId, thread: ThreadId, since: int, at: tuple[str, str, str, str], advice: str
) -> Notice:
    """Return the notice of a call that hangs."""
    problem, (function, place, call, lock) = f"has not come back since {timestamp(since)}", at
    what = f"waits in {call}()" if call else "computes, or waits for something that does not come"
    if call == LOCK:
        what = f"waits for {lock or 'a lock'}"
    text = f"{function} {problem} ({place}): it {what}; its thread serves nothing else meanwhile"
    text, kind = "; ".join(filter(None, (text, advice))), NoticeKind.NO_PROGRESS
    return Notice(t, Severity.WARN, text, entity, False, kind, problem, advice, thread=thread)


def advice_on_pools() -> str:
    """Return advice if a job of a pool waits for another job, which needs a worker, too; else ""."""
    for top in sys._current_frames().values():
        inside = list(takewhile(lambda frame: frame not in calls_the_program, outwards(top)))
        names = [frame.f_code.co_qualname for frame in inside]
        if JOB in names and RESULT in names[: names.index(JOB)]:
            return advice_on_job(own_code.place_of(top))
    return ""


def advice_on_job(place: str) -> str:
    """Return advice on a job that waits for another one at a place."""
    keeps = f"a job that waits for another job ({place}) keeps a worker of its pool"
    return f"{keeps}: let it call the function itself, or give the pool more workers"


def waits(thread: VirtualThread) -> str:
    """Return a clause on where a thread is, and for which lock or thread it waits."""
    own = own_frame(sys._current_frames().get(thread.ident))
    function = None if own is None else decorated(own)
    place = place_of(thread) if function is None else place_text(*first_line(function))
    return f"{thread.name} ({place}) {_what(thread)}"


def _what(thread: VirtualThread) -> str:
    signal = _signal(thread)
    if signal:
        return f"waits in {signal}()"
    lock = thread.wants
    if lock is None or lock.holder is None:
        return "waits for a lock"
    if lock.taken_at is None:
        return f"waits for {lock.holder.name} to end"
    top = sys._current_frames().get(thread.ident)
    own, inside = own_frame(top), called_by_own(top)
    name = "" if own is None else name_at(own, [frame.f_locals.get("self") for frame in inside])
    who = "it took itself" if lock.holder is thread else f"{lock.holder.name} took"
    more = " and did not release" if _is_left(lock) else ""
    return (
        f"waits for {name or 'a lock'}, which {who} at {place_text(*taking(lock, own))}{more}{_ended(lock)}"
    )


def _is_left(lock: HeldResource | None) -> bool:
    """Whether the function that took a lock has returned, or awaits."""
    if lock is None or lock.holder is None or lock.taken_at is None:
        return False
    code, offset = lock.taken_at
    stack = outwards(sys._current_frames().get(lock.holder.ident))
    return all(frame.f_code is not code or frame.f_lasti == offset for frame in stack)  # it takes it again


def _ended(lock: HeldResource) -> str:
    taker: threading.Thread | None = getattr(lock, "taken_by", None)
    return "" if taker is None or taker.is_alive() else " before it ended"


def _signal(thread: VirtualThread) -> str:
    """Return the library function in which a thread waits for another: ``Event.wait``; "" for a lock."""
    if thread.wants is None or thread.wants.holder is not thread:
        return ""
    library = [frame.f_code for frame in called_by_own(sys._current_frames().get(thread.ident))]
    return library[-1].co_qualname if _AWAITS in library else ""


def _cure(thread: VirtualThread) -> str:
    if pools := _signal(thread) == RESULT and advice_on_pools():
        return pools
    if _signal(thread):
        return "wait with a timeout, and let a callback of another group, on another thread, end it"
    if _waits_for_end(thread):
        return "make sure that the thread ends, or join it with a timeout"
    if thread.wants is None or _is_left(thread.wants):
        return "take locks by with, which lets go of them whatever happens"
    return "let go of a lock before you wait for anything else"


def _waits_for_end(thread: VirtualThread) -> bool:
    return thread.wants is not None and thread.wants.holder is not None and thread.wants.taken_at is None
