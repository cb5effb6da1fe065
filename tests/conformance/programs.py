"""The plain rclpy programs that systems are."""

from tests.conformance.systems import Callback, System

_HEAD = """
import os, threading, time, warnings
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

warnings.simplefilter("ignore")
rclpy.init()
said, calls, sent = [], {}, {}

def say(what):
    said.append((time.monotonic() - began, what))

def called(name):
    calls[name] = calls.get(name, 0) + 1
    return calls[name]

def publish(topic):
    sent[topic] = sent.get(topic, 0) + 1
    publishers[topic].publish(Int32(data=sent[topic]))

def request(client, place):
    number = called(place)
    say(f"{place} #{number} asks")
    future = client.call_async(Trigger.Request())
    future.add_done_callback(lambda done: say(f"{place} #{number} got {done.result().message}"))

def request_in_task(node, client, place):
    number = called(place)
    async def ask():
        say(f"{place} #{number} awaits")
        response = await client.call_async(Trigger.Request())
        say(f"{place} #{number} goes on with {response.message}")
    node.executor.create_task(ask)

def make_task(node, place):
    number = called(place)
    node.executor.create_task(lambda: say(f"{place} #{number} runs"))

def spin(executor, name):
    told = []
    while rclpy.ok():
        try:
            executor.spin()
        except Exception as error:
            if error not in told:  # 7.1.6 and 9.1.2 raise one as often as they handed its callback over
                say(f"{name} raised {error}")
                told.append(error)
        else:
            return

class Placed(Node):
    # Executors keep nodes in a set; small numbers as hashes give it an order.
    def __init__(self, place):
        self.place = place
        super().__init__(f"n{place}", start_parameter_services=False, enable_rosout=False)

    def __hash__(self):
        return self.place
"""
_TAIL = """
while not all(p.get_subscription_count() >= heard[t] for t, p in publishers.items()):
    time.sleep(0.01)
for client in clients:
    client.wait_for_service()
time.sleep(0.1)
began = time.monotonic()
for timer in timers:
    timer.reset()
for name, executor in executors.items():
    threading.Thread(target=spin, args=(executor, name), daemon=True).start()
time.sleep({end:.6f})
lines = [f"{{at:.6f}} {{what}}" for at, what in said]
falls_due = [at / 1e9 - began for at in globals().get("moments", ())]
moments = sorted(at for at in falls_due if at > 1e-4)
late = max((late for at, late in globals().get("late", ()) if at > began), default=0)
print(*lines, "moments", *moments, f"late {{late:.6f}}", sep="\\n", flush=True)
os._exit(0)
"""


def program(system: System) -> str:
    """The program that a system is."""
    lines = [_HEAD]
    for place, threads in enumerate(system.executors):
        kind = f"MultiThreadedExecutor({threads})" if threads else "SingleThreadedExecutor()"
        lines.append(f"e{place} = {kind}")
    named = ", ".join(f'"e{place}": e{place}' for place in range(len(system.executors)))
    lines.append(f"executors = {{{named}}}")
    for place, executor in enumerate(system.nodes):
        lines += [f"n{place} = Placed({place})", f"e{executor}.add_node(n{place})"]
    for place, group in enumerate(system.groups):
        made = {"default": "None", "exclusive": "MutuallyExclusiveCallbackGroup()"}
        lines.append(f"g{place} = {made.get(group, 'ReentrantCallbackGroup()')}")
    for each in system.callbacks:
        lines += _callback(each)
    lines += _entities(system)
    return "\n".join(lines) + _TAIL.format(end=system.end)


def _callback(each: Callback) -> list[str]:
    name = f"{each.kind}_{each.place}"
    about = {"subscription": "message", "service": "_, response"}.get(each.kind, "")
    got = " takes {message.data}" if each.kind == "subscription" else ""
    lines = [
        f"def {name}({about}):",
        f'    number = called("{name}")',
        f'    say(f"{name} #{{number}} begins{got}")',
    ]
    for number, steps in enumerate(each.calls, start=1):
        written = [f"        {_written(each, word, what)}" for word, what in steps]
        lines += [f"    if number == {number}:", *(written or ["        pass"])]
    lines.append(f'    say(f"{name} #{{number}} ends")')
    if each.kind == "service":
        lines += ["    response.message = str(number)", "    return response"]
    return lines


def _written(callback: Callback, word: str, what: float) -> str:
    place, node = callback.place, f"n{callback.node}"
    return {
        "sleep": f"time.sleep({what:.6f})",
        "publish": f'publish("t{what:.0f}")',
        "ask": f'request(c{place}_{what:.0f}, "client_{place}_{what:.0f}")',
        "await": f'request_in_task({node}, c{place}_{what:.0f}, "client_{place}_{what:.0f}")',
        "task": f'make_task({node}, "task_{place}")',
        "trigger": f"x{what:.0f}.trigger()",
        "cancel": f"x{what:.0f}.cancel()",
        "reset": f"x{what:.0f}.reset()",
        "raise": 'raise ValueError("on purpose")',
    }[word]


def _entities(system: System) -> list[str]:
    heard: dict[str, int] = {}
    lines, timers, clients = [], [], []
    for each in system.callbacks:
        place, group = each.place, f"callback_group=g{each.group}"
        made = {
            "timer": f"create_timer({each.about:.6f}, timer_{place}, {group}, autostart=False)",
            "subscription": (
                f'create_subscription(Int32, "t{each.about:.0f}", subscription_{place}, {each.depth}, '
                f"{group})"
            ),
            "service": (f'create_service(Trigger, "s{each.about:.0f}", service_{place}, {group})'),
            "guard": f"create_guard_condition(guard_{place}, {group})",
        }
        lines.append(f"x{place} = n{each.node}.{made[each.kind]}")
        if each.kind == "timer":
            timers.append(f"x{place}")
        if each.kind == "subscription":
            heard[f"t{each.about:.0f}"] = heard.get(f"t{each.about:.0f}", 0) + 1
        asked = {int(what) for steps in each.calls for word, what in steps if word in ("ask", "await")}
        for service in sorted(asked):
            clients.append(f"c{place}_{service}")
            lines.append(f'{clients[-1]} = n{each.node}.create_client(Trigger, "s{service}", {group})')
    publishers = ", ".join(f'"{topic}": n0.create_publisher(Int32, "{topic}", 10)' for topic in heard)
    return [
        *lines,
        f"heard = {heard}",
        f"publishers = {{{publishers}}}",
        f"timers = [{', '.join(timers)}]",
        f"clients = [{', '.join(clients)}]",
    ]
