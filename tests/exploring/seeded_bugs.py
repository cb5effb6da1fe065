"""Programs with a bug each that only some orders of their threads show, as small rclpy files.

Each method of a node without arguments is a timer's callback, called once, all of them in one reentrant
group; ``audit`` is called when the others are done. A name with an underscore in front is no callback.
"""

import re
from textwrap import indent

PERIOD, AUDIT_PERIOD, SECONDS = 0.1, 0.15, 0.19

_FILE = """import asyncio
import threading
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Int32
from std_srvs.srv import SetBool


class Mine(Node):
    def __init__(self):
        super().__init__("mine")
        group = ReentrantCallbackGroup()
{timers}

{body}

def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Mine())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
"""

_TWICE = """
{state}
ones = twos = 0

def one(self):
{step}
    self.ones += 1

def two(self):
{step}
    self.twos += 1

def audit(self):
    assert {holds}
"""
"""Two callbacks that do the same; their own counts tell how often."""

_STEPS = {
    "lost update of an attribute": ("n = 0", "n = self.n\nself.n = n + 1", "self.n == self.ones + self.twos"),
    "lost update through a helper": (
        "n = 0\ndef _plus(self, n):\n    self.seen = n\n    return n + 1",
        "self.n = self._plus(self.n)",
        "self.n == self.ones + self.twos",
    ),
    "lost update within a line": ("n = 0", "self.n += abs(1)", "self.n == self.ones + self.twos"),
    "lost update of a global": (
        "global total\ntotal = 0",
        "global total\nn = total\ntotal = n + 1",
        "total == self.ones + self.twos",
    ),
    "lost update of an entry": (
        "table = {'n': 0}",
        "n = self.table['n']\nself.table['n'] = n + 1",
        "self.table['n'] == self.ones + self.twos",
    ),
    "lost update of an object of its own": (
        "class Stats:\n    total = 0\nstats = Stats()",
        "total = self.stats.total\nself.stats.total = total + 1",
        "self.stats.total == self.ones + self.twos",
    ),
    "read and written under a lock, but not at once": (
        "lock, n = threading.Lock(), 0",
        "with self.lock:\n    n = self.n\nwith self.lock:\n    self.n = n + 1",
        "self.n == self.ones + self.twos",
    ),
    "a list made anew from the old one": (
        "names = ()",
        "names = self.names\nself.names = (*names, len(names))",
        "len(self.names) == self.ones + self.twos",
    ),
    "the last of the stock sold twice": (
        "stock = 1",
        "if self.stock > 0:\n    self.stock -= 1",
        "self.stock >= 0",
    ),
    "made twice, as neither saw the other's": (
        "made, thing = 0, None",
        "if self.thing is None:\n    self.made += 1\n    self.thing = object()",
        "self.made == 1",
    ),
    "started twice by a flag": (
        "started, starts = False, 0",
        "if not self.started:\n    self.starts += 1\n    self.started = True",
        "self.starts == 1",
    ),
    "an entry that is put in twice": (
        "known, news = {}, 0",
        "if 'a' not in self.known:\n    self.news += 1\n    self.known['a'] = 1",
        "self.news == 1",
    ),
    "a number given out twice": (
        "next_id = 0\ngiven = set()",
        "mine = self.next_id\nself.next_id = mine + 1\nself.given.add(mine)",
        "len(self.given) == self.ones + self.twos",
    ),
    "a semaphore in place of a lock": (
        "few, n = threading.Semaphore(2), 0",
        "with self.few:\n    n = self.n\n    self.n = n + 1",
        "self.n == self.ones + self.twos",
    ),
    "a lock that is made anew for each call": (
        "n = 0",
        "with threading.Lock():\n    n = self.n\n    self.n = n + 1",
        "self.n == self.ones + self.twos",
    ),
}

