"""A belt and scales that a bad label does not bring down.

The scales catch what they cannot read, say so at once, and go on with
the next parcel.
"""

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool

TIMER_PERIOD = 3.0  # seconds from parcel to parcel
LABELS = ("2.5 kg", "4.0 kg", "???")


class Scales(Node):
    """Puts parcels on a belt, and adds up what they weigh."""

    def __init__(self):
        super().__init__("scales")
        self.parcels = 0
        self.total = 0.0  # kilograms
        self.belt_runs = True
        self.parcel_pub = self.create_publisher(String, "parcels", 10)
        # A seat of its own for each callback.
        self.parcel_sub = self.create_subscription(
            String,
            "parcels",
            self.weigh_callback,
            10,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.timer = self.create_timer(
            TIMER_PERIOD,
            self.timer_callback,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.srv = self.create_service(SetBool, "/belt", self.belt_callback)

    # --- The three callbacks: the executor runs these ---

    def timer_callback(self):
        """Put a parcel on the belt."""
        if self.belt_runs:
            label = LABELS[self.parcels % len(LABELS)]
            self.parcels += 1
            self.get_logger().info(f"PARCEL {self.parcels}: {label}")
            self.parcel_pub.publish(String(data=label))

    def weigh_callback(self, msg):
        """Read a label; one that is no weight is told and left out."""
        number = msg.data.removesuffix(" kg")
        try:
            self.total += float(number)
        except ValueError as error:
            self.get_logger().error(f"NOT WEIGHED: {error}")
            return
        self.get_logger().info(f"WEIGHED, {self.total} kg so far")

    def belt_callback(self, request, response):
        """Let the belt run (true) or stop (false)."""
        self.belt_runs = request.data
        response.success = True
        response.message = "BELT RUNS" if request.data else "BELT STOPS"
        return response


def main(args=None):
    rclpy.init(args=args)
    node = Scales()
    executor = MultiThreadedExecutor(num_threads=2)
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
