import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool


class Store(Node):
    def __init__(self):
        super().__init__("store")
        self.lock = threading.Lock()
        self.count = 0
        group = ReentrantCallbackGroup()
        self.create_service(SetBool, "book", self.book, callback_group=group)
        self.client = self.create_client(SetBool, "book", callback_group=group)
        self.create_timer(0.5, self.sell, callback_group=group)

    def book(self, request, response):
        with self.lock:
            self.count += 1
        response.success = True
        return response

    def sell(self):
        with self.lock:
            self.count -= 1
            self.client.call(SetBool.Request(data=True))
        self.get_logger().info("sold one")


def main():
    rclpy.init()
    node = Store()
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    executor.spin()


if __name__ == "__main__":
    main()
