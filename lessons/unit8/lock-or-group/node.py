"""Count boxes at two stations: one has a lock, the other a group.

Six boxes come at once, now to one station, now to the other. A lamp
blinks as long as a worker has time for it.
"""

import threading
import time

import rclpy
from rclpy.callback_groups import (
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

COUNTING = 0.5  # seconds that a box takes
BOXES = 6  # that come at once
LORRY_PERIOD = 5.0  # seconds from one lorry to the next
BLINK_PERIOD = 0.25  # seconds


class Stations(Node):
    """Counts boxes, one at a time at each station."""

    def __init__(self):
        super().__init__("stations")
        self.counted = {"lock": 0, "group": 0}
        self.lock = threading.Lock()
        # All may come in, and then the lock lets one count.
        self.lock_sub = self.create_subscription(
            Int32,
            "/lock_boxes",
            self.count_with_lock,
            10,
            callback_group=ReentrantCallbackGroup(),
        )
        # One may come in, and counts.
        self.group_sub = self.create_subscription(
            Int32,
            "/group_boxes",
            self.count_in_group,
            10,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )

    def count_with_lock(self, msg):
        with self.lock:  # a worker who waits here serves nobody else
            self.count("lock", msg.data)

    def count_in_group(self, msg):
        self.count("group", msg.data)

    def count(self, station, box):
        """Read the count, work, write the count."""
        seen = self.counted[station]
        time.sleep(COUNTING)
        self.counted[station] = seen + 1
        self.get_logger().info(f"{station}: box {box}, {seen + 1} in all")


class Yard(Node):
    """Sends lorries to the stations, and has the lamp."""

    def __init__(self):
        super().__init__("yard")
        self.to_lock = self.create_publisher(Int32, "/lock_boxes", 10)
        self.to_group = self.create_publisher(Int32, "/group_boxes", 10)
        self.lock_is_next = True
        self.lorries = self.create_timer(LORRY_PERIOD, self.lorry)
        self.lamp = self.create_timer(BLINK_PERIOD, self.blink)
        self.srv = self.create_service(SetBool, "/lorry", self.lorry_callback)

    def lorry(self):
        self.unload(self.lock_is_next)
        self.lock_is_next = not self.lock_is_next

    def blink(self):
        self.get_logger().info("blink")

    def lorry_callback(self, request, response):
        """Send one more lorry: true to the lock, false to the group."""
        self.unload(request.data)
        response.success = True
        response.message = "to the lock" if request.data else "to the group"
        return response

    def unload(self, at_lock):
        for box in range(1, BOXES + 1):
            (self.to_lock if at_lock else self.to_group).publish(
                Int32(data=box)
            )


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor(num_threads=4)
    nodes = [Stations(), Yard()]
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
