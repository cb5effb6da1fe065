"""Tells of callbacks on real rclpy that wait and do not go on, in the words of the model's watchdog."""

from collections.abc import Iterator

import msgspec

from sim.engine.callback_positions import LOCK
from sim.engine.watchdogs.wait_descriptions import advice_on_job, hung_notice
from sim.probes.own_code import place_text
from sim.trace.events import (
    AnyEvent,
    CallbackAt,
    CallbackEnded,
    CallbackSuspended,
    Doing,
    Nanoseconds,
    Notice,
    RunEnding,
    ThreadId,
)

_PATIENCE = 1_500_000_000
"""Nanoseconds without a step from which on a wait is told, as on the model."""


class HungCallbacks:
    """Follows where callbacks are, and tells once of each wait without a timeout that lasts.

    A wait for a lock is told if its holder is known: ``WaitsForLock`` covers the others.
    """

    def __init__(self) -> None:
        self._at: dict[ThreadId, CallbackAt] = {}
        """Where callbacks are, since the first event that had them there."""
        self._told: set[ThreadId] = set()
        self._jobs: dict[ThreadId, tuple[str, str, int]] = {}
        self._is_over = False

    def waits_for_job(self, thread: ThreadId, job: tuple[str, str, int]) -> None:
        """Note where a job waits for another one, while the callback of a thread waits for a job."""
        self._jobs[thread] = job

    def follow(self, event: AnyEvent) -> None:
        """Follow an event of the trace."""
        match event:
            case CallbackAt():
                known = self._at.get(event.thread)
                if known is not None and _where(known) == _where(event):
                    event = msgspec.structs.replace(event, t=known.t)
                else:
                    self._told.discard(event.thread)
                self._at[event.thread] = event
            case CallbackEnded() | CallbackSuspended():
                self._at.pop(event.thread, None)
                self._told.discard(event.thread)
            case RunEnding():
                self._is_over = True

    def look(self, t: Nanoseconds) -> Iterator[Notice]:
        """Yield the notices that are due."""
        for thread, at in () if self._is_over else self._at.items():
            waits = at.doing is Doing.WAITS and not at.until and t - at.t >= _PATIENCE
            if waits and thread not in self._told and not self._comes(at):
                self._told.add(thread)
                job = self._jobs.get(thread, ("", "", 0))
                yield _notice(at, t, advice_on_job(place_text(*job)) if job[0] else "")

    def _comes(self, at: CallbackAt) -> bool:
        """Whether a lock may come: nobody knows who holds it, or the last holder in a row just sleeps."""
        if at.call == LOCK and not (at.holder or at.keeper or at.taken_by):
            return True
        seen: set[ThreadId] = set()
        while at.holder in self._at and at.holder not in seen:
            seen.add(at.holder)
            at = self._at[at.holder]
        return at.doing is Doing.SLEEPS and not at.loop[0]


def _where(at: CallbackAt) -> tuple[object, ...]:
    return at.entity, at.call, at.frames


def _notice(at: CallbackAt, t: Nanoseconds, advice: str) -> Notice:
    where = at.frames[0][1], place_text(*at.frames[-1]), at.call, at.lock
    return hung_notice(t, at.entity, at.thread, at.t, where, advice)
