"""Names that programs import from rclpy's inside."""
