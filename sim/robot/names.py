"""The robot's names: on the network, and of its thread."""

from sim.trace.events import ROBOT_SERVICES, VELOCITY_TOPIC

NAMES = ("/odom", "/scan", VELOCITY_TOPIC, *ROBOT_SERVICES)
"""The robot's topics and services."""

THREAD = "robot_driver"
"""The thread that drives it on the model."""
