import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Seats(Node):
    def __init__(self):
        super().__init__("seats")
        self.free = 1
        group = ReentrantCallbackGroup()
        self.create_timer(0.1, self.ann, callback_group=group)
        self.create_timer(0.1, self.bob, callback_group=group)

    def ann(self):
        self.take("ann")

    def bob(self):
        self.take("bob")

    def take(self, who):
        if self.free > 0:
            self.get_logger().info(f"{who} takes a seat")
            self.free -= 1
            assert self.free >= 0, "sold twice"


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Seats())
    executor.spin()


if __name__ == "__main__":
    main()
