import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Settings(Node):
    def __init__(self):
        super().__init__("settings")
        self.publisher = self.create_publisher(String, "settings", 10)
        self.publisher.publish(String(data="slow"))


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.settings = None
        self.create_subscription(String, "settings", self.on_settings, 10)
        self.create_timer(1.0, self.drive)

    def on_settings(self, message):
        self.settings = message.data

    def drive(self):
        self.get_logger().info(f"driving {self.settings}")


rclpy.init()
executor = rclpy.executors.SingleThreadedExecutor()
for node in (Settings(), Driver()):
    executor.add_node(node)
executor.spin()
