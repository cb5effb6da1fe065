"""The robot's names on the network."""

from sim.trace.events import ROBOT_SERVICES, SENSOR_TOPICS, VELOCITY_TOPIC

NAMES = (*SENSOR_TOPICS, VELOCITY_TOPIC, *ROBOT_SERVICES)
"""The robot's topics and services."""


def own_sensor(topic: str) -> str:
    """What is said when a program publishes one of the robot's topics."""
    return f"the program publishes {topic} itself, so the lessons' robot stays out"
