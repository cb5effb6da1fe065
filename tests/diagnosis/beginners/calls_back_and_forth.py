"""Two nodes, of which one calls the other's service from its timer, which calls back to answer."""

import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


class Peer(Node):
    def __init__(self, name: str, other: str) -> None:
        super().__init__(name)
        self.other = self.create_client(Trigger, f"{other}/ask")


class Asking(Peer):
    def __init__(self) -> None:
        super().__init__("alice", "bob")
        self.create_service(Trigger, "alice/ask", self.on_call_back)
        self.create_timer(1.0, self.begin)

    def begin(self) -> None:
        self.other.call(Trigger.Request())

    def on_call_back(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success = True
        return response


class Asked(Peer):
    def __init__(self) -> None:
        super().__init__("bob", "alice")
        self.create_service(Trigger, "bob/ask", self.on_ask)

    def on_ask(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        answer = self.other.call(Trigger.Request())
        response.success = answer.success
        return response


def main() -> None:
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(Asking())
    executor.add_node(Asked())
    executor.spin()


main()
