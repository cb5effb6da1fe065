import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Doors(Node):
    def __init__(self):
        super().__init__("doors")
        self.visitors = 0
        group = ReentrantCallbackGroup()
        self.create_timer(0.1, self.left, callback_group=group)
        self.create_timer(0.1, self.right, callback_group=group)
        self.create_timer(0.15, self.audit)

    def left(self):
        visitors = self.visitors
        self.visitors = visitors + 1

    def right(self):
        visitors = self.visitors
        self.visitors = visitors + 1

    def audit(self):
        assert self.visitors == 2, f"{self.visitors} of 2 visitors counted"


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Doors())
    executor.spin()


if __name__ == "__main__":
    main()
