import queue

import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32


class Sorter(Node):
    def __init__(self):
        super().__init__("sorter")
        self.items = queue.Queue()
        self.publisher = self.create_publisher(Int32, "raw", 10)
        self.create_subscription(Int32, "raw", self.on_raw, 10)
        self.create_timer(0.2, self.feed)
        self.create_timer(0.5, self.work)

    def feed(self):
        self.publisher.publish(Int32(data=1))

    def on_raw(self, msg):
        self.items.put(msg.data)

    def work(self):
        first, second, third = (self.items.get() for _ in range(3))
        self.get_logger().info(f"{first} {second} {third}")


def main():
    rclpy.init()
    rclpy.spin(Sorter())


if __name__ == "__main__":
    main()
