"""Domains: nodes of different domains on one machine do not see each other."""

import os
from collections.abc import Mapping

from sim.ros.exceptions import RCLError

DOMAIN_VARIABLE = "ROS_DOMAIN_ID"


def domain_of(environment: Mapping[str, str]) -> int:
    """The domain id of an environment; 0 by default.

    Raises:
        RCLError: ``ROS_DOMAIN_ID`` is not a number, or is negative.
    """
    text = environment.get(DOMAIN_VARIABLE, "").strip()
    if not text:
        return 0
    if not text.isdecimal():
        raise RCLError(f"failed to initialize rcl: {DOMAIN_VARIABLE} is not an integral number: {text!r}")
    return int(text)


def domain_of_machine() -> int:
    """The domain id outside of programs; 0 if the environment has no valid one."""
    try:
        return domain_of(os.environ)
    except RCLError:
        return 0
