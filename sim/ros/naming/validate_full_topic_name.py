"""Checking the full name of a topic or service."""

from typing import Literal

from sim.ros.exceptions import InvalidServiceNameException, InvalidTopicNameException
from sim.ros.naming.rules import full_topic_name_problem


def validate_full_topic_name(name: str, *, is_service: bool = False) -> Literal[True]:
    """True for an absolute name with nothing left to expand.

    Raises:
        InvalidTopicNameException, InvalidServiceNameException: the name breaks the rules.
    """
    if (problem := full_topic_name_problem(name)) is not None:
        raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(name, *problem)
    return True
