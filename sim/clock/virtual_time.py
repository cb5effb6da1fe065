"""The time of a run on virtual time: the moment it has reached, and what brings it forward.

Time jumps to the earliest deadline when no thread can run. Paced to a speed, a jump takes as long as the pace
says, and what comes from outside (a key pressed in the console) takes effect at the moment that the pace has
reached. Time can stand, between two jumps or in the middle of a moment, and go on from there step by step.

Threads that only ever wait for no time, as a loop around ``time.sleep(0)`` does, keep a moment from ending.
So that such a run can be stopped and given inputs, a moment has a recess after every thousand waits. It lasts
a microsecond where most of these waits were for no time: a loop that asks whether its deadline is behind it,
and waits for the 0 s that are left, ends so as on a machine, where asking takes time.
"""

from collections.abc import Callable

from sim.clock.deadlines import Deadlines
from sim.clock.inbox import Inbox, Inputs
from sim.clock.pace import Pace
from sim.clock.recesses import RECESS, Recesses
from sim.clock.virtual_threads import VirtualThread

_CHECK_PERIOD = 20_000_000
"""Real nanoseconds between checks whether outside work goes on."""


class VirtualTime:
    """Nanoseconds of a run, changed by the thread that has the baton.

    Any thread may call ``inject``, ``steer`` and ``give``. ``resume_thread`` is called with each thread whose
    deadline has come.
    """

    def __init__(self, speed: float | None, resume_thread: Callable[[VirtualThread], None]) -> None:
        self.now = 0
        """Virtual nanoseconds since the run began."""
        self.deadlines = Deadlines()
        self.recesses = Recesses()
        self.pace = Pace(speed)
        self._resume_thread = resume_thread
        self._inbox = Inbox()
        self._inputs = Inputs()
        self.before_jump: Callable[[], int | None] = _no_stopover
        """Called whenever time is about to pass, on whichever thread is at hand; it must not wait.

        It may return a moment at which time is to stop over, so that it is called there too.
        """
        self.on_recess: Callable[[int], None] = _ignore
        """Called in every recess, with its number, on the thread that waits; it must not wait."""
        self.outside_works: Callable[[], bool] = _no
        """Whether something outside is at work, so that time passes as on the wall; it must not wait."""
        self.in_moment = False
        """Whether time is stopped within a moment; then only ``steer`` reaches the run."""

    @property
    def idles(self) -> bool:
        """Whether most of the waits in this moment up to its last recess were for no time."""
        return self.recesses.idles

    @property
    def recess(self) -> int:
        """Which recess of its moment the run is in; 0: none."""
        return self.recesses.current

    @property
    def steps(self) -> int:
        """How often a thread came to a wait; a run that neither takes steps nor rests is stuck."""
        return self.recesses.steps

    @property
    def rests(self) -> bool:
        """Whether the run waits for its pace, for the end of a pause, or for something from outside."""
        return self._inbox.rests

    def inject(self, action: Callable[[], None]) -> None:
        """Have ``action`` run at the moment the run has reached; it must not wait. Any thread may call it."""
        self._inbox.put(action)

    def steer(self, action: Callable[[], None]) -> None:
        """As ``inject``, but also while time is stopped within a moment; for pausing and stepping."""
        self._inbox.put(action, steers=True)

    def give(self, action: Callable[[], None]) -> None:
        """Have an input carried out at the end of the moment the run has reached; any thread may call this.

        By then every deadline of the moment is served, each thread waits and ``before_jump`` was called, and
        the inputs given before have had all their effects on that moment. A long moment takes one input in
        each recess. So the moments and recesses of its inputs and their order determine a run, whatever their
        real times were: ``schedule_input`` repeats it. The action must not wait.
        """
        self._inputs.given.append(action)
        self._inbox.ring()

    def schedule_input(self, moment: int, action: Callable[[], None], recess: int = 0) -> None:
        """Have an input carried out at the end of ``moment``, or in a recess of it.

        Call it in the order of the moments and recesses.
        """
        self._inputs.scheduled.append((moment, recess, action))

    def set_speed(self, speed: float | None) -> None:
        """Pass ``speed`` virtual seconds per real second, None: all it can. Call it through ``steer``."""
        self.pace.set_speed(speed, self.now)

    def pause(self) -> None:
        """Stop time at the moment the run has reached; call through ``steer``."""
        self.pace.stand()

    def resume(self) -> None:
        """Let time go on after ``pause``; call through ``steer``."""
        self.pace.go_on(self.now)

    def step(self) -> None:
        """Go on until time has jumped or the clock is halted, and let time stand; call through ``steer``."""
        self.pace.step()

    def run_until(self, moment: int) -> None:
        """Hurry until everything up to ``moment`` has happened, and let time stand there.

        Call it through ``steer``.
        """
        self.pace.hurry(moment)

    def stand_in_moment(self) -> None:
        """Let time stand in the middle of this moment until it is steered on; blocks the calling thread."""
        self.pace.halt()
        self.in_moment = self.pace.stands
        while self.pace.stands:
            self._inbox.run_steering(lambda: self.pace.stands)
            if self.pace.stands:
                self._inbox.rest(None)
        self.in_moment = False

    def take_recess(self) -> None:
        """Do what the end of a moment does, without letting time pass."""
        number = self.recesses.begin()
        self.before_jump()
        self.on_recess(number)
        self._input_is_taken()
        if self.pace.steps:
            self.pace.halt()
        self._inbox.run_all()
        while self.pace.stands and not self._inputs.given:
            self._inbox.rest(None)
            self._inbox.run_all()
        self.recesses.end()
        if self.recesses.idles:
            self.now = min([self.now + RECESS, *self.deadlines.later_than(self.now)])

    def jump(self) -> None:
        """Bring time to the next deadline, or to where something from outside makes a thread able to run."""
        deadline = self.deadlines.first()
        target = deadline
        if deadline is None or deadline > self.now:
            target = self._stopover_before(deadline)
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
            if self.pace.steps:
                self.stand_in_moment()
        if target == deadline:
            self._serve_deadline()

    def serve_equals(self) -> None:
        """Let all threads go on whose deadline is this moment, up to the next action."""
        while self.deadlines.first() == self.now and self.deadlines.first_is_thread():
            self._serve_deadline()

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
        """Carry out one input, if there is one for the end of the moment or its recess."""
        inputs = self._inputs
        if not (inputs.given or inputs.scheduled):
            return False
        action = inputs.take(self.now, self.recess)
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
        """Wait as long as the pace wants; False if something from outside came first.

        What was injected has been done then; an input comes when the moment that the run has reached ends.
        """
        while not self._inbox.waiting:
            if target is not None and target <= self.now:
                return True  # the moment goes on to its end, even if time stands
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


def _no_stopover() -> int | None:
    return None


def _ignore(_recess: int) -> None:
    pass


def _no() -> bool:
    return False
