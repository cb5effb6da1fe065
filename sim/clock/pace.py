"""The pace of virtual time on the wall clock: its speed, its pauses, and the next goal."""

import time
from collections.abc import Callable

# Kept from before sim.clock.stdlib puts the virtual one in its place.
_monotonic_ns = time.monotonic_ns

_LAG_FORGIVEN = 250_000_000
"""Nanoseconds that a paced run may fall behind the wall clock before it stops catching up."""


class Pace:
    """The pace of a virtual clock. Guarded by the clock's baton.

    ``speed`` is virtual seconds per real second, None for as fast as possible. A run that hurries to a goal
    (its next step, or a moment) ignores its speed. ``on_halt`` is called each time a goal is reached.
    """

    def __init__(self, speed: float | None) -> None:
        self.stands = False
        """Whether time is paused."""
        self.awaits = 0
        """How many threads wait for somebody outside; a run as fast as possible waits for them too."""
        self.on_halt: Callable[[], None] = _nothing
        self._speed = speed
        self._is_real = False
        self._hurries = False
        self._until: int | None = None
        self._steps = 0
        self._anchor_virtual = 0
        self._anchor_real = _monotonic_ns()

    @property
    def steps(self) -> bool:
        """Whether time pauses again after its next advance, however small."""
        return self._steps > 0

    def set_speed(self, speed: float | None, now: int) -> None:
        """Change the speed, from ``now`` on."""
        self._anchor_at(now)
        self._speed = speed

    def keep_real(self, wanted: bool, now: int) -> None:
        """Keep to the wall clock's pace from ``now`` on, whatever the speed or goal, or stop doing so."""
        if wanted is not self._is_real:
            self._anchor_at(now)
            self._is_real = wanted

    def lag(self, now: int) -> int:
        """Nanoseconds by which a run at the wall clock's pace is behind it; 0 for any other."""
        return self.reached(now, None) - now if self._is_real else 0

    def stand(self) -> None:
        """Pause; a goal is dropped."""
        self._give_up_goal()
        self.stands = True

    def go_on(self, now: int) -> None:
        """Resume at ``now``; a goal is dropped."""
        self._give_up_goal()
        self._anchor_at(now)
        self.stands = False

    def step(self) -> None:
        """Hurry until ``halt`` is called; steps requested at once are taken one after another."""
        self._hurry(None)
        self._steps += 1

    def hurry(self, until: int) -> None:
        """Hurry to a moment."""
        self._steps = 0
        self._hurry(until)

    def halt(self) -> None:
        """The goal is reached: pause, unless another step is due."""
        self._steps = max(0, self._steps - 1)
        if not self.steps:
            self.stand()
        self.on_halt()

    def goal_before(self, stop: int | None) -> int | None:
        """The moment at which to pause before time advances to ``stop`` (None: it never does)."""
        return self._until if self._until is not None and (stop is None or self._until < stop) else None

    def delay_until(self, target: int | None) -> float | None:
        """Real nanoseconds to wait before ``target`` may come; None: until something happens outside."""
        if target is None or self.stands:
            return None
        rate = self._rate()
        if rate is None:
            return None if self.awaits and not self._hurries else 0
        delay = self._anchor_real + (target - self._anchor_virtual) / rate - _monotonic_ns()
        if delay < -_LAG_FORGIVEN and not self._is_real:
            self._anchor_at(target)
        return delay

    def reached(self, now: int, limit: int | None) -> int:
        """The time reached, at most ``limit``, by a run that last advanced to ``now``."""
        rate = self._rate()
        if rate is None or self.stands:
            return now
        paced = self._anchor_virtual + int((_monotonic_ns() - self._anchor_real) * rate)
        return max(now, paced if limit is None else min(paced, limit))

    def _rate(self) -> float | None:
        """Virtual seconds per real second; None: as fast as possible."""
        if self._is_real:
            return 1.0
        return None if self._hurries else self._speed

    def _hurry(self, until: int | None) -> None:
        self._until = until
        self._hurries = True
        self.stands = False

    def _give_up_goal(self) -> None:
        self._steps = 0
        self._until = None
        self._hurries = False

    def _anchor_at(self, moment: int) -> None:
        self._anchor_virtual = moment
        self._anchor_real = _monotonic_ns()


def _nothing() -> None:
    """The default listener, which does nothing."""
