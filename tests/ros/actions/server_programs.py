"""Action servers as ROS 2's example packages have them, to be run as files of their own."""

_WORK = """
def fibonacci(node, goal_handle):
    feedback_msg = Fibonacci.Feedback()
    feedback_msg.sequence = [0, 1]
    for i in range(1, goal_handle.request.order):
        if not goal_handle.is_active:
            node.get_logger().info('Goal aborted')
            return Fibonacci.Result()
        if goal_handle.is_cancel_requested:
            goal_handle.canceled()
            node.get_logger().info('Goal canceled')
            return Fibonacci.Result()
        feedback_msg.sequence.append(feedback_msg.sequence[i] + feedback_msg.sequence[i - 1])
        node.get_logger().info('Publishing feedback: {0}'.format(feedback_msg.sequence))
        goal_handle.publish_feedback(feedback_msg)
        time.sleep(1)
    with node._goal_lock:
        if not goal_handle.is_active:
            node.get_logger().info('Goal aborted')
            return Fibonacci.Result()
        goal_handle.succeed()
    result = Fibonacci.Result()
    result.sequence = feedback_msg.sequence
    node.get_logger().info('Returning result: {0}'.format(result.sequence))
    return result
"""

_SERVER_IMPORTS = """
import collections
import threading
import time

from example_interfaces.action import Fibonacci

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
"""

_SERVER_MAIN = """
def main(args=None):
    rclpy.init(args=args)
    try:
        minimal_action_server = MinimalActionServer()
        executor = %s()
        rclpy.spin(minimal_action_server, executor=executor)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
"""

_MINIMAL = """
class MinimalActionServer(Node):

    def __init__(self):
        super().__init__('minimal_action_server')
        self._goal_lock = threading.Lock()
        self._action_server = ActionServer(
            self,
            Fibonacci,
            'fibonacci',
            execute_callback=self.execute_callback,
            callback_group=ReentrantCallbackGroup(),
            goal_callback=self.goal_callback,
            cancel_callback=self.cancel_callback)

    def destroy(self):
        self._action_server.destroy()
        super().destroy_node()

    def goal_callback(self, goal_request):
        self.get_logger().info('Received goal request')
        return GoalResponse.ACCEPT

    def cancel_callback(self, goal_handle):
        self.get_logger().info('Received cancel request')
        return CancelResponse.ACCEPT

    async def execute_callback(self, goal_handle):
        self.get_logger().info('Executing goal...')
        return fibonacci(self, goal_handle)
"""

_DEFER = """
class MinimalActionServer(Node):

    def __init__(self):
        super().__init__('minimal_action_server')
        self._goal_handle = None
        self._goal_lock = threading.Lock()
        self._action_server = ActionServer(
            self,
            Fibonacci,
            'fibonacci',
            execute_callback=self.execute_callback,
            callback_group=ReentrantCallbackGroup(),
            goal_callback=lambda goal_request: GoalResponse.ACCEPT,
            handle_accepted_callback=self.handle_accepted_callback,
            cancel_callback=lambda goal_handle: CancelResponse.ACCEPT)

    def handle_accepted_callback(self, goal_handle):
        self.get_logger().info('Deferring execution...')
        self._goal_handle = goal_handle
        self._timer = self.create_timer(3.0, self.timer_callback)

    def timer_callback(self):
        if self._goal_handle is not None:
            self._goal_handle.execute()
        self._timer.cancel()

    async def execute_callback(self, goal_handle):
        self.get_logger().info('Executing goal...')
        return fibonacci(self, goal_handle)
"""

