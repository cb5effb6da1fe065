"""The launch_ros model: what ``import launch_ros`` gives a launch file. Module names mirror launch_ros's."""
