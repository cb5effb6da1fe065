import threading

import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Job(Node):
    def __init__(self):
        super().__init__("job")
        self.lock = threading.Lock()
        self.done = 0
        self.client = self.create_client(Trigger, "work")
        self.create_service(Trigger, "work", self.work)
        self.create_timer(1.0, self.ask)

    async def ask(self):
        with self.lock:
            reply = await self.client.call_async(Trigger.Request())
            self.get_logger().info(reply.message)

    def work(self, request, response):
        with self.lock:
            self.done += 1
            response.message = f"job {self.done}"
        return response


def main():
    rclpy.init()
    rclpy.spin(Job())


if __name__ == "__main__":
    main()
