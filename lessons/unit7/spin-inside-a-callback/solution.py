"""A node that asks a store for parts, and awaits them.

The store is another node in the same program. The asker's callback is a
coroutine, so the executor that spins already brings the answer.
"""

import time

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

BLINK_PERIOD = 0.5  # seconds
ASK_PERIOD = 2.2  # seconds
SEARCH_TIME = 1.0  # seconds that the store needs to find a part


class Store(Node):
    """Hands out a part to whoever asks."""

    def __init__(self):
        super().__init__("store")
        self.srv = self.create_service(
            SetBool, "/get_part", self.get_part_callback
        )

    def get_part_callback(self, _request, response):
        time.sleep(SEARCH_TIME)
        self.get_logger().info("HERE IS A PART")
        response.success = True
        response.message = "PART"
        return response


class Asker(Node):
    """Blinks to show that it lives, and asks for a part now and then."""

    def __init__(self):
        super().__init__("asker")
        # One open area: no callback has to wait for a seat.
        self.group = ReentrantCallbackGroup()
        self.client = self.create_client(
            SetBool, "/get_part", callback_group=self.group
        )
        self.blink_timer = self.create_timer(
            BLINK_PERIOD, self.blink_callback, callback_group=self.group
        )
        self.ask_timer = self.create_timer(
            ASK_PERIOD, self.ask_callback, callback_group=self.group
        )

    # --- The two callbacks: the executor runs these ---

    def blink_callback(self):
        self.get_logger().info("BLINK")

    async def ask_callback(self):
        self.get_logger().info("A part, please")
        # Leaves the thread, and goes on when the answer has come.
        answer = await self.client.call_async(SetBool.Request(data=True))
        self.get_logger().info(f"GOT {answer.message}")


def main(args=None):
    rclpy.init(args=args)
    store = Store()
    asker = Asker()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(store)
    executor.add_node(asker)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()
        asker.destroy_node()
        store.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
