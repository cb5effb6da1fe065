"""Launch files in XML and YAML: their elements become the actions that files in Python create."""

from sim.launch.frontend.actions import actions_in

__all__ = ["actions_in"]
