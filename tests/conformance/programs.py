"""The plain rclpy programs that systems are."""

from tests.conformance.systems import EVENTS, FUTURES, WORDS, Callback, System

_HEAD = """
import os, threading, time, warnings
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Int32
from std_srvs.srv import Trigger

warnings.simplefilter("ignore")
rclpy.init()
said, calls, sent, there, timers, clients, goals, unanswered = [], {}, {}, {}, [], {}, {}, {}
overslept = []

says = globals().get("says", lambda what: None)

def say(what):
    at = time.monotonic() - began
    says(what)  # no other thread of the model comes between this and the next line
    said.append((at, what))

def sleep(seconds):
    since = time.monotonic()
    time.sleep(seconds)
    overslept.append(time.monotonic() - since - seconds)

def called(name):
    calls[name] = calls.get(name, 0) + 1
    return calls[name]

def publish(topic):
    sent[topic] = sent.get(topic, 0) + 1
    publishers[topic].publish(Int32(data=sent[topic]))

def ask_for(name, number, how):
    say(f"{name} #{number} {how}")
    unanswered[name] = unanswered.get(name, 0) + 1

def answered(name, number, how, response):
    unanswered[name] -= 1
    say(f"{name} #{number} {how} {response.message}")

def request(name):
    number = called(name)
    ask_for(name, number, "asks")
    future = clients[name].call_async(Trigger.Request())
    future.add_done_callback(lambda done: answered(name, number, "got", done.result()))

async def ask(name, number):
    ask_for(name, number, "awaits")
    answered(name, number, "goes on with", await clients[name].call_async(Trigger.Request()))

def call(name, patience):
    number = called(name)
    ask_for(name, number, "calls")
    try:
        response = clients[name].call(Trigger.Request(), timeout_sec=patience)
    except TimeoutError:
        response = None  # as on Jazzy
    if response is None:
        say(f"{name} #{number} gives up")
    else:
        answered(name, number, "comes back with", response)

async def wait(future, name, number):
    say(f"{name} #{number} waits")
    await futures[future]
    say(f"{name} #{number} goes on")

def give(place):
    future, futures[place] = futures[place], Future()
    future.set_result(None)

def make(place):
    if place not in there:
        there[place] = entity = makers[place]()
        if hasattr(entity, "reset"):
            timers.append(entity)
            entity.reset()
        settle()

def destroy(place):
    entity = there.pop(place, None)
    if entity is not None:
        if entity in timers:
            timers.remove(entity)
        destroyers[place](entity)

def tell(place, what):
    if place in there:
        getattr(there[place], what)()

def renew(name):
    if unanswered.get(name):
        return  # Fast DDS keeps who answers a client that is gone for 0.1 s
    node, service, group = asked[name]
    former = clients.pop(name, None)
    if former is not None:
        node.destroy_client(former)
    clients[name] = node.create_client(Trigger, f"s{service}", callback_group=group)
    settle()

def send_goal(name):
    number = called(name)
    say(f"{name} #{number} sends")
    def accepted(done):
        goals[name] = done.result()
        say(f"{name} #{number} is accepted")
        goals[name].get_result_async().add_done_callback(ended)
    def ended(done):
        say(f"{name} #{number} ends as {done.result().status}")
    def heard(message):
        say(f"{name} #{number} hears {message.feedback.sequence[0]}")
    actions[name].send_goal_async(Fibonacci.Goal(), feedback_callback=heard).add_done_callback(accepted)

def recall(name):
    if name in goals:
        say(f"{name} recalls")
        answer = goals[name].cancel_goal_async()
        answer.add_done_callback(lambda done: say(f"{name} {len(done.result().goals_canceling)} recalled"))

def make_task(node, place):
    number = called(place)
    node.executor.create_task(lambda: say(f"{place} #{number} runs"))

def spin(executor, name):
    told = []
    while rclpy.ok():
        try:
            if isinstance(executor, (SingleThreadedExecutor, MultiThreadedExecutor)):
                executor.spin()
            else:  # whose spin() never wakes on the wheels
                executor.spin_until_future_complete(Future(), 100)
        except Exception as error:
            if error not in told:  # 7.1.5 and 9.1.2 raise one as often as they handed its callback over
                say(f"{name} raised {error if isinstance(error, ValueError) else type(error).__name__}")
                told.append(error)
        else:
            return

def settle():
    # Whatever was made has to be known to the others.
    def is_settled():
        for topic, publisher in publishers.items():
            if publisher.get_subscription_count() < sum(place in there for place in heard[topic]):
                return False
        if not all(action.server_is_ready() for action in actions.values()):
            return False
        return all(clients[name].service_is_ready() or asked[name][1] not in there for name in clients)
    while not is_settled():
        time.sleep(0.001)

class Placed(Node):
    # Executors keep nodes in a set; small numbers as hashes give it an order.
    def __init__(self, place):
        self.place = place
        super().__init__(f"n{place}", start_parameter_services=False, enable_rosout=False)

    def __hash__(self):
        return self.place
"""
_ACTIONS = """
from rclpy.action import ActionClient, ActionServer, CancelResponse
from test_msgs.action import Fibonacci
"""
_TAIL = """
def tell_all():
    ended = time.monotonic() - began
    lines = [f"{{at:.6f}} {{what}}" for at, what in said]
    made = globals().get("choices", ())
    falls_due = [at / 1e9 - began for at in globals().get("moments", ())]
    moments = sorted(at for at in falls_due if at > 1e-4)
    choices = [f"choice {{line}} {{options}} {{chosen}}" for line, options, chosen in made]
    late_at = [late for at, late in globals().get("late", ()) if at > began]
    late = max(ended - {end:.6f}, sum(overslept) * {of_gap}, *late_at)
    print(*lines, "moments", *moments, *choices, f"late {{late:.6f}}", sep="\\n", flush=True)
    os._exit(0)

for place, maker in makers.items():
    if place not in missing:
        there[place] = maker()
for name in asked:
    renew(name)
settle()
time.sleep(0.1)
began = time.monotonic()
timers += [entity for entity in there.values() if hasattr(entity, "reset")]
for timer in timers:
    timer.reset()
for name, executor in executors.items():
    threading.Thread(target=spin, args=(executor, name), daemon=True).start()
time.sleep({end:.6f})
tell_all()
"""
_LATE_OF_GAP = 0.4
"""How much delays of sleeps count that add up: together they may come to the gap between two moments."""
_EXECUTORS = {0: "SingleThreadedExecutor()", EVENTS: "EventsExecutor()"}
_GROUPS = {
    "default": "None",
    "exclusive": "MutuallyExclusiveCallbackGroup()",
    "reentrant": "ReentrantCallbackGroup()",
}
_STEPS = {
    "sleep": "sleep({what:.6f})",
    "publish": 'publish("t{what:.0f}")',
    "ask": 'request("client_{place}_{what:.0f}")',
    "await": 'await ask("client_{place}_{what:.0f}", called("client_{place}_{what:.0f}"))',
    "call": 'call("client_{place}_{what:.0f}", {patience:.6f})',
    "renew": 'renew("client_{place}_{what:.0f}")',
    "task": 'make_task(n{node}, "task_{place}")',
    "wait": 'await wait({what:.0f}, "wait_{place}", called("wait_{place}"))',
    "give": "give({what:.0f})",
    "trigger": 'tell({what:.0f}, "trigger")',
    "cancel": 'tell({what:.0f}, "cancel")',
    "reset": 'tell({what:.0f}, "reset")',
    "make": "make({what:.0f})",
    "destroy": "destroy({what:.0f})",
    "goal": 'send_goal("goal_{place}_{what:.0f}")',
    "recall": 'recall("goal_{place}_{what:.0f}")',
    "feedback": "goal.publish_feedback(Fibonacci.Feedback(sequence=[number]))",
    "raise": 'raise ValueError("on purpose")',
}
_MAKERS = {
    "timer": "create_timer({about:.6f}, {name}, {group}, autostart=False)",
    "subscription": 'create_subscription(Int32, "t{about:.0f}", {name}, {depth}, {group})',
    "service": 'create_service(Trigger, "s{about:.0f}", {name}, {group})',
    "guard": "create_guard_condition({name}, {group})",
}
_ACTION_SERVER = (
    'ActionServer(n{node}, Fibonacci, "a{place}", {name}, cancel_callback=lambda _: CancelResponse.ACCEPT, '
    "{group})"
)
_PARAMETERS = {"subscription": "message", "service": "_, response", "action": "goal"}
_LAST = {
    "service": ["response.message = str(number)", "return response"],
    "action": [
        "goal.canceled() if goal.is_cancel_requested else goal.succeed()",
        "return Fibonacci.Result()",
    ],
}


