"""Three ways to ask a service from a timer.

One leaves the reply to a callback of its own, one awaits it, and one
waits for it in call().
"""

import time

import rclpy
from rclpy.callback_groups import (
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

ASK_PERIOD = 1.0  # seconds
WEIGH_TIME = 1.5  # seconds: longer than the period


class Scales(Node):
    """Weighs as many parcels at a time as there are threads."""

    def __init__(self):
        super().__init__("scales")
        self.srv = self.create_service(
            SetBool,
            "/weigh",
            self.weigh,
            callback_group=ReentrantCallbackGroup(),
        )

    def weigh(self, _request, response):
        time.sleep(WEIGH_TIME)
        response.success = True
        response.message = "2 KG"
        return response


class Askers(Node):
    """Three timers that ask for a weight, each in its own way."""

    def __init__(self):
        super().__init__("askers")
        # Replies come in here, so no asker is in their way.
        self.scales = self.create_client(
            SetBool, "/weigh", callback_group=ReentrantCallbackGroup()
        )
        self.leave_timer = self.add_asker(self.ask_and_leave)
        self.await_timer = self.add_asker(self.ask_and_await)
        self.wait_timer = self.add_asker(self.ask_and_wait)

    def add_asker(self, callback):
        """Return a timer in an exclusive group of its own."""
        group = MutuallyExclusiveCallbackGroup()
        return self.create_timer(ASK_PERIOD, callback, callback_group=group)

    # --- Cure 1: leave, and let a done callback take the reply ---

    def ask_and_leave(self):
        future = self.scales.call_async(SetBool.Request(data=True))
        future.add_done_callback(self.on_reply)

    def on_reply(self, future):
        self.report("LEAVE", future.result())

    # --- Cure 2: a coroutine that steps aside until the reply is there ---

    async def ask_and_await(self):
        reply = await self.scales.call_async(SetBool.Request(data=True))
        self.report("AWAIT", reply)

    # --- Cure 3: wait here; others have groups and threads to go on ---

    def ask_and_wait(self):
        reply = self.scales.call(SetBool.Request(data=True))
        self.report("WAIT", reply)

    def report(self, way, reply):
        self.get_logger().info(f"{way}: {reply.message}")


def main(args=None):
    rclpy.init(args=args)
    nodes = [Scales(), Askers()]
    executor = MultiThreadedExecutor(num_threads=6)
    for node in nodes:
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()
        for node in nodes:
            node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
