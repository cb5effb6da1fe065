"""``cv_bridge``: images as numpy arrays, without OpenCV."""

from sim.ros_packages.cv_bridge.core import CvBridge, CvBridgeError

__all__ = ["CvBridge", "CvBridgeError"]
