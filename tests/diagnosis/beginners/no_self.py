import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_subscription(String, "chatter", self.on_chatter, 10)
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.publisher.publish(String(data="hello"))

    def on_chatter():
        print("heard something")


def main():
    rclpy.init()
    rclpy.spin(Robot())


if __name__ == "__main__":
    main()
