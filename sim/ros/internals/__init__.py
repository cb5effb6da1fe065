"""The names of rclpy's compiled part; only programs that use these internals need this room."""
