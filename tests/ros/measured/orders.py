"""Plain programs, and what each was measured to say on real rclpy: Jazzy 7.1.5 and Kilted 9.1.2."""

from dataclasses import dataclass

_HEAD = """
import os
import threading
import time
import warnings
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup as Exclusive
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

warnings.simplefilter("ignore")
rclpy.init()
node = rclpy.create_node("n")
lines = []
say = lines.append

def lasts(seconds, first, last):
    say(first)
    time.sleep(seconds)
    say(last)

def hear(topic, callback):
    node.create_subscription(Int32, topic, callback, 10, callback_group=Exclusive())
    return node.create_publisher(Int32, topic, 10)

def finish():
    print(*lines, sep="\\n", flush=True)
    os._exit(0)

def spin(executor, seconds):
    executor.add_node(node)
    threading.Thread(target=executor.spin, daemon=True).start()
    time.sleep(seconds)
    finish()
"""


@dataclass(frozen=True)
class Order:
    """A program, and its lines; ``what`` says what they show.

    ``also`` is what some real runs said, where a thread that is woken may be quicker than the one that runs.
    """

    what: str
    program: str
    lines: str
    also: str = ""

    @property
    def source(self) -> str:
        """The whole program."""
        return _HEAD + self.program


_QUEUED = """
a = hear("a", lambda message: lasts(0.4, f"a{message.data} begins", "a ends"))
c = hear("c", lambda _: say("c"))
def heard_b(_):
    BODY
b = hear("b", heard_b)
def send():
    time.sleep(1.0)
    a.publish(Int32(data=1))
    time.sleep(0.1)
    b.publish(Int32())
    time.sleep(0.1)
    a.publish(Int32(data=2))
threading.Thread(target=send, daemon=True).start()
spin(MultiThreadedExecutor(1), 3.2)
"""

_CALLED = "begins, ends, begins, ends, begins, calls, ends, begins, ends, served, begins, ends"

