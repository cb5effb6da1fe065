import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.ready = False
        self.create_subscription(String, "ready", self.on_ready, 10)
        self.publisher = self.create_publisher(String, "ready", 10)
        self.create_timer(0.5, self.tick)

    def on_ready(self, message):
        self.ready = True

    def tick(self):
        self.publisher.publish(String(data="yes"))
        while True:
            if self.ready:
                break
        self.get_logger().info("ready")


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
