"""An oven that goes by a simulator's clock, which is set back.

It remembers when the bread is done, as a time of the simulated clock.
While it bakes, the simulator begins anew.
"""

import threading

import rclpy
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock as ClockMessage
from std_srvs.srv import SetBool

SIM_TIME = [Parameter("use_sim_time", value=True)]
BAKING = Duration(seconds=3.0)


class World(Node):
    """Tells the simulated time on /clock, and can begin anew."""

    def __init__(self):
        super().__init__("world")
        self.pub = self.create_publisher(ClockMessage, "/clock", 10)
        self.begun = Clock().now()
        self.tick_timer = self.create_timer(0.05, self.tick_callback)
        self.srv = self.create_service(SetBool, "/reset", self.reset_callback)

    def tick_callback(self):
        passed = Clock().now() - self.begun
        stamp = rclpy.time.Time(nanoseconds=passed.nanoseconds).to_msg()
        self.pub.publish(ClockMessage(clock=stamp))

    def reset_callback(self, _request, response):
        """Begin anew at 0, whether true or false was sent."""
        self.get_logger().warning("CLOCK SET BACK TO 0")
        self.begun = Clock().now()
        response.success = True
        return response


class Oven(Node):
    """Bakes one loaf after the other, three simulated seconds each."""

    def __init__(self):
        super().__init__("oven", parameter_overrides=SIM_TIME)
        self.done_at = None  # a time of the node's clock
        self.lamp_timer = self.create_timer(0.5, self.lamp_callback)
        self.look_timer = self.create_timer(0.1, self.look_callback)

    def lamp_callback(self):
        self.get_logger().info("BLINK")

    def look_callback(self):
        """Put dough in, or take the bread out if its time has come."""
        now = self.get_clock().now()
        if self.done_at is None:
            self.done_at = now + BAKING
            self.get_logger().info(f"DOUGH IN AT {now.nanoseconds / 1e9:.1f}")
        elif now >= self.done_at:
            self.done_at = None
            self.get_logger().info(f"BREAD OUT AT {now.nanoseconds / 1e9:.1f}")


def spin(node, executor):
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()
        node.destroy_node()


def main(args=None):
    rclpy.init(args=args)
    # The world has a thread of its own, as in a process of its own.
    turning = threading.Thread(
        target=spin, args=(World(), SingleThreadedExecutor())
    )
    turning.start()
    spin(Oven(), SingleThreadedExecutor())
    rclpy.try_shutdown()
    turning.join()


if __name__ == "__main__":
    main()
