import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.pub = self.create_publisher(String, "chatter", 10)
        self.create_timer(0.5, lambda: self.pub.publish(String(data="hello")))


class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.create_subscription(String, "chatter", self.on_chatter, 10)

    def on_chatter(self, msg):
        self.get_logger().info(f"heard {msg.data}")


def main():
    rclpy.init()
    rclpy.spin(Talker())
    rclpy.spin(Listener())


main()
