"""Generated programs on real rclpy and on the model: the same calls, in the same order, at the same times."""
