"""Leaves each choice among threads to a command from outside; time stands until it comes."""

import sys
from collections.abc import Callable, Hashable
from itertools import takewhile
from types import FrameType

from sim.clock import VirtualClock
from sim.clock.moves import Choice, MovesSchedule
from sim.clock.virtual_threads import VirtualThread
from sim.engine.programs.program import pooled_threads
from sim.engine.watchdogs.wait_descriptions import waits
from sim.interpreter.function_marks import calls_the_program
from sim.probes.own_code import outwards, own_frame, place_of
from sim.ros.middleware.host import Host
from sim.trace.events import AnyEvent, ChoiceAsked
from sim.trace.events.fields import SourcePlace


class AskedChoices:
    """Asks at each choice after the moves that the schedule plays.

    If the run is resumed without an answer, it asks no more, and takes the first option from there on.
    """

    def __init__(
        self, clock: VirtualClock, schedule: MovesSchedule, host: Host, record: Callable[[AnyEvent], None]
    ) -> None:
        self._clock = clock
        self._schedule = schedule
        self._host = host
        self._record = record
        self._asks = True
        self._answer: int | None = None

    def decide(self, choice: Choice) -> int:
        """Return the schedule's move, or the answer to the question; time stands while it waits."""
        if not self._asks or choice.number <= self._schedule.last_move:
            return self._schedule.move_at(choice)
        self._tell(choice)
        self._clock.halt()
        answer = self._taken()
        self._asks = answer is not None
        return answer if answer is not None and answer < len(choice.options) else 0

    def choose(self, option: int) -> None:
        """Let an option continue; call this through ``VirtualTime.steer``."""
        self._answer = option
        self._clock.time.resume()

    def _taken(self) -> int | None:
        answer, self._answer = self._answer, None
        return answer

    def _tell(self, choice: Choice) -> None:
        self._clock.no_switching += 1
        try:
            self._host.explain_waits()
        finally:
            self._clock.no_switching -= 1
        threads = [each for each in choice.options if isinstance(each, VirtualThread)]
        frames = [_frame_of(each) for each in threads]
        others = sorted(set(self._clock.threads).difference(choice.options), key=lambda each: each.name)
        kept = tuple(
            f"{position(each)} waits for time or work" if each.wants is None else waits(each)
            for each in others
        )
        self._record(
            ChoiceAsked(
                self._clock.now(),
                choice.number,
                tuple(each.name for each in threads),
                tuple("" if each is None else each.f_code.co_name for each in frames),
                tuple(map(_line, frames)),
                choice.preempts,
                kept,
                tuple(place for place, each in enumerate(threads) if each.ident in pooled_threads()),
            )
        )


def _frame_of(thread: VirtualThread) -> FrameType | None:
    """The innermost frame of the program on a thread; None in what calls a callback, before and behind it."""
    top = sys._current_frames().get(thread.ident)
    own = own_frame(top)
    inside = takewhile(lambda frame: frame is not own, outwards(top))
    return None if any(frame in calls_the_program for frame in inside) else own


def _line(frame: FrameType | None) -> SourcePlace:
    return ("", 0) if frame is None else (frame.f_code.co_filename, frame.f_lineno)


def position(thread: Hashable) -> str:
    """Return a thread's name, and the line of the program that it runs next."""
    assert isinstance(thread, VirtualThread)
    place = place_of(sys._current_frames().get(thread.ident))
    return f"{thread.name} ({place})" if place else thread.name
