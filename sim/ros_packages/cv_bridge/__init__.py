"""``cv_bridge``: images as numpy arrays. OpenCV itself is not needed."""

from sim.ros_packages.cv_bridge.core import CvBridge, CvBridgeError

__all__ = ["CvBridge", "CvBridgeError"]
