"""Ends a run: the first cause counts, the program is interrupted, and the process exits in time."""

import os
import signal
import sys
import threading
import time
from functools import partial
from typing import NoReturn

from sim.clock import RunClock, VirtualClock
from sim.engine.failures.cause import Cause
from sim.engine.outbox import Outbox
from sim.engine.programs.ending import GRACE, VIRTUAL_GRACE, flush_files_soon
from sim.engine.programs.program import STOPPED, ProgramOutcome, threads_left_by
from sim.engine.programs.programs import ProgramSupervisor
from sim.engine.programs.starting import ProgramStarter
from sim.engine.stdio.descriptors import Descriptors
from sim.engine.stdio.output import finish_lines
from sim.engine.time_control import RealControl, VirtualControl
from sim.engine.watchdogs.endless_waits import EndlessWaits
from sim.probes import own_code
from sim.ros.middleware.host import Host
from sim.trace.events import Notice, NoticeKind, RunEnding, Severity

_MOST_NAMED = 3
"""Threads that are named of those that keep a program from ending."""
_SIGNAL_AFTER = 0.5
"""Real seconds after which a program on virtual time that does not wait is interrupted by a signal."""

# Kept from before a clock or a program replaces them.
_real_sleep = time.sleep
_allocate_lock = threading.Lock