ORDERS = (
    Order(
        "what a callback sends as its last act comes before the timer of its own group",
        """
publisher = hear("t", lambda _: say("heard"))
def tick():
    lasts(0.4, "begins", "ends")
    publisher.publish(Int32())
node.create_timer(0.5, tick, Exclusive()).timer_period_ns = 200_000_000
spin(MultiThreadedExecutor(1), 2.0)
""",
        "begins, ends, heard, begins, ends, heard, begins, ends, heard, begins",
    ),
    Order(
        "what a queued callback sends before it waits comes before what had to wait for its predecessor",
        _QUEUED.replace("BODY", 'c.publish(Int32()); lasts(0.3, "b begins", "b ends")'),
        "a1 begins, a ends, b begins, b ends, c, a2 begins, a ends",
        also="a1 begins, a ends, b begins, b ends, a2 begins, a ends, c",
    ),
    Order(
        "what a queued callback sends after it has waited comes later",
        _QUEUED.replace("BODY", 'lasts(0.3, "b begins", "b ends"); c.publish(Int32())'),
        "a1 begins, a ends, b begins, b ends, a2 begins, a ends, c",
    ),
    Order(
        "a reply is told of before the next call of a timer that is always due",
        """
group = Exclusive()
def serve(_, response):
    say("served")
    return response
node.create_timer(0.2, lambda: lasts(0.4, "begins", "ends"), group)
node.create_service(SetBool, "s", serve, callback_group=group)
client = node.create_client(SetBool, "s", callback_group=Exclusive())
def call():
    timer.cancel()
    say("calls")
    say(f"answered {client.call(SetBool.Request(), timeout_sec=1.2) is not None}")
timer = node.create_timer(1.2, call, Exclusive())
spin(MultiThreadedExecutor(2), 2.4)
""",
        f"{_CALLED}, answered True, begins",
        also=f"{_CALLED}, begins, answered True",
    ),
    Order(
        "a pool's spin_until_future_complete comes back with the reply",
        """
def serve(_, response):
    time.sleep(0.1)
    return response
node.create_service(SetBool, "s", serve, callback_group=Exclusive())
client = node.create_client(SetBool, "s", callback_group=Exclusive())
node.create_timer(0.7, lambda: say("tick"), Exclusive())
executor = MultiThreadedExecutor(3)
executor.add_node(node)
client.wait_for_service()
for _ in range(3):
    executor.spin_until_future_complete(client.call_async(SetBool.Request()))
    say("done")
    time.sleep(0.6)
finish()
""",
        "done, tick, done, tick, done",
    ),
    Order(
        "with a timeout of 0 every cycle ends with a call that runs nothing",
        """
spun = []
hear_t = hear("t", lambda _: spun.append("t"))
hear_u = hear("u", lambda _: spun.append("u"))
for executor in (SingleThreadedExecutor(), MultiThreadedExecutor(2)):
    executor.add_node(node)
    spun.append("settles")
    while spun:
        spun.clear()
        executor.spin_once(timeout_sec=0.2)
    for each in (hear_t, hear_t, hear_u):
        each.publish(Int32())
    time.sleep(0.3)
    said = ""
    for _ in range(7):
        spun.clear()
        executor.spin_once(timeout_sec=0)
        time.sleep(0.05)
        said += "".join(spun) or "-"
    say(said)
    executor.remove_node(node)
finish()
""",
        "tu-t---, tu-t---",
    ),
    Order(
        "a timer that is reset while it waits for a worker is called all the same",
        """
def first():
    timer.cancel()
    lasts(0.5, "first begins", "resets")
    second.reset()
    lasts(0.2, "waits", "first ends")
    threading.Timer(0.3, say, ("0.3 s later",)).start()
timer = node.create_timer(0.3, first, Exclusive())
second = node.create_timer(0.4, lambda: say("second"), Exclusive())
spin(MultiThreadedExecutor(1), 1.7)
""",
        "first begins, resets, waits, first ends, second, 0.3 s later, second",
    ),
    Order(
        "an exception on a worker that was just started comes out of spin at once",
        """
def tick():
    say("tick")
    if len(lines) == 1:
        raise ValueError
node.create_timer(0.5, tick)
executor = MultiThreadedExecutor(3)
executor.add_node(node)
threading.Timer(1.3, finish).start()
while True:
    try:
        executor.spin()
    except ValueError:
        say("raised")
""",
        "tick, raised, tick",
    ),
    Order(
        "a guard condition triggered between snapshot and callback calls twice",
        """
guard = node.create_guard_condition(lambda: say("guard"))
def heard(_):
    say("heard")
    guard.trigger()
publisher = hear("t", heard)
def tick():
    timer.cancel()
    publisher.publish(Int32())
    guard.trigger()
    lasts(0.2, "begins", "ends")
timer = node.create_timer(0.5, tick)
spin(SingleThreadedExecutor(), 1.2)
""",
        "begins, ends, heard, guard, guard",
    ),
    Order(
        "what is logged is text, bytes or None",
        """
for each in (5, [1], b"bytes", None):
    try:
        say(f"{node.get_logger().info(each)}")
    except TypeError:
        say("TypeError")
finish()
""",
        "TypeError, TypeError, True, True",
    ),
    Order(
        "that a timer's callback cannot be called is found when it is due",
        """
timers = [node.create_timer(period, callback) for period, callback in ((0.3, None), (0.5, "text"))]
executor = SingleThreadedExecutor()
executor.add_node(node)
for timer in timers:
    try:
        while True:
            executor.spin_once()
    except TypeError as error:
        say(f"{error}")
        timer.cancel()
finish()
""",
        "'NoneType' object is not callable, 'str' object is not callable",
    ),
    Order(
        "an event names the policy that did not match as C does",
        """
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSPolicyKind, QoSProfile, ReliabilityPolicy
events = []
callbacks = SubscriptionEventCallbacks(incompatible_qos=events.append)
node.create_subscription(Int32, "t", say, 10, event_callbacks=callbacks)
node.create_publisher(Int32, "t", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
while not events:
    rclpy.spin_once(node)
kind = events[0].last_policy_kind
say(f"{kind} {kind!r} {kind == QoSPolicyKind.RELIABILITY} {int(kind)}")
finish()
""",
        "rmw_qos_policy_kind_t.RMW_QOS_POLICY_RELIABILITY "
        "<rmw_qos_policy_kind_t.RMW_QOS_POLICY_RELIABILITY: 16> True 16",
    ),
    Order(
        "bytes that hold no message are sent, and reach who takes them raw",
        """
executor = SingleThreadedExecutor()
executor.add_node(node)
node.create_subscription(Int32, "t", lambda message: say(f"{message.data}"), 10)
node.create_subscription(Int32, "t", lambda data: say(f"{len(data)} bytes"), 10, raw=True)
publisher = node.create_publisher(Int32, "t", 10)
time.sleep(0.5)
for data in (b"junk", b"\\0\\1\\0\\0\\7\\0\\0\\0"):
    say(f"{publisher.publish(data)}")
    for _ in range(3):
        executor.spin_once(timeout_sec=0.3)
finish()
""",
        "None, 4 bytes, None, 7, 8 bytes",
    ),
    Order(
        "a jump of ROS time onto a multiple of a timer's period calls it once",
        """
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
sim = rclpy.create_node("sim", parameter_overrides=[Parameter("use_sim_time", value=True)])
publisher = node.create_publisher(Clock, "/clock", 10)
executor = SingleThreadedExecutor()
executor.add_node(sim)
def to(seconds):
    clock = Clock()
    clock.clock.sec = seconds
    publisher.publish(clock)
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
time.sleep(0.5)
to(1)
timer = sim.create_timer(1.0, lambda: say(f"{sim.get_clock().now().nanoseconds // 10**9}"))
for seconds in (6, 7, 9):
    to(seconds)
finish()
""",
        "6, 7, 9",
    ),
)
