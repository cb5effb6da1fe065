"""Every event that a run can put on its trace: the one vocabulary of engine, files and screen.

A new kind of event is a new class in one of these modules; ``python -m tests.trace.events_page`` then writes
``EVENTS.md`` anew.
"""

from typing import TypeAlias

from sim.trace.events.callbacks import *
from sim.trace.events.communication import *
from sim.trace.events.event import *
from sim.trace.events.event import TraceEvent
from sim.trace.events.exploration import *
from sim.trace.events.fields import *
from sim.trace.events.graph import *
from sim.trace.events.packing import *
from sim.trace.events.robot import *
from sim.trace.events.run import *
from sim.trace.events.terminal import *

AnyEvent: TypeAlias = TraceEvent
"""An event of any kind."""
