import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node


class Journal(Node):
    def __init__(self):
        super().__init__("journal")
        self.open = False
        group = ReentrantCallbackGroup()
        self.create_timer(0.1, self.rotate, callback_group=group)
        self.create_timer(0.1, self.write, callback_group=group)

    def rotate(self):
        self.open = True
        self.open = False

    def write(self):
        if self.open:
            assert self.open, "closed meanwhile"


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Journal())
    executor.spin()


if __name__ == "__main__":
    main()
