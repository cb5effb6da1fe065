"""Virtual time: real threads of which one runs at a time, and time that jumps when none of them can.

The threads pass a baton. A thread that waits hands it to the next one that can run, first come, first
served; when nobody can, time jumps to the earliest deadline (ties: the one that began to wait first).
Computing takes no virtual time, so the same inputs give the same run, whatever the machine does.

A schedule may choose other orders, those that a real machine could come to: any thread that can run goes on,
and one that runs is left at a switch point, in front of or behind a lock or a question for the time.

Paced to a speed, a jump takes as long as the pace says, and what comes from outside (a key pressed in the
console) takes effect at the moment that the pace has reached. Time can stand, between two jumps or in the
middle of a moment, and go on from there one step at a time.

Threads that only ever wait for no time, as a loop around ``time.sleep(0)`` does, keep a moment from ending.
So that such a run can be stopped and given inputs, a moment has a recess after every thousand waits. It lasts
a microsecond where most of these waits were for no time: a loop that asks whether its deadline is behind it,
and waits for the 0 s that are left, ends so as on a machine, where asking takes time.
"""

import threading
from collections import deque
from collections.abc import Callable, Generator, Set
from contextlib import contextmanager

from sim.clock.deadlines import Deadlines
from sim.clock.inbox import Inbox, Inputs
from sim.clock.interface import Stopped
from sim.clock.outside import start_outside
from sim.clock.pace import Pace
from sim.clock.recesses import RECESS, Recesses
from sim.clock.schedule import FirstCome, Schedule
from sim.clock.virtual_threads import VirtualSignal, VirtualThread
from sim.units import SECOND

# Kept from before sim.clock.stdlib puts the virtual ones in their place.
_get_ident = threading.get_ident
_Thread = threading.Thread

_LOOK = 20_000_000
"""Real nanoseconds after which is looked again whether outside work goes on."""

VIRTUAL_EPOCH = 1_700_000_000 * SECOND
"""Every virtual run begins at this moment (14 November 2023), so its stamps are the same each time."""