_OTHERS = {
    "the best of two is overwritten": """
        best, high, low = 0, 0, 0
        def one(self):
            self.high += 2
            if self.high > self.best:
                self.best = self.high
        def two(self):
            self.low += 1
            if self.low > self.best:
                self.best = self.low
        def audit(self):
            assert self.best == max(self.high, self.low)
        """,
    "each callback has a lock of its own": """
        locks, n, ones, twos = (threading.Lock(), threading.Lock()), 0, 0, 0
        def one(self):
            with self.locks[0]:
                n = self.n
                self.n = n + 1
            self.ones += 1
        def two(self):
            with self.locks[1]:
                n = self.n
                self.n = n + 1
            self.twos += 1
        def audit(self):
            assert self.n == self.ones + self.twos
        """,
    "half of a pose is read": """
        x = y = 0
        def move(self):
            self.x += 1
            self.y += 1
        def look(self):
            x = self.x
            assert x == self.y
        """,
    "money on its way between two accounts": """
        here, there = 10, 0
        def pay(self):
            self.here -= 1
            self.there += 1
        def count(self):
            total = self.here
            total += self.there
            assert total == 10
        """,
    "one is taken from a list that has become empty": """
        items = []
        def put(self):
            self.items.append(1)
        def one(self):
            if self.items:
                self.items.pop()
        def two(self):
            if self.items:
                self.items.pop()
        """,
    "an index that was right before": """
        items = [1, 2, 3]
        def shorten(self):
            if len(self.items) > 1:
                self.items.pop()
        def last(self):
            place = len(self.items) - 1
            assert self.items[place]
        """,
    "a dictionary grows while it is walked through": """
        table = {0: 0}
        def grow(self):
            self.table[len(self.table)] = 1
        def walk(self):
            for key in self.table:
                self.seen = self.table[key]
        """,
    "used after it was closed": """
        opened = False
        def toggle(self):
            self.opened = True
            self.opened = False
        def use(self):
            if self.opened:
                assert self.opened, "closed meanwhile"
        """,
    "a busy flag that two find free": """
        busy, inside = False, 0
        def one(self):
            self._work()
        def two(self):
            self._work()
        def _work(self):
            if self.busy:
                return
            self.busy = True
            self.inside += 1
            assert self.inside == 1
            self.inside -= 1
            self.busy = False
        """,
    "the mode changes between the look and the deed": """
        mode, speed = "drive", 0
        def stop(self):
            self.mode = "stop"
            self.speed = 0
        def drive(self):
            if self.mode == "drive":
                self.speed = 1
        def audit(self):
            assert not (self.mode == "stop" and self.speed)
        """,
    "a message is handled after a newer one": """
        latest = sent = 0
        def send(self):
            if not self.sent:
                group = ReentrantCallbackGroup()
                self.create_subscription(Int32, "n", self._take, 10, callback_group=group)
                self.out = self.create_publisher(Int32, "n", 10)
                for number in (1, 2):
                    self.sent = number
                    self.out.publish(Int32(data=number))
        def _take(self, message):
            number = message.data
            assert number > self.latest
            self.latest = number
        """,
    "two locks in two orders": """
        first, second = threading.Lock(), threading.Lock()
        def forth(self):
            with self.first:
                with self.second:
                    pass
        def back(self):
            with self.second:
                with self.first:
                    pass
        """,
    "three locks in a circle": """
        a, b, c = threading.Lock(), threading.Lock(), threading.Lock()
        def one(self):
            with self.a, self.b:
                pass
        def two(self):
            with self.b, self.c:
                pass
        def three(self):
            with self.c, self.a:
                pass
        """,
    "a lock and a queue of one in two orders": """
        lock, room = threading.Lock(), threading.Semaphore(1)
        def put(self):
            with self.lock:
                assert self.room.acquire(timeout=0.04), "each waits for the other"
                self.room.release()
        def get(self):
            self.room.acquire()
            with self.lock:
                self.room.release()
        """,
    "told before anybody waited": """
        bell = threading.Condition()
        def hear(self):
            with self.bell:
                assert self.bell.wait(0.04), "rung before"
        def ring(self):
            with self.bell:
                self.bell.notify()
        """,
    "the wrong one of two waiters is told": """
        bell, coffee, tea = threading.Condition(), 0, 0
        def drink_coffee(self):
            with self.bell:
                if not self.coffee:
                    self.bell.wait(0.04)
                assert self.coffee, "nobody made coffee"
        def drink_tea(self):
            with self.bell:
                if not self.tea:
                    self.bell.wait(0.04)
                assert self.tea, "nobody made tea"
        def make_coffee(self):
            with self.bell:
                self.coffee += 1
                self.bell.notify()
        def make_tea(self):
            with self.bell:
                self.tea += 1
                self.bell.notify()
        """,
    "waits with an if in place of a while": """
        bell, free = threading.Condition(), 0
        def free_one(self):
            with self.bell:
                self.free += 1
                self.bell.notify_all()
        def one(self):
            self._take()
        def two(self):
            self._take()
        def _take(self):
            with self.bell:
                if not self.free and not self.bell.wait(0.04):
                    return
                self.free -= 1
                assert self.free >= 0, "taken twice"
        """,
    "an event is cleared after it was set again": """
        ready, asked, answered = threading.Event(), 0, 0
        def ask(self):
            self.asked += 1
            self.ready.set()
        def answer(self):
            asked = self.asked
            self.ready.clear()
            self.answered = asked
        def audit(self):
            assert self.ready.is_set() or self.answered == self.asked
        """,
    "an await between reading and writing": """
        n = ones = twos = 0
        async def one(self):
            n = self.n
            await self._pause()
            self.n = n + 1
            self.ones += 1
        async def two(self):
            n = self.n
            await self._pause()
            self.n = n + 1
            self.twos += 1
        def audit(self):
            assert self.n == self.ones + self.twos
        async def _pause(self):
            done = Future()
            self.executor.create_task(done.set_result, True)
            await done
        """,
    "an await between the look and the deed": """
        free = 1
        async def ann(self):
            await self._take()
        async def bob(self):
            await self._take()
        async def _take(self):
            if self.free:
                done = Future()
                self.executor.create_task(done.set_result, True)
                await done
                self.free -= 1
                assert self.free == 0, "taken twice"
        """,
    "an answer that comes after it was given up": """
        wanted = got = 0
        async def ask(self):
            self.wanted += 1
            mine = self.wanted
            done = Future()
            self.executor.create_task(done.set_result, mine)
            self.got = await done
            assert self.got == self.wanted
        def cancel(self):
            self.wanted += 1
        """,
    "a reply made from what the next request has changed": """
        request = reply = None
        def one(self):
            self._serve("one")
        def two(self):
            self._serve("two")
        def _serve(self, name):
            self.request = name
            reply = self.request
            assert reply == name
        """,
    "a timer is cancelled twice": """
        child = None
        def start(self):
            if self.child is None:
                self.child = self.create_timer(0.03, self._tick)
        def one(self):
            self._stop()
        def two(self):
            self._stop()
        def _stop(self):
            if self.child is not None:
                self.child.cancel()
                self.child = None
        def _tick(self):
            pass
        """,
}


SHOWN_BY_USUAL_ORDER = {
    "an await between reading and writing",
    "an await between the look and the deed",
    "an answer that comes after it was given up",
}
"""A coroutine is left at its await in every order."""


def _files() -> dict[str, str]:
    bodies = {
        name: _TWICE.format(state=state, step=indent(step, "    "), holds=holds)
        for name, (state, step, holds) in _STEPS.items()
    }
    bodies |= {name: _dedented(body) for name, body in _OTHERS.items()}
    return {name: _file(body) for name, body in bodies.items()}


def _dedented(body: str) -> str:
    return "\n".join(line.removeprefix(" " * 8) for line in body.splitlines())


def _file(body: str) -> str:
    callbacks = re.findall(r"^(?:async )?def ([a-z]\w*)\(self\)", body, re.MULTILINE)
    timers = [
        f"self.create_timer({AUDIT_PERIOD if name == 'audit' else PERIOD}, self.{name}, callback_group=group)"
        for name in callbacks
    ]
    return _FILE.format(timers=indent("\n".join(timers), " " * 8), body=indent(body.strip("\n"), "    "))


BUGS = _files()
"""The source of each program, by what is wrong with it."""
