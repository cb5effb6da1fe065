"""Launch files in XML and YAML: their elements are the actions that files in Python make."""

from sim.launch.frontend.actions import actions_in

__all__ = ["actions_in"]
