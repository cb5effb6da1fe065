import threading

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher = self.create_publisher(Int32, "count", 10)
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.publisher.publish(Int32(data=1))


class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.create_subscription(Int32, "count", self.hear, 10)

    def hear(self, msg):
        self.get_logger().info(str(msg.data))


def main():
    rclpy.init()
    talker = Talker()
    listener = Listener()
    one = SingleThreadedExecutor()
    other = SingleThreadedExecutor()
    one.add_node(talker)
    other.add_node(listener)
    other.add_node(talker)
    thread = threading.Thread(target=other.spin, daemon=True)
    one.spin()
    thread.start()


if __name__ == "__main__":
    main()