def program(system: System) -> str:
    """The program that a system is."""
    lines = [_HEAD]
    if any(each.kind == "action" for each in system.callbacks):
        lines.append(_ACTIONS)
    lines.append(f"futures = [Future() for _ in range({FUTURES})]")
    for place, threads in enumerate(system.executors):
        lines.append(f"e{place} = {_EXECUTORS.get(threads, f'MultiThreadedExecutor({threads})')}")
    named = ", ".join(f'"e{place}": e{place}' for place in range(len(system.executors)))
    lines.append(f"executors = {{{named}}}")
    for place, executor in enumerate(system.nodes):
        lines += [f"n{place} = Placed({place})", f"e{executor}.add_node(n{place})"]
    lines += [f"g{place} = {_GROUPS[group]}" for place, group in enumerate(system.groups)]
    for each in system.callbacks:
        lines += _callback(each)
    return "\n".join([*lines, *_entities(system)]) + _TAIL.format(end=system.end, of_gap=_LATE_OF_GAP)


def _callback(each: Callback) -> list[str]:
    name = f"{each.kind}_{each.place}"
    got = " takes {message.data}" if each.kind == "subscription" else ""
    lines = [
        f"{'async ' if each.is_coroutine else ''}def {name}({_PARAMETERS.get(each.kind, '')}):",
        f'    number = called("{name}")',
        f'    say(f"{name} #{{number}} begins{got}")',
    ]
    for number, steps in enumerate(each.calls, start=1):
        written = [f"        {_written(each, word, what)}" for word, what in steps]
        lines += [f"    if number == {number}:", *(written or ["        pass"])]
    lines.append(f'    say(f"{name} #{{number}} ends")')
    return [*lines, *(f"    {line}" for line in _LAST.get(each.kind, ()))]


