"""Has each choice among threads made from outside: time stands until a command says who goes on."""

import sys
from collections.abc import Callable, Hashable
from types import FrameType

from sim.clock import VirtualClock
from sim.clock.moves import Choice, MovesSchedule
from sim.clock.virtual_threads import VirtualThread
from sim.engine.watchdogs.wait_descriptions import waits
from sim.probes.own_code import own_frame, place_of
from sim.ros.middleware.host import Host
from sim.trace.events import AnyEvent, ChoiceAsked
from sim.trace.events.fields import SourcePlace


class AskedChoices:
    """Asks at each choice behind the moves that the schedule plays.

    A run that is told to go on without an answer asks no more, and the first option goes on from there.
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
        """Return what the schedule plays, or what is chosen; time stands meanwhile."""
        if not self._asks or choice.number <= self._schedule.last_move:
            return self._schedule.move_at(choice)
        self._tell(choice)
        self._clock.halt()
        answer = self._taken()
        self._asks = answer is not None
        return answer if answer is not None and answer < len(choice.options) else 0

    def choose(self, option: int) -> None:
        """Have that option go on; call it through ``VirtualTime.steer``."""
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
        frames = [own_frame(sys._current_frames().get(each.ident)) for each in threads]
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
            )
        )


def _line(frame: FrameType | None) -> SourcePlace:
    return ("", 0) if frame is None else (frame.f_code.co_filename, frame.f_lineno)


def position(thread: Hashable) -> str:
    """The name of a thread, and the line of the program in front of which it stands."""
    assert isinstance(thread, VirtualThread)
    place = place_of(sys._current_frames().get(thread.ident))
    return f"{thread.name} ({place})" if place else thread.name
