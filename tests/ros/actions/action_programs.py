"""Programs with actions as ROS 2's example packages have them, to be run as files of their own."""

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

_CLIENT_IMPORTS = """
from action_msgs.msg import GoalStatus
from example_interfaces.action import Fibonacci

import rclpy
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
"""

_CLIENT_MAIN = """
def main(args=None):
    rclpy.init(args=args)
    try:
        action_client = MinimalActionClient()
        action_client.send_goal()
        rclpy.spin(action_client)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
"""

CLIENT = (
    _CLIENT_IMPORTS
    + """
class MinimalActionClient(Node):

    def __init__(self):
        super().__init__('minimal_action_client')
        self._action_client = ActionClient(self, Fibonacci, 'fibonacci')

    def goal_response_callback(self, future):
        goal_handle = future.result()
        if not goal_handle.accepted:
            self.get_logger().info('Goal rejected :(')
            return
        self.get_logger().info('Goal accepted :)')
        self._get_result_future = goal_handle.get_result_async()
        self._get_result_future.add_done_callback(self.get_result_callback)

    def feedback_callback(self, feedback):
        self.get_logger().info('Received feedback: {0}'.format(feedback.feedback.sequence))

    def get_result_callback(self, future):
        result = future.result().result
        status = future.result().status
        if status == GoalStatus.STATUS_SUCCEEDED:
            self.get_logger().info('Goal succeeded! Result: {0}'.format(result.sequence))
        else:
            self.get_logger().info('Goal failed with status: {0}'.format(status))
        rclpy.shutdown()

    def send_goal(self):
        self.get_logger().info('Waiting for action server...')
        self._action_client.wait_for_server()
        goal_msg = Fibonacci.Goal()
        goal_msg.order = 4
        self.get_logger().info('Sending goal request...')
        self._send_goal_future = self._action_client.send_goal_async(
            goal_msg,
            feedback_callback=self.feedback_callback)
        self._send_goal_future.add_done_callback(self.goal_response_callback)
"""
    + _CLIENT_MAIN
)

CANCELLING_CLIENT = (
    _CLIENT_IMPORTS
    + """
class MinimalActionClient(Node):

    def __init__(self):
        super().__init__('minimal_action_client')
        self._action_client = ActionClient(self, Fibonacci, 'fibonacci')

    def cancel_done(self, future):
        cancel_response = future.result()
        if len(cancel_response.goals_canceling) > 0:
            self.get_logger().info('Goal successfully canceled')
        else:
            self.get_logger().info('Goal failed to cancel')
        rclpy.shutdown()

    def goal_response_callback(self, future):
        goal_handle = future.result()
        if not goal_handle.accepted:
            self.get_logger().info('Goal rejected :(')
            return
        self._goal_handle = goal_handle
        self.get_logger().info('Goal accepted :)')
        # Start a 2 second timer
        self._timer = self.create_timer(2.0, self.timer_callback)

    def feedback_callback(self, feedback):
        self.get_logger().info('Received feedback: {0}'.format(feedback.feedback.sequence))

    def timer_callback(self):
        self.get_logger().info('Canceling goal')
        future = self._goal_handle.cancel_goal_async()
        future.add_done_callback(self.cancel_done)
        self._timer.cancel()

    def send_goal(self):
        self.get_logger().info('Waiting for action server...')
        self._action_client.wait_for_server()
        goal_msg = Fibonacci.Goal()
        goal_msg.order = 10
        self.get_logger().info('Sending goal request...')
        self._send_goal_future = self._action_client.send_goal_async(
            goal_msg,
            feedback_callback=self.feedback_callback)
        self._send_goal_future.add_done_callback(self.goal_response_callback)
"""
    + _CLIENT_MAIN
)

NOT_COMPOSABLE_CLIENT = """
from action_msgs.msg import GoalStatus
from example_interfaces.action import Fibonacci

import rclpy
from rclpy.action import ActionClient


def feedback_cb(logger, feedback):
    logger.info('Received feedback: {0}'.format(feedback.feedback.sequence))


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('minimal_action_client')
    action_client = ActionClient(node, Fibonacci, 'fibonacci')
    node.get_logger().info('Waiting for action server...')
    action_client.wait_for_server()
    goal_msg = Fibonacci.Goal()
    goal_msg.order = 4
    node.get_logger().info('Sending goal request...')
    send_goal_future = action_client.send_goal_async(
        goal_msg, feedback_callback=lambda feedback: feedback_cb(node.get_logger(), feedback))
    rclpy.spin_until_future_complete(node, send_goal_future)
    goal_handle = send_goal_future.result()
    if not goal_handle.accepted:
        node.get_logger().info('Goal rejected :(')
        action_client.destroy()
        node.destroy_node()
        rclpy.shutdown()
        return
    node.get_logger().info('Goal accepted :)')
    get_result_future = goal_handle.get_result_async()
    rclpy.spin_until_future_complete(node, get_result_future)
    result = get_result_future.result().result
    status = get_result_future.result().status
    if status == GoalStatus.STATUS_SUCCEEDED:
        node.get_logger().info('Goal succeeded! Result: {0}'.format(result.sequence))
    else:
        node.get_logger().info('Goal failed with status code: {0}'.format(status))
    action_client.destroy()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
"""
