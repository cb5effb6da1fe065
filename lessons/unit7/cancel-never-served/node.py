"""A robot that fetches things, and is called back on its way.

It asks before each step whether the goal is cancelled. One thread runs
the steps, and whatever else comes for the robot's node.
"""

import threading
import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

STEP_TIME = 1.0  # seconds
REGRET = 1.5  # seconds from a goal to its end
STEPS = 5  # of a goal
ENDINGS = {4: "succeeded", 5: "canceled", 6: "aborted"}


class Robot(Node):
    """Serves the action: a goal is to go some steps."""

    def __init__(self):
        super().__init__("robot")
        self.server = ActionServer(
            self,
            Fibonacci,
            "/fetch_it",
            self.execute_callback,
            cancel_callback=self.cancel_callback,
        )

    def cancel_callback(self, _goal_handle):
        self.get_logger().info("CANCEL REQUESTED")
        return CancelResponse.ACCEPT

    def execute_callback(self, goal_handle):
        """Go step by step, unless the goal is cancelled."""
        result = Fibonacci.Result()
        for step in range(1, goal_handle.request.order + 1):
            # A flag, which the server sets when it serves the request.
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return result
            self.get_logger().info(f"STEP {step}")
            time.sleep(STEP_TIME)
        goal_handle.succeed()
        return result


class Dispatcher(Node):
    """Sends the robot off, and calls it back soon after."""

    def __init__(self):
        super().__init__("dispatcher")
        self.client = ActionClient(self, Fibonacci, "/fetch_it")
        self.srv = self.create_service(SetBool, "/fetch", self.fetch_callback)
        self.regret_timer = self.create_timer(REGRET, self.regret_callback)
        self.regret_timer.cancel()  # until a goal is accepted
        self.goal = None

    def fetch_callback(self, _request, response):
        """Send a goal, whether true or false was sent."""
        sent = self.client.send_goal_async(Fibonacci.Goal(order=STEPS))
        sent.add_done_callback(self.accepted)
        response.success = True
        return response

    def accepted(self, future):
        self.goal = future.result()
        self.goal.get_result_async().add_done_callback(self.ended)
        self.regret_timer.reset()

    def regret_callback(self):
        self.regret_timer.cancel()
        self.get_logger().info("CALLED BACK")
        self.goal.cancel_goal_async().add_done_callback(self.answered)

    def answered(self, future):
        is_let_in = bool(future.result().goals_canceling)
        answer = "accepted" if is_let_in else "refused: it has ended"
        self.get_logger().info(f"CANCEL {answer}")

    def ended(self, future):
        self.get_logger().info(f"RESULT {ENDINGS[future.result().status]}")


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
    # The dispatcher has a thread of its own, as in a process of its own.
    dispatching = threading.Thread(
        target=spin, args=(Dispatcher(), SingleThreadedExecutor())
    )
    dispatching.start()
    spin(Robot(), SingleThreadedExecutor())
    rclpy.try_shutdown()
    dispatching.join()


if __name__ == "__main__":
    main()
