"""Time for everything that runs: one small interface, and the clocks behind it."""

from sim.clock.interface import AutoResetEvent, RunClock
from sim.clock.paced import PacedClock
from sim.clock.virtual import VirtualClock

__all__ = ["RunClock", "PacedClock", "AutoResetEvent", "VirtualClock"]
