"""Time for everything that runs: one small interface, and the real and the virtual clock behind it."""

from sim.clock.interface import Clock, Signal, Stopped
from sim.clock.real import RealClock
from sim.clock.virtual import VirtualClock

__all__ = ["Clock", "RealClock", "Signal", "Stopped", "VirtualClock"]
