"""Checking the name of a topic or service as a program writes it."""

from typing import Literal

from sim.ros.exceptions import InvalidServiceNameException, InvalidTopicNameException
from sim.ros.naming.rules import topic_name_problem


def validate_topic_name(name: str, *, is_service: bool = False) -> Literal[True]:
    """True for a name that can be expanded, such as ``~/x``, ``{node}/x``, ``x`` and ``/x``.

    Raises:
        InvalidTopicNameException, InvalidServiceNameException: the name breaks the rules.
    """
    if (problem := topic_name_problem(name)) is not None:
        raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(name, *problem)
    return True
