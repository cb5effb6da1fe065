"""The interface of clocks: the time, sleeping, auto-reset events, and threads on the clock's time."""

from collections.abc import Callable
from typing import Protocol


class AutoResetEvent(Protocol):
    """An auto-reset event: one thread waits, any thread sets it, and a successful wait clears it."""

    def wait(self, deadline: int | None) -> bool:
        """Wait until the event is set or ``deadline`` (nanoseconds) passes; False: the deadline passed."""

    def set(self) -> None:
        """Set the event, and let the waiting thread continue. Thread-safe."""


class RunClock(Protocol):
    """Nanoseconds since the run began, and the ways to wait for them. Thread-safe."""

    @property
    def epoch(self) -> int:
        """Nanoseconds since 1970 at which the run began: ``epoch + now()`` is what log lines show."""

    activity: Callable[[], object]
    """Called on a thread that takes a lock, which keeps what it returns: what the thread does then."""

    def now(self) -> int:
        """Nanoseconds since the run began; never goes back."""

    @property
    def turn(self) -> int:
        """A number that changes once the running thread has waited or may have been preempted."""

    @property
    def runnable(self) -> int:
        """How many threads can run as soon as the running one waits; 0 if threads do not take turns."""

    def sleep(self, duration: int) -> None:
        """Let ``duration`` nanoseconds pass on the calling thread."""

    def auto_reset_event(self) -> AutoResetEvent:
        """A new event, not set."""

    def races(self) -> bool:
        """Whether the threads of a pool race, or go on as they mostly do; False unless explored."""

    def choose(self, number: int) -> int:
        """The index of the one of ``number`` equal waiters that is served: 0, the oldest, unless explored.

        Call it with a lock held that keeps other threads from calling it.
        """

    def start_thread(self, target: Callable[[], None], name: str) -> None:
        """Run ``target`` on a new daemon thread called ``name``, on this clock's time."""

    def switch_point(self) -> None:
        """Let another thread run first, if orders are explored and the schedule decides so.

        The calling thread must hold nothing that other threads wait for outside this clock.
        """

    def poll(self) -> None:
        """Report that the calling thread polls something and continues at once.

        If computing takes no time, a polling loop so reaches its deadline. The
        calling thread must hold nothing that other threads wait for outside this clock.
        """

    def end_thread(self) -> None:
        """Report that the calling thread ends now, without waiting: other threads are about to join it."""

    def interrupt(self, thread: int) -> None:
        """Raise KeyboardInterrupt in a thread (its ``get_ident``) once it waits or runs, as Ctrl-C does.

        Thread-safe. Nothing happens if that thread has ended.
        """

    def call_at(self, time: int, action: Callable[[], None]) -> None:
        """Run ``action``, which must not wait, at ``time`` nanoseconds, on any thread."""
