"""The one rule for the names of parameters."""

from sim.ros.exceptions import InvalidParameterException


def validate_parameter_name(name: str) -> bool:
    """True; raises InvalidParameterException for an empty name."""
    if not name:
        raise InvalidParameterException(name)
    return True
