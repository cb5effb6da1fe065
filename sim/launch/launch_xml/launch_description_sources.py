"""``launch_xml.launch_description_sources``."""

from sim.launch.launch.launch_description_sources import FrontendLaunchDescriptionSource

__all__ = ["XMLLaunchDescriptionSource"]

XMLLaunchDescriptionSource = FrontendLaunchDescriptionSource
"""A launch file in XML."""
