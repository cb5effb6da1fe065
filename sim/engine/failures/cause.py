"""Why a run ends, on the model and on real rclpy."""

from dataclasses import dataclass

from sim.engine.failures.failure import Failure
from sim.trace.events import Nanoseconds, RunEnded


@dataclass(frozen=True, slots=True)
class Cause:
    """Why a run or a program ends: a sentence, whether it failed, and the exception ("" for none).

    ``failure`` has the exception's source line and advice.
    """

    reason: str
    failed: bool
    error: str = ""
    failure: Failure | None = None
    time_was_up: bool = False

    def event(self, t: Nanoseconds) -> RunEnded:
        """Return the last event of a run that ends at ``t``."""
        found = self.failure or Failure("", 0, "")
        return RunEnded(
            t,
            self.reason,
            self.failed,
            self.time_was_up,
            self.error,
            (found.file, found.line),
            found.what,
            found.advice,
            found.exception,
        )
