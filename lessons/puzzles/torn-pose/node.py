import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Pose(Node):
    def __init__(self):
        super().__init__("pose")
        self.x = self.y = 0
        group = ReentrantCallbackGroup()
        self.create_timer(0.1, self.move, callback_group=group)
        self.create_timer(0.1, self.look, callback_group=group)

    def move(self):
        self.x += 1
        self.y += 1

    def look(self):
        x = self.x
        y = self.y
        assert x == y, f"seen at ({x}, {y})"


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Pose())
    executor.spin()


if __name__ == "__main__":
    main()