def _written(callback: Callback, word: str, what: float) -> str:
    step = _STEPS[word].format(**vars(callback), what=what)
    if step.startswith("await ") and not callback.is_coroutine:
        return f"n{callback.node}.executor.create_task({step.removeprefix('await ')})"
    return step


def _entities(system: System) -> list[str]:
    heard: dict[str, list[int]] = {}
    makers, destroyers, clients, actions = [], [], [], []
    for each in system.callbacks:
        group = f"callback_group=g{each.group}"
        written = {**vars(each), "name": f"{each.kind}_{each.place}", "group": group}
        if each.kind == "action":
            made = _ACTION_SERVER.format(**written)
        else:
            made = f"n{each.node}.{_MAKERS[each.kind].format(**written)}"
        makers.append(f"{each.place}: lambda: {made}")
        destroyers.append(f"{each.place}: getattr(n{each.node}, 'destroy_{each.kind}', None)")
        if each.kind == "subscription":
            heard.setdefault(f"t{each.about:.0f}", []).append(each.place)
        about = {(word, int(what)) for steps in each.calls for word, what in steps}
        clients += [
            f'"client_{each.place}_{service}": (n{each.node}, {service}, g{each.group})'
            for service in sorted({what for word, what in about if "service" in WORDS[word].about[:1]})
        ]
        actions += [
            f'"goal_{each.place}_{server}": ActionClient(n{each.node}, Fibonacci, "a{server}", {group})'
            for server in sorted({what for word, what in about if word in ("goal", "recall")})
        ]
    publishers = ", ".join(f'"{topic}": n0.create_publisher(Int32, "{topic}", 10)' for topic in heard)
    return [
        f"missing = {[each.place for each in system.callbacks if each.is_late]}",
        f"heard = {heard}",
        f"publishers = {{{publishers}}}",
        f"actions = {{{', '.join(actions)}}}",
        f"makers = {{{', '.join(makers)}}}",
        f"destroyers = {{{', '.join(destroyers)}}}",
        f"asked = {{{', '.join(clients)}}}",
    ]
