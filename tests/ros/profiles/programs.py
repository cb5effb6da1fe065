"""Programs that say different things on different releases of rclpy."""

from collections.abc import Mapping
from dataclasses import dataclass

_HEAD = """
import os
import threading
import time
import warnings
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup as Exclusive
from rclpy.callback_groups import ReentrantCallbackGroup as Reentrant
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.task import Future
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

warnings.simplefilter("ignore")
rclpy.init()
node = rclpy.create_node("n")
lines = []
say = lines.append

def finish():
    print(*lines, sep="\\n", flush=True)
    os._exit(0)

def after(seconds, work):
    threading.Timer(seconds, work).start()

def attempt(work):
    try:
        say(f"{work()}")
    except Exception as error:
        say(type(error).__name__)

def executor_of(*nodes, kind=SingleThreadedExecutor):
    executor = kind()
    for each in nodes:
        executor.add_node(each)
    return executor

def spin(executor):
    while True:
        try:
            executor.spin()
        except Exception as error:
            told = f"{type(error).__name__} out of spin"
            if lines[-1:] != [told]:  # some releases raise it as often as they handed its callback over
                say(told)

"""


@dataclass(frozen=True)
class Differing:
    """A program, and what it says on releases: on their wheels, where there are any, and on the model."""

    behaviour: str
    program: str
    said: Mapping[str, str]

    @property
    def source(self) -> str:
        """The whole program."""
        return _HEAD + self.program


