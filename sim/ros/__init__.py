"""A model of rclpy: the same names, the same order of callbacks, and every reason for waiting on a trace."""
