"""Programs with executors, groups and guard conditions as ROS 2's example packages have them."""

LISTENER = """
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):

    def __init__(self):
        super().__init__('listener')
        self.sub = self.create_subscription(String, 'chatter', self.chatter_callback, 10)

    def chatter_callback(self, msg):
        self.get_logger().info('I heard: [%s]' % msg.data)


def main(args=None):
    try:
        with rclpy.init(args=args):
            listener = Listener()
            rclpy.spin(listener)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
"""

TALKER = """
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):

    def __init__(self):
        super().__init__('talker')
        self.i = 0
        self.pub = self.create_publisher(String, 'chatter', 10)
        timer_period = 1.0
        self.tmr = self.create_timer(timer_period, self.timer_callback)

    def timer_callback(self):
        msg = String()
        msg.data = 'Hello World: {0}'.format(self.i)
        self.i += 1
        self.get_logger().info('Publishing: "{0}"'.format(msg.data))
        self.pub.publish(msg)


def main(args=None):
    try:
        with rclpy.init(args=args):
            talker = Talker()
            rclpy.spin(talker)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
"""

COMPOSED = """
from examples_rclpy_executors.listener import Listener
from examples_rclpy_executors.talker import Talker
import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor


def main(args=None):
    try:
        with rclpy.init(args=args):
            talker = Talker()
            listener = Listener()
            executor = SingleThreadedExecutor()
            executor.add_node(talker)
            executor.add_node(listener)
            try:
                executor.spin()
            finally:
                executor.shutdown()
                listener.destroy_node()
                talker.destroy_node()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
"""

CALLBACK_GROUP = """
from examples_rclpy_executors.listener import Listener
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class DoubleTalker(Node):

    def __init__(self):
        super().__init__('double_talker')
        self.i = 0
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.group = MutuallyExclusiveCallbackGroup()
        self.timer = self.create_timer(1.0, self.timer_callback, callback_group=self.group)
        self.timer2 = self.create_timer(0.5, self.timer_callback, callback_group=self.group)

    def timer_callback(self):
        msg = String()
        msg.data = 'Hello World: {0}'.format(self.i)
        self.i += 1
        self.get_logger().info('Publishing: "{0}"'.format(msg.data))
        self.pub.publish(msg)


def main(args=None):
    try:
        with rclpy.init(args=args):
            talker = DoubleTalker()
            listener = Listener()
            executor = MultiThreadedExecutor(num_threads=4)
            executor.add_node(talker)
            executor.add_node(listener)
            try:
                executor.spin()
            finally:
                executor.shutdown()
                listener.destroy_node()
                talker.destroy_node()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
"""

CUSTOM_EXECUTOR = """
from concurrent.futures import ThreadPoolExecutor
import os

from examples_rclpy_executors.listener import Listener
from examples_rclpy_executors.talker import Talker
import rclpy
from rclpy.executors import Executor
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Estopper(Node):

    def __init__(self):
        super().__init__('estopper')
        self.sub = self.create_subscription(String, 'estop', self.estop_callback, 10)

    def estop_callback(self, msg):
        self.get_logger().info('I heard: [%s]' % msg.data)


class PriorityExecutor(Executor):

    def __init__(self):
        super().__init__()
        self.high_priority_nodes = set()
        self.hp_executor = ThreadPoolExecutor(max_workers=os.cpu_count() or 4)
        self.lp_executor = ThreadPoolExecutor(max_workers=1)

    def add_high_priority_node(self, node):
        self.high_priority_nodes.add(node)
        # add_node inherited
        self.add_node(node)

    def _spin_once_impl(self, timeout_sec=None):
        # wait_for_ready_callbacks yields callbacks that are ready to be executed
        try:
            handler, group, node = self.wait_for_ready_callbacks(timeout_sec=timeout_sec)
        except StopIteration:
            pass
        else:
            if node in self.high_priority_nodes:
                self.hp_executor.submit(handler)
            else:
                self.lp_executor.submit(handler)


def main(args=None):
    try:
        with rclpy.init(args=args):
            listener = Listener()
            talker = Talker()
            estopper = Estopper()
            executor = PriorityExecutor()
            executor.add_high_priority_node(estopper)
            executor.add_node(listener)
            executor.add_node(talker)
            try:
                executor.spin()
            finally:
                executor.shutdown()
                estopper.destroy_node()
                talker.destroy_node()
                listener.destroy_node()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
"""

HUMBLE_CUSTOM_EXECUTOR = CUSTOM_EXECUTOR.replace("_spin_once_impl", "spin_once")

ESTOP = """
import time

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node('operator')
publisher = node.create_publisher(String, 'estop', 10)
busy = node.create_publisher(String, 'chatter', 10)
time.sleep(1.2)
publisher.publish(String(data='stop'))
"""

CUSTOM_CALLBACK_GROUP = """
import threading

import rclpy
from rclpy.callback_groups import CallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class ThrottledCallbackGroup(CallbackGroup):

    def __init__(self, node):
        super().__init__()
        self.timer = node.create_timer(0.5, self.timer_callback)
        self.bucket = 10
        self.bucket_max = 10
        self.lock = threading.Lock()

    def can_execute(self, entity):
        return self.bucket > 0

    def beginning_execution(self, entity):
        with self.lock:
            if self.bucket > 0:
                self.bucket -= 1
                # The executor may execute this callback
                return True
            # The executor should not execute this callback
            return False

    def ending_execution(self, entity):
        pass

    def timer_callback(self):
        with self.lock:
            # If there is room in the bucket, add a token to it.
            if self.bucket < self.bucket_max:
                self.bucket += 1


class ThrottledTalkerListener(Node):

    def __init__(self):
        super().__init__('intra_process_throttled_talker_listener')
        self.i = 0
        self.group = ThrottledCallbackGroup(self)
        self.pub = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(0.1, self.timer_callback, callback_group=self.group)
        self.sub = self.create_subscription(
            String, 'chatter', self.chatter_callback, 10, callback_group=self.group)

    def timer_callback(self):
        msg = String()
        msg.data = 'Hello World: {0}'.format(self.i)
        self.i += 1
        self.get_logger().info('Publishing: "{0}"'.format(msg.data))
        self.pub.publish(msg)

    def chatter_callback(self, msg):
        self.get_logger().info('I heard: [%s]' % msg.data)


def main(args=None):
    try:
        with rclpy.init(args=args):
            node = ThrottledTalkerListener()
            executor = MultiThreadedExecutor(num_threads=4)
            executor.add_node(node)
            executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
"""

GUARD_CONDITION = """
import rclpy
import rclpy.executors
from rclpy.executors import ExternalShutdownException


def main(args=None):
    try:
        with rclpy.init(args=args):
            node = rclpy.create_node('demo_guard_condition')
            executor = rclpy.executors.SingleThreadedExecutor()
            executor.add_node(node)

            def guard_condition_callback():
                node.get_logger().info('guard callback called')

            guard_condition = node.create_guard_condition(guard_condition_callback)

            # First loop: `spin_once` waits for the timeout, since nothing was triggered.
            # Second loop: the guard condition is triggered before `spin_once`, and the callback is called.
            for _ in range(2):
                executor.spin_once(timeout_sec=5.0)
                node.get_logger().info('spun')
                guard_condition.trigger()
            node.destroy_guard_condition(guard_condition)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
"""
