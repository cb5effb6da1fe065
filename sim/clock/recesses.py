"""Recesses: points in a long moment of virtual time at which a run can be paused and given inputs."""

WAITS_TO_RECESS = 1_000
"""Waits between two recesses of a moment."""
RECESS = 1_000
"""Nanoseconds that a recess lasts at most; a float of the seconds since 1970 has steps of 238 ns."""


class Recesses:
    """Counts the waits of threads (``steps``), and a moment's recesses and zero-length waits."""

    def __init__(self) -> None:
        self.steps = 0
        self.current = 0
        """The number of the recess that the run is in; 0 outside of a recess."""
        self.idle_waits = 0
        self._taken = 0
        self.due = WAITS_TO_RECESS
        """The number of steps at which the next recess begins."""

    @property
    def idles(self) -> bool:
        """Whether most waits in this moment, up to its last recess, had a length of 0."""
        return self.idle_waits * 2 > self._taken * WAITS_TO_RECESS

    def begin(self) -> int:
        """Begin a recess; return its number."""
        self._taken += 1
        self.due = self.steps + WAITS_TO_RECESS
        self.current = self._taken
        return self.current

    def end(self) -> None:
        """End the recess."""
        self.current = 0

    def begin_moment(self) -> None:
        """Restart the counts: time has passed."""
        self._taken = self.idle_waits = 0
        self.due = self.steps + WAITS_TO_RECESS
