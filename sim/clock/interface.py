"""The interface of clocks: the time, sleeping, auto-reset events, and threads on the clock's time."""

from collections.abc import Callable
from typing import Protocol


class AutoResetEvent(Protocol):
    """An auto-reset event: one thread waits, any thread sets it, and a successful wait clears it."""

    def wait(self, deadline: int | None) -> bool:
        """Wait until the flag is set or the clock shows ``deadline`` nanoseconds; False: deadline passed."""

    def set(self) -> None:
        """Set the flag and let the waiting thread go on. Any thread may call it."""


class RunClock(Protocol):
    """Nanoseconds since the run began, and the ways to wait for them. Thread-safe."""

    @property
    def epoch(self) -> int:
        """Nanoseconds since 1970 at which the run began: ``epoch + now()`` is what log lines show."""

    def now(self) -> int:
        """Nanoseconds since the run began; never goes back."""

    @property
    def turn(self) -> int:
        """Another number once the running thread has waited, or may have been left for another one."""

    @property
    def able(self) -> int:
        """How many threads can run as soon as the running one lets them, where they take turns; else 0."""

    def sleep(self, duration: int) -> None:
        """Let ``duration`` nanoseconds pass on the calling thread."""

    def auto_reset_event(self) -> AutoResetEvent:
        """A new event, not set."""

    def choose(self, number: int) -> int:
        """Which of ``number`` equals gets what they all wait for: 0, the oldest, unless orders are explored.

        Call it with a lock held that keeps others from calling it.
        """

    def start_thread(self, target: Callable[[], None], name: str) -> None:
        """Run ``target`` on a new daemon thread called ``name`` that lives on this clock's time."""

    def switch_point(self) -> None:
        """Let another thread go first, where orders are explored and the schedule wants it.

        The calling thread must hold nothing that others wait for outside this clock.
        """

    def poll(self) -> None:
        """Tell that the calling thread asked for something that takes no time, and goes on at once.

        Where computing takes no time, a loop that does nothing else ends so once its deadline is over. The
        calling thread must hold nothing that others wait for outside this clock.
        """

    def end_thread(self) -> None:
        """Tell that the calling thread comes to its end now, without waiting: others are about to join it."""

    def interrupt(self, thread: int) -> None:
        """Raise KeyboardInterrupt in a thread (its ``get_ident``) once it waits or goes on, as Ctrl-C would.

        Any thread may call it; nothing happens if that thread has ended.
        """

    def call_at(self, time: int, action: Callable[[], None]) -> None:
        """Run ``action`` at ``time`` nanoseconds, on whichever thread is at hand; it must not wait."""
