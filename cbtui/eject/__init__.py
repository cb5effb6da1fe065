"""Writes lessons as ROS 2 packages that ``colcon build`` takes."""
