"""The robot's names on the network."""

from sim.trace.events import ROBOT_SERVICES, SENSOR_TOPICS, VELOCITY_TOPIC

NAMES = (*SENSOR_TOPICS, VELOCITY_TOPIC, *ROBOT_SERVICES)
"""The robot's topics and services."""
