"""What runs: clocks, the rclpy model, the robot, the engine and its trace."""