class RunShutdown:
    """Ends a run. Thread-safe: a command, a watchdog, the clock or the program itself may request it."""

    def __init__(
        self,
        title: str,
        clock: RunClock,
        host: Host,
        outbox: Outbox,
        control: RealControl | VirtualControl,
        programs: ProgramSupervisor,
        starter: ProgramStarter,
        descriptors: Descriptors,
        endless: EndlessWaits | None,
    ) -> None:
        self._title = title
        self._clock = clock
        self._virtual = clock if isinstance(clock, VirtualClock) else None
        self._host = host
        self._outbox = outbox
        self._control = control
        self._programs = programs
        self._starter = starter
        self._descriptors = descriptors
        self._endless = endless
        self._cause: Cause | None = None
        self._leaves = _allocate_lock()
        self._exit_process = os._exit  # from before the crash dump replaces it
        self._grace_begins = threading.Semaphore(0)

    def start(self) -> None:
        """Start the thread that makes the process exit soon after the run's end."""
        threading.Thread(target=self._end_in_time, name="grace", daemon=True).start()

    @property
    def has_begun(self) -> bool:
        """Whether there is a cause to end."""
        return self._cause is not None

    def fail(self, sentence: str) -> None:
        """End the run as a failure."""
        self.request(Cause(sentence, failed=True))

    def stop(self) -> None:
        """End the run on request."""
        self.request(Cause(STOPPED, failed=False))

    def time_is_up(self) -> None:
        """End the run because its time is up."""
        failures = self._programs.failures
        sentence = "; ".join(["its time was up", *(each.sentence for each in failures[:1])])
        first = failures[0] if failures else ProgramOutcome(sentence, failed=False)
        self.request(Cause(sentence, bool(failures), first.error, first.failure, time_was_up=True))

    def request(self, cause: Cause) -> None:
        """End the program as Ctrl-C would, and with it the run; by force if that takes too long."""
        self._grace_begins.release()
        if self.conclude(cause):
            self._outbox.record(RunEnding(self._clock.now(), cause.reason))
            self._control.let_go()
            if self._virtual is None:
                self._interrupt()
            elif self._virtual.owns_current_thread():
                self._interrupt_on(self._virtual)
            else:
                self._virtual.time.inject(partial(self._interrupt_on, self._virtual))

    def hurry(self) -> None:
        """Begin the grace period, and let paused time pass: a request to stop is on its way."""
        self._grace_begins.release()
        self._control.let_go()

    def conclude(self, cause: Cause) -> bool:
        """Set the cause of the run's end and return True; return False if there is one already."""
        if self._cause is not None:
            return False
        self._cause, self._host.catches_up = cause, False
        if self._endless is not None:
            self._endless.finish()
        if self._host.overrides is not None and not cause.failed:
            with self._host.lock:
                for sentence in self._host.overrides.unmatched():
                    self._tell(Severity.WARN, sentence, NoticeKind.UNMATCHED)
        return True

    def finish(self, outcome: ProgramOutcome) -> NoReturn:
        """Exit once the program has ended; it may have failed after a request to end."""
        cause = Cause(outcome.sentence, outcome.failed, outcome.error, outcome.failure)
        if not self.conclude(cause) and outcome.failed and outcome not in self._programs.failures:
            self._tell(Severity.ERROR, outcome.sentence, NoticeKind.RAISED_AT_END)
        finish_lines()
        self.leave()

    def end_computation(self, clock: VirtualClock, sentence: str) -> None:
        """End a program with a thread that does not wait: the main thread by a signal, another by force."""
        if not self.conclude(Cause(sentence, failed=True)):
            return
        self._outbox.record(RunEnding(clock.now(), sentence))
        if not clock.current.is_main:
            flush_files_soon()
            self.leave()
        clock.time.inject(partial(self._limit_ending, clock))
        clock.time.inject(self._programs.end_contexts)
        self._grace_begins.release()
        _signal_main()

    def leave(self) -> NoReturn:
        """Send the cause as the last event, and exit the process. Any thread may call this."""
        if not self._leaves.acquire(blocking=False):
            while True:
                _real_sleep(GRACE)  # another thread does it
        self._descriptors.finish()
        cause = self._cause or Cause(STOPPED, failed=False)
        self._outbox.close(cause.event(self._clock.now()))
        self._starter.close()
        self._exit_process(0)

    def _interrupt(self) -> None:
        try:
            self._programs.end_contexts()
        finally:
            _signal_main()

    def _interrupt_on(self, clock: VirtualClock) -> None:
        self._limit_ending(clock)
        self._programs.end_contexts()
        clock.interrupt(threading.main_thread().ident or 0)

    def _limit_ending(self, clock: VirtualClock) -> None:
        clock.time.resume()
        clock.time.set_speed(None)
        clock.call_at(clock.now() + VIRTUAL_GRACE, partial(self._end_by_force, VIRTUAL_GRACE / 1e9))

    def _end_in_time(self) -> None:
        """Wait, on a thread outside the clock, for the run's end; exit the process after the grace period."""
        self._grace_begins.acquire()
        _real_sleep(_SIGNAL_AFTER)
        if self._virtual is not None and self._main_computes_on(self._virtual):
            self.conclude(Cause(STOPPED, failed=False))
            _signal_main()
        _real_sleep(GRACE - _SIGNAL_AFTER)
        self._end_by_force(GRACE)

    def _main_computes_on(self, clock: VirtualClock) -> bool:
        """Return whether the main thread has not waited since it was to be interrupted at a wait."""
        main = clock.current
        computes = main.is_main and not clock.time.rests and (main.interrupted or self._cause is None)
        main.interrupted = main.interrupted and not computes
        return computes

    def _end_by_force(self, seconds: float) -> None:
        self.conclude(Cause(STOPPED, failed=False))
        text = f"{self._title} had not ended {seconds:g} s after it was told to{self._blocking_threads()}"
        self._tell(Severity.WARN, f"{text}: it was ended by force")
        try:
            flush_files_soon()
        finally:
            self.leave()

    def _blocking_threads(self) -> str:
        """Return which threads keep the program from ending, as " (worker: node.py:12, in work)"."""
        frames = sys._current_frames()
        left = [thread for process in self._programs.processes for thread in threads_left_by(process)]
        threads = dict.fromkeys((threading.main_thread(), *left))
        places = ((each.name, own_code.place_of(frames.get(each.ident or 0))) for each in threads)
        told = [f"{name}: {place}" for name, place in places if place]
        return f" ({'; '.join(told[:_MOST_NAMED])})" if told else ""

    def _tell(self, severity: Severity, sentence: str, kind: NoticeKind = NoticeKind.OTHER) -> None:
        self._outbox.record(Notice(self._clock.now(), severity, sentence, kind=kind))


def _signal_main() -> None:
    main = threading.main_thread().ident
    assert main is not None
    signal.pthread_kill(main, signal.SIGINT)
