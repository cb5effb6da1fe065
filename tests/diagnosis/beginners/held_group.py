import time

import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.create_subscription(String, "chatter", self.on_chatter, 10)
        self.create_timer(1.0, self.talk)
        self.create_timer(0.05, self.steer)

    def talk(self):
        self.publisher.publish(String(data="hello"))

    def on_chatter(self, message):
        self.get_logger().info("thinking")
        time.sleep(0.8)
        self.get_logger().info("thought")

    def steer(self):
        pass


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Robot())
    executor.spin()


if __name__ == "__main__":
    main()
