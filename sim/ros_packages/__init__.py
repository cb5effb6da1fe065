"""Packages that nodes import besides rclpy; each folder is the ROS 2 package of that name."""
