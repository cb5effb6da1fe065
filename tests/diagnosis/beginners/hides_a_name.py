import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.create_subscription(String, "/chatter", self.handle, 10)
        self.create_timer(0.5, self.tick)

    def handle(self, message):
        self.get_logger().info(message.data)

    def tick(self):
        self.get_logger().info("tick")


def main():
    rclpy.init()
    rclpy.spin(Listener())


if __name__ == "__main__":
    main()
