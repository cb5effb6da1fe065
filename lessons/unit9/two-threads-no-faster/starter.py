"""Two desks compute at the same time: yours to mend.

Let processes do the computing. A desk must return at once, and each
result must come to the log, in a line that says "adds up to".
"""

import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool

JOB = 0.2  # seconds that a job takes alone
PERIOD = 1.0  # seconds from one pair of jobs to the next
TRIAL = 1_000_000  # squares that are added up to find out the speed


def add_squares(count):
    """Compute, in plain Python."""
    total = 0
    for number in range(count):
        total += number * number
    return total


def squares_in(seconds):
    """How many squares this computer adds up in so many seconds."""
    begun = time.thread_time()  # goes on only while this thread computes
    add_squares(TRIAL)
    return int(TRIAL * seconds / (time.thread_time() - begun))


class Desks(Node):
    """Two desks, each with a room of its own: neither waits for a seat."""

    def __init__(self):
        super().__init__("desks")
        self.squares = squares_in(JOB)
        self.left_sub = self.create_subscription(
            String,
            "/left_jobs",
            self.left_desk,
            10,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.right_sub = self.create_subscription(
            String,
            "/right_jobs",
            self.right_desk,
            10,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )

    def left_desk(self, msg):
        self.do("left", msg.data)

    def right_desk(self, msg):
        self.do("right", msg.data)

    def do(self, desk, job):
        begun, computed = time.monotonic(), time.thread_time()
        if job == "compute":
            # This keeps the thread, and the GIL. Who else could do it?
            total = add_squares(self.squares)
            self.get_logger().info(f"{desk} adds up to {total}")
        else:
            time.sleep(JOB)
        took = time.monotonic() - begun
        computed = time.thread_time() - computed
        self.get_logger().info(
            f"{desk} took {took:.2f} s, computed {computed:.2f} s"
        )


class Clerk(Node):
    """Hands out the jobs, one for each desk at a time."""

    def __init__(self):
        super().__init__("clerk")
        self.compute_is_next = False
        self.to_left = self.create_publisher(String, "/left_jobs", 10)
        self.to_right = self.create_publisher(String, "/right_jobs", 10)
        self.timer = self.create_timer(PERIOD, self.hand_out)
        self.srv = self.create_service(SetBool, "/jobs", self.jobs_callback)

    def hand_out(self):
        self.send("compute" if self.compute_is_next else "wait")
        self.compute_is_next = not self.compute_is_next

    def jobs_callback(self, request, response):
        """Hand out two jobs more: true to compute, false to wait."""
        response.success = True
        response.message = "compute" if request.data else "wait"
        self.send(response.message)
        return response

    def send(self, job):
        self.get_logger().info(f"Two jobs: {job}")
        self.to_left.publish(String(data=job))
        self.to_right.publish(String(data=job))


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor(num_threads=3)
    nodes = [Desks(), Clerk()]
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
