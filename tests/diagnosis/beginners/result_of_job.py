from concurrent.futures import ThreadPoolExecutor

import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Worker(Node):
    def __init__(self):
        super().__init__("worker")
        self.pool = ThreadPoolExecutor(1)
        self.create_service(Trigger, "fetch", self.fetch)
        self.client = self.create_client(Trigger, "fetch")
        self.create_timer(0.5, self.tick)

    def fetch(self, request, response):
        return response

    def work(self):
        self.client.call(Trigger.Request())

    def tick(self):
        self.pool.submit(self.work).result()
        self.get_logger().info("fetched")


def main():
    rclpy.init()
    rclpy.spin(Worker())


if __name__ == "__main__":
    main()
