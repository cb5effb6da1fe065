import time
from threading import Lock

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Arm(Node):
    def __init__(self):
        super().__init__("arm")
        self.joint_lock = Lock()
        self.log_lock = Lock()
        self.joint = 0
        self.lines = []
        group = ReentrantCallbackGroup()
        self.create_timer(0.2, self.move, callback_group=group)
        self.create_timer(0.2, self.report, callback_group=group)

    def write(self, line):
        with self.log_lock:
            self.lines.append(line)

    def step(self):
        self.joint += 1
        time.sleep(0.05)
        self.write(f"joint is {self.joint}")

    def move(self):
        with self.joint_lock:
            self.step()

    def report(self):
        with self.log_lock:
            time.sleep(0.05)
            with self.joint_lock:
                text = f"{len(self.lines)} lines, joint {self.joint}"
        self.get_logger().info(text)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Arm())
    executor.spin()


if __name__ == "__main__":
    main()
