"""The pace of virtual time on the wall clock: its speed, its pauses, and the goal of a fast-forward."""

import time
from collections.abc import Callable

# Kept from before sim.clock.stdlib puts the virtual one in its place.
_monotonic_ns = time.monotonic_ns

_LAG_FORGIVEN = 250_000_000
"""Nanoseconds that a paced run may fall behind the wall clock before it stops catching up."""


class Pace:
    """The pace of a virtual clock. Only the thread that has the clock's baton may change it.

    ``speed`` is virtual seconds per real second; None: as fast as possible. A fast-forward to a goal (the
    next step, or a moment) ignores the speed. ``on_halt`` is called each time a goal is reached.
    """

    def __init__(self, speed: float | None) -> None:
        self.paused = False
        """Whether time is paused."""
        self.awaited_inputs = 0
        """How many threads wait for an input from outside; a run as fast as possible waits for it, too."""
        self.on_halt: Callable[[], None] = lambda: None
        self._speed = speed
        self._is_real = False
        self._is_fast = False
        self._until: int | None = None
        self._steps = 0
        self._anchor_virtual = 0
        self._anchor_real = _monotonic_ns()

    @property
    def steps(self) -> bool:
        """Whether time is paused again after its next advance."""
        return self._steps > 0

    def set_speed(self, speed: float | None, now: int) -> None:
        """Change the speed from ``now`` on."""
        self._anchor_at(now)
        self._speed = speed

    def keep_real(self, wanted: bool, now: int) -> None:
        """Keep the wall clock's pace from ``now`` on, regardless of speed and goal, or stop doing so."""
        if wanted is not self._is_real:
            self._anchor_at(now)
            self._is_real = wanted

    def lag(self, now: int) -> int:
        """Nanoseconds by which a run at the wall clock's pace is late; 0 for any other run."""
        return self.reached(now, None) - now if self._is_real else 0

    def pause(self) -> None:
        """Pause, and drop the goal."""
        self._give_up_goal()
        self.paused = True

    def resume(self, now: int) -> None:
        """Resume at ``now``, and drop the goal."""
        self._give_up_goal()
        self._anchor_at(now)
        self.paused = False

    def step(self) -> None:
        """Fast-forward until ``halt`` is called. Several requested steps are taken one after another."""
        self._start_fast(None)
        self._steps += 1

    def fast_forward(self, until: int) -> None:
        """Fast-forward to a moment."""
        self._steps = 0
        self._start_fast(until)

    def halt(self) -> None:
        """Note that the goal is reached: pause, unless another step is due."""
        self._steps = max(0, self._steps - 1)
        if not self.steps:
            self.pause()
        self.on_halt()

    def goal_before(self, stop: int | None) -> int | None:
        """The goal, if it comes before ``stop`` (None: never); otherwise None."""
        return self._until if self._until is not None and (stop is None or self._until < stop) else None

    def delay_until(self, target: int | None) -> float | None:
        """Real nanoseconds to wait until ``target``; None: until something happens outside."""
        if target is None or self.paused:
            return None
        rate = self._rate()
        if rate is None:
            return None if self.awaited_inputs and not self._is_fast else 0
        delay = self._anchor_real + (target - self._anchor_virtual) / rate - _monotonic_ns()
        if delay < -_LAG_FORGIVEN and not self._is_real:
            self._anchor_at(target)
        return delay

    def reached(self, now: int, limit: int | None) -> int:
        """The time, at most ``limit``, that a run has reached which last advanced to ``now``."""
        rate = self._rate()
        if rate is None or self.paused:
            return now
        paced = self._anchor_virtual + int((_monotonic_ns() - self._anchor_real) * rate)
        return max(now, paced if limit is None else min(paced, limit))

    def _rate(self) -> float | None:
        """Virtual seconds per real second; None: as fast as possible."""
        if self._is_real:
            return 1.0
        return None if self._is_fast else self._speed

    def _start_fast(self, until: int | None) -> None:
        self._until = until
        self._is_fast = True
        self.paused = False

    def _give_up_goal(self) -> None:
        self._steps = 0
        self._until = None
        self._is_fast = False

    def _anchor_at(self, moment: int) -> None:
        self._anchor_virtual = moment
        self._anchor_real = _monotonic_ns()
