"""What only programs need that reach into rclpy's compiled part."""
