"""Nodes whose fate depends on the order of their threads, and one whose does not."""

_HEAD = """
import threading
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


def main():
    rclpy.init()
    node = Mine()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
"""

CHECK_THEN_ACT = f"""{_HEAD}

class Mine(Node):
    def __init__(self):
        super().__init__("seats")
        self.free = 1
        group = ReentrantCallbackGroup()
        self.create_timer(0.1, self.ann, callback_group=group)
        self.create_timer(0.1, self.bob, callback_group=group)

    def ann(self):
        self.take("ann")

    def bob(self):
        self.take("bob")

    def take(self, who):
        if self.free > 0:
            print(who, "takes a seat")
            self.free -= 1
            assert self.free >= 0, "taken twice"
"""

IN_ONE_GROUP = CHECK_THEN_ACT.replace("group = Reentrant", "group = MutuallyExclusive")

LOCK_ORDER = f"""{_HEAD}

class Mine(Node):
    def __init__(self):
        super().__init__("bank")
        self.one, self.two = threading.Lock(), threading.Lock()
        self.create_timer(0.1, self.forth, callback_group=MutuallyExclusiveCallbackGroup())
        self.create_timer(0.1, self.back, callback_group=MutuallyExclusiveCallbackGroup())

    def forth(self):
        with self.one, self.two:
            pass

    def back(self):
        with self.two, self.one:
            pass
"""

LOST_UPDATE = """
import threading
import time
n = 0

def add():
    global n
    m = n
    n = m + 1

def main():
    for _ in range(2):
        threading.Thread(target=add).start()
    time.sleep(1)
    assert n == 2, n
"""

LOOPS = f"""import time
{_HEAD}

class Mine(Node):
    def __init__(self):
        super().__init__("loops")
        self.seen = False
        self.create_timer(0.1, self.wait)
        self.create_timer(0.5, self.see)

    def wait(self):
        while not self.seen:
            time.sleep(0.1)

    def see(self):
        self.seen = True
"""

JUST_IN_TIME = f"""import time
{_HEAD}

class Mine(Node):
    def __init__(self):
        super().__init__("kettle")
        self.boiled = False
        group = ReentrantCallbackGroup()
        self.create_timer(0.15, self.boil, callback_group=group)
        self.create_timer(0.27, self.brew, callback_group=group)

    def boil(self):
        time.sleep(0.1)
        self.boiled = True

    def brew(self):
        assert self.boiled, "cold water"
"""

AT_THE_OVEN = f"""{_HEAD}

class Mine(Node):
    def __init__(self):
        super().__init__("oven")
        self.turns = 0
        group = ReentrantCallbackGroup()
        self.kneads = self.create_timer(0.1, self.knead, callback_group=group)
        self.create_timer(0.28, self.bake, callback_group=group)

    def knead(self):
        self.kneads.cancel()
        for _ in range(300):
            self.turns += 1

    def bake(self):
        assert self.turns == 300, "raw dough"
"""
