import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32, String


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.publisher = self.create_publisher(Int32, "chatter", 10)
        self.create_subscription(String, "chatter", self.on_chatter, 10)
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.publisher.publish(Int32(data=1))

    def on_chatter(self, message):
        self.get_logger().info(f"{message.data}")


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
