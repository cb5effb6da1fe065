"""``launch_yaml.launch_description_sources``."""

from sim.launch.launch.launch_description_sources import FrontendLaunchDescriptionSource

__all__ = ["YAMLLaunchDescriptionSource"]

YAMLLaunchDescriptionSource = FrontendLaunchDescriptionSource
"""A launch file in YAML."""
