"""A packer that awaits its labels, in an area of its own.

The callback that packs keeps its group while it awaits the label. The
watch on the belt is in another group, so it goes on.
"""

import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

WATCH_PERIOD = 0.25  # seconds
PACK_PERIOD = 3.9  # seconds
PRINT_TIME = 2.0  # seconds that a label takes


class Packer(Node):
    """Watches a belt, and packs a box with a label now and then."""

    def __init__(self):
        super().__init__("packer")
        # The printer and its client have areas of their own.
        self.printer_group = MutuallyExclusiveCallbackGroup()
        self.client_group = MutuallyExclusiveCallbackGroup()
        self.srv = self.create_service(
            SetBool,
            "/print_label",
            self.print_label_callback,
            callback_group=self.printer_group,
        )
        self.client = self.create_client(
            SetBool, "/print_label", callback_group=self.client_group
        )
        # Who awaits keeps the seat, so each of these has one.
        self.watch_group = MutuallyExclusiveCallbackGroup()
        self.pack_group = MutuallyExclusiveCallbackGroup()
        self.watch_timer = self.create_timer(
            WATCH_PERIOD, self.watch_callback, callback_group=self.watch_group
        )
        self.pack_timer = self.create_timer(
            PACK_PERIOD, self.pack_callback, callback_group=self.pack_group
        )

    # --- The three callbacks: the executor runs these ---

    def watch_callback(self):
        self.get_logger().info("BELT RUNS")

    async def pack_callback(self):
        self.get_logger().info("A label, please")
        request = SetBool.Request(data=True)
        # Leaves the thread here, and goes on when the label is there.
        answer = await self.client.call_async(request)
        self.get_logger().info(f"PACKED with {answer.message}")

    def print_label_callback(self, _request, response):
        self.get_logger().info("PRINTING")
        time.sleep(PRINT_TIME)
        response.success = True
        response.message = "LABEL"
        return response


def main(args=None):
    rclpy.init(args=args)
    node = Packer()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
