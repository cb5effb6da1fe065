import time

import rclpy
from nav_msgs.msg import Odometry
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class N(Node):
    def __init__(self):
        super().__init__("n")
        self.g1 = MutuallyExclusiveCallbackGroup()
        self.g2 = MutuallyExclusiveCallbackGroup()
        self.create_subscription(Odometry, "/odom", self.odom, 10, callback_group=self.g1)
        self.create_timer(1.0, self.slow, callback_group=self.g2)

    def odom(self, m):
        pass

    def slow(self):
        time.sleep(0.9)


def main():
    rclpy.init()
    n = N()
    ex = MultiThreadedExecutor(num_threads=4)
    ex.add_node(n)
    rclpy.spin(n)


if __name__ == "__main__":
    main()