DIFFERING = (
    Differing(
        "newest_task_first",
        """
executor = executor_of(node)
def make():
    timer.cancel()
    for each in "abc":
        executor.create_task(say, each)
timer = node.create_timer(0.2, make)
after(0.6, finish)
spin(executor)
""",
        {"jazzy@7.1.5": "c, b, a", "jazzy": "c, b, a", "kilted@9.1.2": "a, b, c", "lyrical": "a, b, c"},
    ),
    Differing(
        "resumes_at_once",
        """
future = Future()
async def wait():
    timer.cancel()
    say("awaits")
    await future
    say("goes on")
timer = node.create_timer(0.2, wait)
node.create_timer(1.0, lambda: say("tick"), Exclusive())
after(0.5, lambda: (say("set"), future.set_result(None)))
after(1.4, finish)
spin(executor_of(node))
""",
        {
            "jazzy@7.1.5": "awaits, set, tick, goes on",
            "kilted@9.1.2": "awaits, set, tick, goes on",
            "jazzy@7.1.9": "awaits, set, goes on, tick",
            "lyrical": "awaits, set, goes on, tick",
        },
    ),
    Differing(
        "resumes_at_once",
        """
other = rclpy.create_node("o")
def answer(_, response):
    time.sleep(0.2)  # until the asking executor waits
    return response
other.create_service(SetBool, "s", answer)
client = other.create_client(SetBool, "s", callback_group=Reentrant())
async def ask():
    timer.cancel()
    await client.call_async(SetBool.Request())
    say(f"goes on in {threading.current_thread().name}")
timer = node.create_timer(0.3, ask)
node.create_timer(1.0, lambda: say("tick"), Exclusive())
for name, each in (("own", node), ("other", other)):
    threading.Thread(target=spin, args=(executor_of(each),), name=name, daemon=True).start()
time.sleep(1.5)
finish()
""",
        {
            "jazzy@7.1.5": "tick, goes on in own",
            "kilted@9.1.2": "tick, goes on in own",
            "jazzy@7.1.9": "goes on in other, tick",
        },
    ),
    Differing(
        "resumes_at_once",
        """
executor = executor_of(node)
future = Future()
async def wait():
    await future
    say("goes on")
def begin():
    first.cancel()
    executor.create_task(wait)
def go_on():
    second.cancel()
    future.set_result(None)
    executor.create_task(say, "later task")
first = node.create_timer(0.2, begin)
second = node.create_timer(0.5, go_on)
after(0.8, finish)
spin(executor)
""",
        {
            "jazzy@7.1.5": "later task, goes on",
            "jazzy@7.1.9": "later task, goes on",
            "kilted@9.1.2": "goes on, later task",
            "lyrical": "goes on, later task",
        },
    ),
    Differing(
        "hands_over_again",
        """
begun = set()
def begin_late(*_):
    if threading.get_ident() not in begun:
        begun.add(threading.get_ident())
        time.sleep(0.03)
def tell():
    workers = sum(each.name.startswith("ThreadPool") for each in threading.enumerate())
    say("one worker" if workers == 1 else "several workers")
    finish()
node.create_timer(0.1, lambda: None)
after(1.05, tell)
threading.setprofile(begin_late)  # no worker begins before the executor goes round again
spin(executor_of(node, kind=lambda: MultiThreadedExecutor(3)))
""",
        {
            "jazzy@7.1.5": "several workers",
            "kilted@9.1.2": "several workers",
            "jazzy": "one worker",
            "lyrical": "one worker",
        },
    ),
    Differing(
        "hands_over_again",
        """
future = Future()
async def wait():
    waiting.cancel()
    await future
def fail():
    failing.cancel()
    time.sleep(0.1)
    raise ValueError
waiting = node.create_timer(0.1, wait)
failing = node.create_timer(0.3, fail, Exclusive())
after(0.6, lambda: say("no cycle since"))
after(0.7, finish)
spin(executor_of(node, kind=lambda: MultiThreadedExecutor(1)))
""",
        {
            "jazzy@7.1.5": "ValueError out of spin, no cycle since",
            "kilted@9.1.2": "ValueError out of spin, no cycle since",
            "jazzy": "no cycle since",
            "lyrical": "no cycle since",
        },
    ),
    Differing(
        "loses_errors_after_await",
        """
future = Future()
async def wait():
    timer.cancel()
    await future
    raise ValueError
timer = node.create_timer(0.2, wait)
node.create_timer(0.8, lambda: say("tick"), Exclusive())
after(0.5, lambda: future.set_result(None))
after(1.2, finish)
spin(executor_of(node))
""",
        {
            "jazzy@7.1.5": "tick, ValueError out of spin",
            "kilted@9.1.2": "tick, ValueError out of spin",
            "jazzy@7.1.9": "tick",
            "humble@3.3.22": "ValueError out of spin, tick",
        },
    ),
    Differing(
        "refuses_second_spin",
        """
executor = executor_of(node)
node.create_service(SetBool, "s", lambda _, response: response, callback_group=Reentrant())
client = node.create_client(SetBool, "s", callback_group=Reentrant())
def ask():
    timer.cancel()
    future = client.call_async(SetBool.Request())
    attempt(lambda: executor.spin_until_future_complete(future, 1.0))
    say(f"answered {future.done()}")
timer = node.create_timer(0.3, ask)
after(1.7, lambda: (attempt(executor.spin), finish()))
spin(executor)
""",
        {
            "jazzy@7.1.5": "None, answered True, ValueError",
            "kilted@9.1.2": "None, answered True, ValueError",
            "jazzy@7.1.9": "RuntimeError, answered False, RuntimeError",
            "kilted@9.1.5": "RuntimeError, answered False, RuntimeError",
        },
    ),
    Differing(
        "wakes_once_for_a_future",
        """
executor = executor_of(node)
ticks = []
timer = node.create_timer(0.2, lambda: ticks.append(0))
future = Future(executor=executor)
after(0.7, lambda: future.set_result(None))
executor.spin_until_future_complete(future)
timer.cancel()
returned, empty = time.monotonic(), -1
while time.monotonic() < returned + 0.5:
    returned = time.monotonic()
    executor.spin_once(timeout_sec=1.0)
    empty += 1
say(f"{len(ticks)} calls, {empty} returns for nothing")
finish()
""",
        {
            "jazzy@7.1.5": "3 calls, 5 returns for nothing",
            "kilted@9.1.2": "3 calls, 1 returns for nothing",
            "jazzy@7.1.9": "3 calls, 1 returns for nothing",
        },
    ),
    Differing(
        "ends_workers",
        """
executor = executor_of(node, kind=lambda: MultiThreadedExecutor(2))
node.create_timer(0.2, lambda: (time.sleep(0.6), say("ends")))
threading.Thread(target=executor.spin, daemon=True).start()
time.sleep(0.5)
attempt(executor.shutdown)
attempt(lambda: executor.shutdown(wait_for_threads=False))
time.sleep(0.7)
finish()
""",
        {
            "jazzy@7.1.5": "True, TypeError, ends",
            "jazzy@7.1.9": "True, TypeError, ends",
            "jazzy@7.1.12": "ends, True, True",
            "kilted@9.1.2": "ends, True, True",
        },
    ),
    Differing(
        "events_executor_runs_coroutines",
        """
from rclpy.experimental import EventsExecutor
async def hear(message):
    say(f"hears {message.data}")
async def serve(_, response):
    say("serves")
    return response
node.create_subscription(Int32, "t", hear, 10)
node.create_service(SetBool, "s", serve)
client = node.create_client(SetBool, "s")
publisher = node.create_publisher(Int32, "t", 10)
def send():
    timer.cancel()
    publisher.publish(Int32(data=1))
    client.call_async(SetBool.Request()).add_done_callback(lambda _: say("answered"))
timer = node.create_timer(0.3, send)
attempt(lambda: executor_of(node, kind=EventsExecutor).spin_until_future_complete(Future(), 0.8))
finish()
""",
        {
            "jazzy@7.1.5": "TypeError",
            "jazzy@7.1.11": "hears 1, serves, answered, None",
            "kilted@9.1.2": "hears 1, serves, answered, None",
        },
    ),
    Differing(
        "call_takes_timeout",
        """
attempt(lambda: node.create_client(SetBool, "s").call(SetBool.Request(), timeout_sec=0.2))
finish()
""",
        {
            "humble": "TypeError",
            "jazzy@7.1.5": "None",
            "jazzy@7.1.9": "None",
            "kilted@9.1.2": "TimeoutError",
            "lyrical": "TimeoutError",
        },
    ),
    Differing(
        "gives_timer_info",
        """
attempt(lambda: __import__("rclpy.timer", fromlist=["TimerInfo"]).TimerInfo.__name__)
timer = node.create_timer(0.2, None)
attempt(lambda: executor_of(node).spin_once())
finish()
""",
        {
            "jazzy@7.1.5": "AttributeError, TypeError",
            "jazzy@7.1.9": "AttributeError, TypeError",
            "kilted@9.1.2": "TimerInfo, UnboundLocalError",
            "lyrical": "TimerInfo, UnboundLocalError",
        },
    ),
    Differing(
        "skips_cancelled_timers",
        """
def first():
    timer.cancel()
    time.sleep(0.4)
    second.cancel()
    say("cancelled")
timer = node.create_timer(0.3, first, Exclusive())
group = Exclusive()
second = node.create_timer(0.5, lambda: say("called"), group)
node.create_timer(1.2, lambda: say("other of the group"), group)
node.create_timer(1.0, lambda: say("tick"), Exclusive())
after(1.6, finish)
spin(executor_of(node, kind=lambda: MultiThreadedExecutor(1)))
""",
        {
            "jazzy@7.1.5": "cancelled, RCLError out of spin, tick",
            "humble@3.3.17": "cancelled, RCLError out of spin, tick",
            "jazzy@7.1.6": "cancelled, tick, other of the group",
            "kilted@9.1.2": "cancelled, tick, other of the group",
            "lyrical": "cancelled, tick, other of the group",
        },
    ),
    Differing(
        "ends_nodes_with_context",
        """
publisher = node.create_publisher(Int32, "t", 10)
rclpy.shutdown()
attempt(lambda: publisher.publish(Int32()))
attempt(node.get_name)
attempt(lambda: node.create_timer(1.0, finish))
finish()
""",
        {
            "jazzy@7.1.5": "RCLError, n, RCLError",
            "jazzy": "RCLError, n, RCLError",
            "kilted@9.1.2": "InvalidHandle, InvalidHandle, RCLError",
        },
    ),
    Differing(
        "has_with_blocks",
        """
def use(thing):
    with thing:
        return "ended with its block"

attempt(lambda: use(node.create_publisher(Int32, "t", 10)))
attempt(lambda: use(node.create_subscription(Int32, "t", print, 10)))
attempt(lambda: use(rclpy.create_node("m")))
attempt(lambda: use(rclpy.init(context=rclpy.Context())))
finish()
""",
        {
            "jazzy@7.1.5": ", ".join(["TypeError"] * 4),
            "jazzy": ", ".join(["TypeError"] * 4),
            "kilted@9.1.2": ", ".join(["ended with its block"] * 4),
        },
    ),
    Differing(
        "tells_missing_init",
        """
rclpy.shutdown()
attempt(lambda: rclpy.spin(node))
attempt(MultiThreadedExecutor)
finish()
""",
        {
            "jazzy@7.1.5": "TypeError, TypeError",
            "jazzy": "TypeError, TypeError",
            "kilted@9.1.2": "RuntimeError, RuntimeError",
        },
    ),
    Differing(
        "refuses_transitions",
        """
from lifecycle_msgs.srv import ChangeState
from rclpy.lifecycle import LifecycleNode
living = LifecycleNode("living")
client = node.create_client(ChangeState, "/living/change_state")
request = ChangeState.Request()
request.transition.id = 3  # activate, which an unconfigured one cannot
client.wait_for_service()
client.call_async(request).add_done_callback(lambda reply: say(f"{reply.result().success}"))
after(0.5, finish)
attempt(lambda: executor_of(node, living).spin())
time.sleep(1)
""",
        {"jazzy@7.1.5": "RCLError", "jazzy": "RCLError", "kilted@9.1.2": "False"},
    ),
    Differing(
        "keeps_attached_nodes",
        """
executor = executor_of(node)
rclpy.spin_once(node, executor=executor, timeout_sec=0.1)
say(f"{len(executor.get_nodes())}")
finish()
""",
        {
            "humble@3.3.16": "0",
            "jazzy@7.1.4": "0",
            "jazzy@7.1.5": "1",
            "jazzy@7.1.9": "1",
            "kilted@9.1.2": "1",
        },
    ),
    Differing(
        "warns_of_one_thread",
        """
with warnings.catch_warnings(record=True) as warned:
    warnings.simplefilter("always")
    MultiThreadedExecutor(1)
say(f"{len(warned)}")
finish()
""",
        {"humble": "0", "jazzy@7.1.5": "1", "kilted@9.1.2": "1"},
    ),
)
