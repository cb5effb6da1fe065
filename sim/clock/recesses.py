"""Recesses: where a moment of virtual time that does not end by itself can be stopped and given inputs."""

WAITS_TO_RECESS = 1_000
"""Waits between two recesses of a moment."""
RECESS = 1_000
"""Nanoseconds that a recess lasts at most; a float of the seconds since 1970 can tell 238."""


class Recesses:
    """Counts the waits of threads (``steps``), and of one moment its recesses and its waits for no time."""

    def __init__(self) -> None:
        self.steps = 0
        self.current = 0
        """Which recess of its moment the run is in; 0: none."""
        self.idle_waits = 0
        self._taken = 0
        self.due = WAITS_TO_RECESS
        """How many steps it takes to the next recess."""

    @property
    def idles(self) -> bool:
        """Whether most of the waits in this moment up to its last recess were for no time."""
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
        """Begin to count anew: time has passed."""
        self._taken = self.idle_waits = 0
        self.due = self.steps + WAITS_TO_RECESS
