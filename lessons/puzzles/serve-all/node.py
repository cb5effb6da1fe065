import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32


class Kitchen(Node):
    def __init__(self):
        super().__init__("kitchen")
        self.served = 0
        self.sent = self.create_publisher(Int32, "orders", 1)
        group = ReentrantCallbackGroup()
        self.create_subscription(Int32, "orders", self.serve, 1, callback_group=group)
        self.create_timer(0.1, self.order, callback_group=group)

    def order(self):
        for number in (1, 2):
            self.sent.publish(Int32(data=number))

    def serve(self, order):
        self.served += 1
        if self.served == 2:
            self.get_logger().info("both served")


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(Kitchen())
    executor.spin()


if __name__ == "__main__":
    main()