class VirtualClock:
    """A deterministic clock and the scheduler of the threads that live on it.

    The thread that makes it becomes its main thread. Only threads started through the clock (or adopted
    by it) may wait on it; any other thread reaches into the run with ``inject``.
    """

    epoch = VIRTUAL_EPOCH

    def __init__(self, speed: float | None = None, schedule: Schedule | None = None) -> None:
        self._schedule = schedule or FirstCome()
        self.explores = self._schedule.explores
        """Whether its schedule chooses among the orders that are possible."""
        self.held_together = 0
        """How many reasons there are not to switch threads at a switch point."""
        self._now = 0
        self._ready: deque[VirtualThread] = deque()
        self._deadlines = Deadlines()
        self._inbox = Inbox()
        self._inputs = Inputs()
        self._recesses = Recesses()
        self.pace = Pace(speed)
        self._stopping = False
        self._threads: set[VirtualThread] = set()
        self.before_jump: Callable[[], int | None] = _nobody
        """Called whenever time is about to pass, on whichever thread is at hand; it must not wait.

        It may return a moment at which time is to stop over, so that it is called there too.
        """
        self.on_recess: Callable[[int], None] = _nobody
        """Called in every recess, with its number, on the thread that waits; it must not wait."""
        self.on_lock_wait: Callable[[VirtualThread], None] = _nobody
        """Called when a thread begins to wait without an end for a lock, or for another thread to end.

        It is called on that thread, and must not wait.
        """
        self.outside_works: Callable[[], bool] = _no
        """Whether something outside is at work, so that time passes as on the wall; it must not wait."""
        self.handle_signals: Callable[[], None] = _nobody
        """Called on the main thread when it goes on after a wait."""
        self.in_moment = False
        """Whether time stands in the middle of a moment: only ``steer`` reaches the run then."""
        self.current = VirtualThread("MainThread")
        self.current.is_main = True
        self.current.ident = _get_ident()
        self._threads.add(self.current)

    def now(self) -> int:
        """Virtual nanoseconds since the run began."""
        return self._now

    @property
    def stopping(self) -> bool:
        """Whether the run is over: no time passes any more."""
        return self._stopping

    @property
    def idles(self) -> bool:
        """Whether most of the waits in this moment up to its last recess were for no time."""
        return self._recesses.idles

    @property
    def recess(self) -> int:
        """Which recess of its moment the run is in; 0: none."""
        return self._recesses.current

    @property
    def steps(self) -> int:
        """How often a thread came to a wait; a run that neither takes steps nor rests is stuck."""
        return self._recesses.steps

    @property
    def rests(self) -> bool:
        """Whether the run waits for its pace, for the end of a pause, or for something from outside."""
        return self._inbox.rests

    @property
    def threads(self) -> Set[VirtualThread]:
        """The threads that live on it; to be asked for by the one that has the baton."""
        return self._threads

    def sleep(self, duration: int) -> None:
        """Let ``duration`` virtual nanoseconds pass; 0 lets every other thread that can run go first."""
        deadline = self._now + max(duration, 0)
        while self.park(deadline) and self._now < deadline:
            continue  # it handled a signal

    def signal(self) -> VirtualSignal:
        """A new signal, not set."""
        return VirtualSignal(self)

    def owns_current_thread(self) -> bool:
        """Whether the calling thread lives on this clock and has the baton."""
        return self.current.ident == _get_ident()

    def start_thread(self, target: Callable[[], None], name: str) -> None:
        """Run ``target`` on a new daemon thread; it comes after those that can run already."""
        thread = _Thread(target=self.adopt(target, name), name=name, daemon=True)
        start_outside(thread)

    def adopt(self, target: Callable[[], None], name: str) -> Callable[[], None]:
        """Make room for one more thread and return what that thread has to run."""
        virtual = VirtualThread(name)
        self._threads.add(virtual)
        self._ready.append(virtual)

        def run() -> None:
            virtual.ident = _get_ident()
            virtual.gate.acquire()
            try:
                if not self._stopping:
                    target()
            except Stopped:
                pass  # the run is over, and this thread with it
            finally:
                self._retire(virtual)

        return run

    def call_at(self, time: int, action: Callable[[], None]) -> None:
        """Run ``action`` when virtual time reaches ``time``, on whichever thread is at hand."""
        self._deadlines.add((max(time, self._now), self._deadlines.number(), action))

    def park(self, deadline: int | None) -> bool:
        """Hand the baton on until unparked or until ``deadline``; True if unparked, which a signal does, too.

        Raises:
            KeyboardInterrupt: the thread was interrupted, or the run was stopped and this is its main thread.
                Raised once, as by Ctrl-C; later waits of the main thread of a stopped run let the others end
                and return at once.
            Stopped: the run was stopped, and this is another thread.
        """
        me = self.current
        if self._stopped():
            return self._wind_up(me)
        self._raise_knock(me)
        me.waiting = True
        me.woken = False
        me.current_wait = self._deadlines.number()
        if deadline is not None:
            self._recesses.idle_waits += deadline <= self._now
            self._deadlines.add((deadline, me.current_wait, me))
        self._hand_on(me)
        self._raise_knock(me)
        if self._stopped():
            return self._wind_up(me)
        woken = me.woken
        if me.is_main:
            self.handle_signals()
        return woken

    def poll(self) -> None:
        """Count a question that was answered at once as a wait for no time; it is one if a recess is due.

        The calling thread must hold nothing that others wait for outside this clock.
        """
        if self.held_together or not self.owns_current_thread():
            return
        recesses = self._recesses
        if recesses.steps >= recesses.due:
            self.park(self._now)
        else:
            recesses.idle_waits += 1
            recesses.steps += 1

    def unpark(self, thread: VirtualThread) -> None:
        """Let a parked thread run again, after those that can run already; else nothing happens."""
        if thread.waiting:
            thread.waiting = False
            thread.woken = True
            self._ready.append(thread)

    def choose(self, number: int) -> int:
        """Which of ``number`` equals that wait for something gets it, from 0: the oldest, unless explored."""
        return self._schedule.choose(number)

    def switch_point(self) -> None:
        """Let another thread go first that can run, if the schedule wants it. Any thread may call this.

        Put it where a real machine could switch, and where the calling thread holds nothing that another one
        would wait for outside this clock.
        """
        if not self.explores or self.held_together or self._stopping or not self.owns_current_thread():
            return
        me = self.current
        if self._ready and not me.stays and self._schedule.leaves(me, self._ready):
            self._ready.append(me)
            self._hand_on(me)

    def end_thread(self) -> None:
        """Have the calling thread run to its end from here, which it is near: others may join it for real."""
        self.current.stays = True

    def inject(self, action: Callable[[], None]) -> None:
        """Have ``action`` run at the moment the run has reached; it must not wait. Any thread may call it."""
        self._inbox.put(action)

    def steer(self, action: Callable[[], None]) -> None:
        """As ``inject``, and at once where time stands in the middle of a moment; for the pace."""
        self._inbox.put(action, steers=True)

    def give(self, action: Callable[[], None]) -> None:
        """Have an input carried out at the end of the moment the run has reached; any thread may call this.

        By then every deadline of the moment is served, each thread waits and ``before_jump`` was called, and
        the inputs given before have had all their effects on that moment. A long moment takes one input in
        each recess. So the moments and recesses of its inputs and their order determine a run, whatever their
        real times were: ``give_at`` repeats it. The action must not wait.
        """
        self._inputs.given.append(action)
        self._inbox.ring()

    def give_at(self, moment: int, action: Callable[[], None], recess: int = 0) -> None:
        """Have an input carried out at the end of ``moment``, or in a recess of it.

        Call it in the order of the moments and recesses.
        """
        self._inputs.scheduled.append((moment, recess, action))

    def interrupt(self, thread: int) -> None:
        """Raise KeyboardInterrupt out of a thread's wait, its present or its next one."""

        def knock() -> None:
            for each in self._threads:
                if each.ident == thread:
                    each.knocked = True
                    self.unpark(each)

        if self.owns_current_thread():
            knock()
        else:
            self.inject(knock)

    def set_speed(self, speed: float | None) -> None:
        """Pass ``speed`` virtual seconds per real second, None: all it can. Call it through ``steer``."""
        self.pace.set_speed(speed, self._now)

    def pause(self) -> None:
        """Stop time at the moment the run has reached; call through ``steer``."""
        self.pace.stand()

    def resume(self) -> None:
        """Let time go on after ``pause``; call through ``steer``."""
        self.pace.go_on(self._now)

    def step(self) -> None:
        """Go on until time has jumped or ``halt`` is called, and let time stand; call through ``steer``."""
        self.pace.step()

    def run_until(self, moment: int) -> None:
        """Hurry until everything up to ``moment`` has happened, and let time stand there.

        Call it through ``steer``.
        """
        self.pace.hurry(moment)

    def halt(self) -> None:
        """Let time stand right here, in the middle of this moment, until it is steered on.

        Call it on the thread that has the baton. It may hold locks: no other thread of the run goes on.
        """
        if self._stopping:
            return
        self.pace.halt()
        self.in_moment = self.pace.stands
        with self._together():
            while self.pace.stands:
                self._inbox.steer(lambda: self.pace.stands)
                if self.pace.stands:
                    self._inbox.rest(None)
        self.in_moment = False

    def stop(self) -> None:
        """End the run: every wait, now and later, raises. Call it from ``call_at`` or ``inject``."""
        self._stopping = True
        self._inputs.scheduled.clear()
        self.pace.go_on(self._now)
        for thread in sorted(self._threads, key=lambda each: (not each.is_main, each.current_wait)):
            self.unpark(thread)

    def _stopped(self) -> bool:
        return self._stopping

    def _raise_knock(self, me: VirtualThread) -> None:
        if me.knocked:
            me.knocked = False
            raise KeyboardInterrupt

    def _wind_up(self, me: VirtualThread) -> bool:
        if not me.is_main:
            raise Stopped
        if not me.interrupted:
            me.interrupted = True
            raise KeyboardInterrupt
        self._ready.append(me)
        self._hand_on(me)
        return False

    def _retire(self, thread: VirtualThread) -> None:
        self._threads.discard(thread)
        self._schedule.forget(thread)
        if self._threads:
            self._pass_baton(self._next_thread())

    def _hand_on(self, me: VirtualThread) -> None:
        recesses = self._recesses
        recesses.steps += 1
        if recesses.steps >= recesses.due and not self._stopping:
            with self._together():
                self._take_recess()
        following = self._next_thread()
        if following is not me:
            self._pass_baton(following)
            me.gate.acquire()

    def _pass_baton(self, following: VirtualThread) -> None:
        self.current = following
        following.gate.release()

    def _next_thread(self) -> VirtualThread:
        if not self._ready:
            with self._together():
                self._await_ready()
        place = 0 if self._stopping else self._schedule.next(self._ready)
        following = self._ready[place]
        del self._ready[place]
        return following

    def _await_ready(self) -> None:
        while not self._ready:
            self._jump()
            if self.explores:
                self._serve_equals()

    @contextmanager
    def _together(self) -> Generator[None, None, None]:
        """Meanwhile the thread that has the baton is not left, whoever asks: it sees to the clock itself."""
        self.held_together += 1
        try:
            yield
        finally:
            self.held_together -= 1

    def _take_recess(self) -> None:
        """Do what is done at the end of a moment, but for letting time pass."""
        number = self._recesses.begin()
        self.before_jump()
        self.on_recess(number)
        self._input_is_taken()
        if self.pace.steps:
            self.pace.halt()
        self._inbox.empty()
        while self.pace.stands and not self._inputs.given:
            self._inbox.rest(None)
            self._inbox.empty()
        self._recesses.end()
        if self.idles:
            self._now = min([self._now + RECESS, *self._deadlines.later_than(self._now)])

    def _come_to(self, moment: int) -> None:
        if moment > self._now:
            self._now = moment
            self._recesses.begin_moment()

    def _jump(self) -> None:
        """Bring time to the next deadline, or to where something from outside makes a thread able to run."""
        deadline = self._deadlines.first()
        target = deadline
        if deadline is None or deadline > self._now:
            target = self._stopover_before(deadline)
            if not self._inbox.waiting and self._input_is_taken():
                return
            if self._inputs.scheduled:
                moment, *_ = self._inputs.scheduled[0]
                target = moment if target is None else min(moment, target)
            if self._goal_is_reached_before(target):
                return
        if not self._pass_time(target):
            return
        assert target is not None
        if target > self._now:
            self._come_to(target)
            if self.pace.steps:
                self.halt()
        if target == deadline:
            self._serve_deadline()

    def _stopover_before(self, deadline: int | None) -> int | None:
        stopover = self.before_jump()
        if stopover is None or stopover <= self._now:
            return deadline
        return stopover if deadline is None else min(stopover, deadline)

    def _input_is_taken(self) -> bool:
        """Carry out one input, if there is one for the end of the moment or its recess."""
        inputs = self._inputs
        if not (inputs.given or inputs.scheduled):
            return False
        action = inputs.take(self._now, self.recess)
        if action is not None and not self._stopping:
            action()
        return action is not None

    def _goal_is_reached_before(self, target: int | None) -> bool:
        goal = self.pace.goal_before(target)
        if goal is not None:
            self._come_to(goal)
        elif target is not None or not self.pace.steps:
            return False
        self.pace.halt()
        return True

    def _serve_deadline(self) -> None:
        _, _, due = self._deadlines.take()
        if isinstance(due, VirtualThread):
            due.waiting = False
            self._ready.append(due)
        else:
            due()

    def _serve_equals(self) -> None:
        """Let all threads go on whose deadline is this moment, up to the next action."""
        while self._deadlines.first() == self._now and self._deadlines.first_is_thread():
            self._serve_deadline()

    def _pass_time(self, target: int | None) -> bool:
        """Wait as long as the pace wants; False if something from outside came first.

        What was injected has been done then; an input comes when the moment that the run has reached ends.
        """
        while not self._inbox.waiting:
            if target is not None and target <= self._now:
                return True  # the moment goes on to its end, even if time stands
            if self._inputs.given:
                break
            works = self.outside_works()
            self.pace.keep_real(works, self._now)
            delay = self.pace.delay_until(target)
            if delay is not None and delay <= 0:
                return True
            self._inbox.rest(min(delay, _LOOK) if works and delay is not None else delay)
        self._come_to(self.pace.reached(self._now, target))
        self._inbox.empty()
        return False


def _nobody(*_what: object) -> None:
    """Stand in for a listener, or for a question that nobody answers."""


def _no() -> bool:
    """Stand in for a question that nobody answers."""
    return False
