"""rclpy's clocks, jumps of their time, and the schedule of timers on ROS time."""
