import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        group = ReentrantCallbackGroup()
        self.opened, self.ready = threading.Event(), threading.Event()
        self.client = self.create_client(Trigger, "grip", callback_group=group)
        self.create_service(Trigger, "grip", self.on_grip, callback_group=group)
        self.starting = self.create_timer(0.5, self.go, callback_group=group)
        self.opening = self.create_timer(0.7, self.open, callback_group=group)

    def go(self):
        self.starting.cancel()
        self.opened.wait()
        self.ready.set()

    def open(self):
        self.opening.cancel()
        self.client.call(Trigger.Request())
        self.opened.set()

    def on_grip(self, request, response):
        self.ready.wait()
        return response


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(6)
    executor.add_node(Robot())
    executor.spin()


if __name__ == "__main__":
    main()
