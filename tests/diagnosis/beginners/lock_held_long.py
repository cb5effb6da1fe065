import threading
import time

import rclpy
from geometry_msgs.msg import Pose
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup as Exclusive
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Slam(Node):
    def __init__(self):
        super().__init__("slam")
        self.lock = threading.Lock()
        self.pose = Pose()
        self.publisher = self.create_publisher(Pose, "pose", 10)
        self.create_timer(0.05, self.move, callback_group=Exclusive())
        group = Exclusive()
        self.create_subscription(Pose, "pose", self.on_pose, 5, callback_group=group)
        self.create_timer(0.2, self.blink, callback_group=group)
        self.create_timer(0.3, self.check, callback_group=Exclusive())
        self.create_timer(1.5, self.optimise, callback_group=Exclusive())

    def move(self):
        self.publisher.publish(Pose())

    def on_pose(self, pose):
        with self.lock:
            self.pose = pose

    def check(self):
        with self.lock:
            self.get_logger().info(f"at {self.pose.position.x}")

    def optimise(self):
        with self.lock:
            time.sleep(1.2)

    def blink(self):
        self.get_logger().info("on")


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=6)
    executor.add_node(Slam())
    executor.spin()


if __name__ == "__main__":
    main()
