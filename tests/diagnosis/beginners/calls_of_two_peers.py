"""Two nodes that call each other from timers; each answers in the group of its timer, on two threads."""

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


class Peer(Node):
    def __init__(self, name: str, other: str) -> None:
        super().__init__(name)
        group = MutuallyExclusiveCallbackGroup()
        self.client = self.create_client(Trigger, f"{other}/state", callback_group=group)
        self.create_service(Trigger, f"{name}/state", self.on_state)
        self.create_timer(1.0, self.tick)

    def on_state(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success = True
        return response

    def tick(self) -> None:
        self.client.call(Trigger.Request())


def main() -> None:
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(Peer("left", "right"))
    executor.add_node(Peer("right", "left"))
    executor.spin()


main()
