"""The time of a run on a virtual clock: the moment that it has reached, and what advances it.

Time jumps to the earliest deadline when no thread can run. At a speed, a jump takes its share of real time,
and an input from outside (a key pressed in the console) takes effect at the moment that time has reached by
then. Time can be paused, between two jumps or in the middle of a moment, and continue step by step.

Threads that only wait for no time, as a loop around ``time.sleep(0)`` does, keep a moment from ending. So
that such a run can be stopped and given inputs, a moment has a recess after every thousand waits. The recess
lasts a microsecond if most of these waits had a length of 0: a loop that polls its deadline, and waits for
the 0 s that are left, then ends as on a real machine, where polling takes time.
"""

from collections.abc import Callable

from sim.clock.deadlines import Deadlines
from sim.clock.inbox import Inbox, Inputs
from sim.clock.pace import Pace
from sim.clock.recesses import RECESS, Recesses
from sim.clock.virtual_threads import VirtualThread
from sim.quantities.nanoseconds import SECOND

_CHECK_PERIOD = 20_000_000
"""Real nanoseconds between two checks whether outside work continues."""


class VirtualTime:
    """The nanoseconds of a run, changed by the thread that has the baton.

    ``inject``, ``steer``, ``give`` and ``reached`` are thread-safe. ``resume_thread`` is called with each
    thread whose deadline is reached.
    """

    def __init__(self, speed: float | None, resume_thread: Callable[[VirtualThread], None]) -> None:
        self.now = 0
        """Virtual nanoseconds since the run began."""
        self.deadlines = Deadlines()
        self.recesses = Recesses()
        """Its ``steps`` count the waits: a run that neither takes steps nor ``rests`` is stuck."""
        self.pace = Pace(speed)
        self._resume_thread = resume_thread
        self._inbox = Inbox()
        self._inputs = Inputs()
        self._target: int | None = None
        self._step_limit = 0
        self.before_jump: Callable[[], int | None] = lambda: None
        """Called whenever time is about to pass, on any thread of the clock; it must not wait.

        It may return a moment at which time stops, so that it is called there too.
        """
        self.on_recess: Callable[[int], None] = lambda _recess: None
        """Called in every recess with its number, on the waiting thread; it must not wait."""
        self.outside_works: Callable[[], bool] = lambda: False
        """Whether outside work is going on, so that time passes as real time; it must not wait."""
        self.is_background: Callable[[VirtualThread], bool] = lambda _thread: False
        """Whether a step goes past what this thread does."""
        self.in_moment = False
        """Whether time is stopped within a moment; then only ``steer`` reaches the run."""

    @property
    def rests(self) -> bool:
        """Whether the run waits for its pace, for the end of a pause, or for something from outside."""
        return self._inbox.rests

    @property
    def reached(self) -> int:
        """The moment that a run has reached at its pace, which may be between two deadlines. Thread-safe."""
        return self.pace.reached(self.now, self._target) if self.rests else self.now

    def inject(self, action: Callable[[], None]) -> None:
        """Run ``action``, which must not wait, at the moment that the run has reached. Thread-safe."""
        self._inbox.put(action)

    def steer(self, action: Callable[[], None]) -> None:
        """Do as ``inject``, also while time is stopped within a moment. For pausing and stepping."""
        self._inbox.put(action, steers=True)

    def give(self, action: Callable[[], None]) -> None:
        """Carry out an input at the end of the moment that the run has reached. Thread-safe.

        By then every deadline of the moment is served, every thread waits, ``before_jump`` was called, and
        the inputs given before have had all their effects on that moment. A long moment takes one input in
        each recess. So a run is determined by the moments, recesses and order of its inputs, whatever their
        real times were: ``schedule_input`` repeats a run. The action must not wait.
        """
        self._inputs.given.append(action)
        self._inbox.ring()

    def schedule_input(self, moment: int, action: Callable[[], None], recess: int = 0) -> None:
        """Carry out an input at the end of ``moment``, or in a recess of it.

        Call it in the order of the moments and recesses.
        """
        self._inputs.scheduled.append((moment, recess, action))

    def set_speed(self, speed: float | None) -> None:
        """Pass ``speed`` virtual seconds a real second; None: no limit. Call it through ``steer``."""
        self.pace.set_speed(speed, self.now)

    def pause(self) -> None:
        """Pause time at the moment that the run has reached. Call it through ``steer``."""
        self.pace.pause()

    def resume(self) -> None:
        """Resume time after ``pause``. Call it through ``steer``."""
        self.pace.resume(self.now)

    def step(self) -> None:
        """Continue until time has jumped or the clock is halted, then pause. Call it through ``steer``.

        Jumps to what a background thread does count only once a second has passed.
        """
        self.pace.step()
        self._step_limit = self.now + SECOND

    def run_until(self, moment: int) -> None:
        """Run as fast as possible until everything up to ``moment`` has happened, then pause.

        Call it through ``steer``.
        """
        self.pace.fast_forward(moment)

    def pause_in_moment(self) -> None:
        """Pause time in the middle of this moment; block the calling thread until ``steer`` resumes time."""
        self.pace.halt()
        self.in_moment = self.pace.paused
        while self.pace.paused:
            self._inbox.run_steering(lambda: self.pace.paused)
            if self.pace.paused:
                self._inbox.rest(None)
        self.in_moment = False

    def take_recess(self) -> None:
        """Do what happens at the end of a moment, without letting time pass."""
        number = self.recesses.begin()
        self.before_jump()
        self.on_recess(number)
        self._input_is_taken()
        if self.pace.steps:
            self.pace.halt()
        self._inbox.run_all()
        while self.pace.paused and not self._inputs.given:
            self._inbox.rest(None)
            self._inbox.run_all()
        self.recesses.end()
        if self.recesses.idles:
            self.now = min([self.now + RECESS, *self.deadlines.later_than(self.now)])

    def jump(self, limit: int | None = None) -> None:
        """Advance time to the next deadline or ``limit``, or until an outside event lets a thread run."""
        deadline = self.deadlines.first()
        target = deadline
        if deadline is None or deadline > self.now:
            target = self._stopover_before(deadline)
            if limit is not None:
                target = limit if target is None else min(limit, target)
            if not self._inbox.waiting and self._input_is_taken():
                return
            if self._inputs.scheduled:
                moment, *_ = self._inputs.scheduled[0]
                target = moment if target is None else min(moment, target)
            if self._goal_is_reached_before(target):
                return
        if not self._pass_until(target):
            return
        assert target is not None
        if target > self.now:
            self._advance_to(target)
            if self.pace.steps and (target >= self._step_limit or not self._is_background(target)):
                self.pause_in_moment()
        if target == deadline:
            self._serve_deadline()

    def serve_equals(self) -> None:
        """Resume all threads whose deadline is this moment, up to the next action."""
        while self.deadlines.first() == self.now and self.deadlines.first_is_thread():
            self._serve_deadline()

    def _is_background(self, moment: int) -> bool:
        due = self.deadlines.due_at(moment)
        return bool(due) and all(isinstance(each, VirtualThread) and self.is_background(each) for each in due)

    def _advance_to(self, moment: int) -> None:
        if moment > self.now:
            self.now = moment
            self.recesses.begin_moment()

    def _stopover_before(self, deadline: int | None) -> int | None:
        stopover = self.before_jump()
        if stopover is None or stopover <= self.now:
            return deadline
        return stopover if deadline is None else min(stopover, deadline)

    def _input_is_taken(self) -> bool:
        """Carry out one input if one is due at the end of the moment or in its recess; return whether."""
        inputs = self._inputs
        if not (inputs.given or inputs.scheduled):
            return False
        action = inputs.take(self.now, self.recesses.current)
        if action is not None:
            action()
        return action is not None

    def _goal_is_reached_before(self, target: int | None) -> bool:
        goal = self.pace.goal_before(target)
        if goal is not None:
            self._advance_to(goal)
        elif target is not None or not self.pace.steps:
            return False
        self.pace.halt()
        return True

    def _serve_deadline(self) -> None:
        _, _, due = self.deadlines.take()
        if isinstance(due, VirtualThread):
            due.waiting = False
            self._resume_thread(due)
        else:
            due()

    def _pass_until(self, target: int | None) -> bool:
        """Wait until ``target`` at the present pace; False if something from outside came first.

        Injected actions are done by then; an input is carried out when the present moment ends.
        """
        self._target = target
        while not self._inbox.waiting:
            if target is not None and target <= self.now:
                return True  # the moment continues to its end, even if time is paused
            if self._inputs.given:
                break
            works = self.outside_works()
            self.pace.keep_real(works, self.now)
            delay = self.pace.delay_until(target)
            if delay is not None and delay <= 0:
                return True
            self._inbox.rest(min(delay, _CHECK_PERIOD) if works and delay is not None else delay)
        self._advance_to(self.pace.reached(self.now, target))
        self._inbox.run_all()
        return False
