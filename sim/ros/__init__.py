"""A model of rclpy: the same names, the same order of callbacks, and a trace that explains every wait."""
