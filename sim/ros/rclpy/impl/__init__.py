"""``rclpy.impl``, as programs import it."""