_SINGLE_GOAL = """
class MinimalActionServer(Node):

    def __init__(self):
        super().__init__('minimal_action_server')
        self._goal_handle = None
        self._goal_lock = threading.Lock()
        self._action_server = ActionServer(
            self,
            Fibonacci,
            'fibonacci',
            execute_callback=self.execute_callback,
            goal_callback=self.goal_callback,
            handle_accepted_callback=self.handle_accepted_callback,
            cancel_callback=self.cancel_callback,
            callback_group=ReentrantCallbackGroup())

    def goal_callback(self, goal_request):
        self.get_logger().info('Received goal request')
        return GoalResponse.ACCEPT

    def handle_accepted_callback(self, goal_handle):
        with self._goal_lock:
            # This server only allows one goal at a time
            if self._goal_handle is not None and self._goal_handle.is_active:
                self.get_logger().info('Aborting previous goal')
                self._goal_handle.abort()
            self._goal_handle = goal_handle

        goal_handle.execute()

    def cancel_callback(self, goal):
        return CancelResponse.ACCEPT

    def execute_callback(self, goal_handle):
        self.get_logger().info('Executing goal...')
        return fibonacci(self, goal_handle)
"""

_QUEUE = """
class MinimalActionServer(Node):

    def __init__(self):
        super().__init__('minimal_action_server')
        self._goal_queue = collections.deque()
        self._goal_queue_lock = threading.Lock()
        self._goal_lock = threading.Lock()
        self._current_goal = None
        self._action_server = ActionServer(
            self,
            Fibonacci,
            'fibonacci',
            handle_accepted_callback=self.handle_accepted_callback,
            execute_callback=self.execute_callback,
            goal_callback=self.goal_callback,
            cancel_callback=self.cancel_callback,
            callback_group=ReentrantCallbackGroup())

    def handle_accepted_callback(self, goal_handle):
        with self._goal_queue_lock:
            if self._current_goal is not None:
                # Put incoming goal in the queue
                self._goal_queue.append(goal_handle)
                self.get_logger().info('Goal put in the queue')
            else:
                # Start goal execution right away
                self._current_goal = goal_handle
                self._current_goal.execute()

    def goal_callback(self, goal_request):
        return GoalResponse.ACCEPT

    def cancel_callback(self, goal_handle):
        return CancelResponse.ACCEPT

    def execute_callback(self, goal_handle):
        try:
            self.get_logger().info('Executing goal...')
            return fibonacci(self, goal_handle)
        finally:
            with self._goal_queue_lock:
                try:
                    # Start execution of the next goal in the queue.
                    self._current_goal = self._goal_queue.popleft()
                    self.get_logger().info('Next goal pulled from the queue')
                    self._current_goal.execute()
                except IndexError:
                    # No goal in the queue.
                    self._current_goal = None
"""


def _server(body: str, executor: str = "MultiThreadedExecutor") -> str:
    return _SERVER_IMPORTS + _WORK + body + _SERVER_MAIN % executor


SERVER = _server(_MINIMAL)
SINGLE_THREADED_SERVER = _server(_MINIMAL, "SingleThreadedExecutor")
DEFERRING_SERVER = _server(_DEFER)
SINGLE_GOAL_SERVER = _server(_SINGLE_GOAL)
QUEUEING_SERVER = _server(_QUEUE)

NOT_COMPOSABLE_SERVER = """
import time

from example_interfaces.action import Fibonacci

import rclpy
from rclpy.action import ActionServer
from rclpy.executors import ExternalShutdownException

logger = None


def execute_callback(goal_handle):
    logger.info('Executing goal...')
    feedback_msg = Fibonacci.Feedback()
    feedback_msg.sequence = [0, 1]
    for i in range(1, goal_handle.request.order):
        feedback_msg.sequence.append(feedback_msg.sequence[i] + feedback_msg.sequence[i - 1])
        logger.info('Publishing feedback: {0}'.format(feedback_msg.sequence))
        goal_handle.publish_feedback(feedback_msg)
        time.sleep(1)
    goal_handle.succeed()
    result = Fibonacci.Result()
    result.sequence = feedback_msg.sequence
    logger.info('Returning result: {0}'.format(result.sequence))
    return result


def main(args=None):
    global logger
    rclpy.init(args=args)
    try:
        node = rclpy.create_node('minimal_action_server')
        logger = node.get_logger()
        action_server = ActionServer(node, Fibonacci, 'fibonacci', execute_callback)
        while rclpy.ok():
            rclpy.spin_once(node)
        action_server.destroy()
        node.destroy_node()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
"""
