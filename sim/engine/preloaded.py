"""Imports what every engine needs, in the process that engines are forked from."""

import sim.engine.process
import sim.robot.driver
import sim.robot.world
import sim.ros.actions
import sim.ros.internals.compiled
import sim.ros.lifecycle
import sim.ros.node  # noqa: F401
from sim.interfaces.jazzy import jazzy_tables

jazzy_tables()
