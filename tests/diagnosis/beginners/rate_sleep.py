import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.rate = self.create_rate(10)
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_subscription(String, "chatter", self.on_chatter, 10)
        self.create_timer(0.5, self.tick)

    def on_chatter(self, message):
        self.get_logger().info(message.data)

    def tick(self):
        for number in range(5):
            self.publisher.publish(String(data=f"hello {number}"))
            self.rate.sleep()


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
