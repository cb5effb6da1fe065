from threading import Lock

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


class Camera(Node):
    def __init__(self):
        super().__init__("camera")
        self.lock = Lock()
        taking = MutuallyExclusiveCallbackGroup()
        self.storage = self.create_client(Trigger, "store", callback_group=MutuallyExclusiveCallbackGroup())
        self.create_service(Trigger, "store", self.store, callback_group=MutuallyExclusiveCallbackGroup())
        self.create_timer(1.0, self.take_picture, callback_group=taking)

    def take_picture(self):
        with self.lock:
            self.storage.call(Trigger.Request())

    def store(self, request, response):
        with self.lock:
            response.success = True
        return response


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Camera())
    executor.spin()


if __name__ == "__main__":
    main()
