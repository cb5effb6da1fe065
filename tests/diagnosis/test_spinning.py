"""A spin inside a spin: told with the line that asks for it, and with what to do in its place."""

from pathlib import Path

import pytest
from msgspec.structs import replace

from lessons.checks import never_stuck
from sim.diagnosis import Finding, Weight, diagnose
from sim.engine.setup import RealRos
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import (
    AnyEvent,
    Doing,
    Printed,
    ProgramAt,
    ServiceCalled,
    ServiceReplied,
    SpinClashed,
    TimePassed,
)
from sim.trace.timeline import Timeline
from tests.real.programs import needs_ros
from tests.support.daily import first_row_daily
from tests.support.engine_runs import Run, program_setup, run_program, run_to_end

PROGRAM = """
import threading
import traceback
import rclpy
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool


class Caller(Node):
    def __init__(self):
        super().__init__("caller")
        self.create_service(SetBool, "power", self.serve)
        self.client = self.create_client(SetBool, "power")
        self.create_timer(0.5, self.tick)

    def serve(self, request, response):
        return response

    def tick(self):
        future = self.client.call_async(SetBool.Request())
        {ask}


rclpy.init()
caller = Caller()
{spin}
"""
EXPLICIT = "executor = {}\nexecutor.add_node(caller)\nexecutor.spin()"
SINGLE = EXPLICIT.format("SingleThreadedExecutor()")
MULTI = EXPLICIT.format("MultiThreadedExecutor(3)")
REFUSED = "tick spins the executor that runs tick, by {}(): RuntimeError: Executor is already spinning"
FOR_EVER = (
    "deadlock: tick waits in spin_until_future_complete() for ever; "
    "all callbacks of its node are in group A, which tick holds"
)
TAKEN = "node /caller left its executor, which no longer serves it; {}() in tick has taken it over"


REPLY_HELD = (
    "deadlock: tick waits in spin_until_future_complete() for ever; "
    "the reply of /power waits for group B, which tick holds"
)


def program(ask: str, spin: str = "rclpy.spin(caller)") -> str:
    return PROGRAM.replace("{ask}", ask).replace("{spin}", spin)


def found_in(run: Run) -> list[Finding]:
    return [each for each in diagnose(run.timeline) if each.rule.id == "nested-spin"]


@pytest.mark.parametrize(
    ("ask", "spin", "what", "cure"),
    first_row_daily(
        (
            "rclpy.spin_until_future_complete(self, future)",
            "rclpy.spin(caller)",
            REFUSED.format("spin_until_future_complete"),
            "after call_async() let tick return",
        ),
        (
            "self.executor.spin_until_future_complete(future)",
            SINGLE,
            REFUSED.format("spin_until_future_complete"),
            "spin with MultiThreadedExecutor(num_threads=2)",
        ),
        ("rclpy.spin_once(self)", "rclpy.spin(caller)", REFUSED.format("spin_once"), "leave spin_once() out"),
        ("rclpy.spin(self)", "rclpy.spin(caller)", REFUSED.format("spin"), "leave spin() out"),
        (
            "rclpy.spin_until_future_complete(self, future)",
            SINGLE,
            FOR_EVER,
            "after call_async() let tick return",
        ),
        (
            "rclpy.spin_until_future_complete(self, future)",
            MULTI,
            FOR_EVER,
            "after call_async() let tick return",
        ),
        (
            "rclpy.spin_until_future_complete(self, future, timeout_sec=0.3)",
            SINGLE,
            TAKEN.format("spin_until_future_complete"),
            "after call_async() let tick return",
        ),
    ),
)
def test_a_callback_that_spins_what_runs_it_is_told_with_its_line(
    ask: str, spin: str, what: str, cure: str, tmp_path: Path
) -> None:
    run = run_program(tmp_path, program(ask, spin), 4.0)
    findings = diagnose(run.timeline)
    (found,) = found_in(run)
    told = found.explained(run.timeline)
    assert findings[0] == found
    assert not {"group-starvation", "node-never-spins"} & {each.rule.id for each in findings}
    assert told.what == what
    assert cure in told.cure
    assert str(told.place) == "node.py:22"


@pytest.mark.parametrize(
    ("ask", "what"),
    [
        ("rclpy.spin_until_future_complete(self, future)", FOR_EVER),
        (
            "rclpy.spin_until_future_complete(self, future, timeout_sec=0.3)",
            "tick spins the executor that runs tick, by spin_until_future_complete() (2 times in all)",
        ),
    ],
)
def test_a_release_that_refuses_no_second_spin_is_not_said_to(ask: str, what: str, tmp_path: Path) -> None:
    run = run_program(tmp_path, program(ask), 1.2, distro="jazzy@7.1.6")
    (found,) = found_in(run)
    assert found.explained(run.timeline).what == what


@pytest.mark.parametrize(
    "ask",
    [
        "while rclpy.ok(): rclpy.spin_once(self, timeout_sec=0.1)",
        "rclpy.spin_once(self, timeout_sec=0.7)",
    ],
    ids=["stays in its loop", "takes longer than its period"],
)
def test_how_long_a_callback_takes_that_spins_its_executor_is_no_problem_beside_that(
    ask: str, tmp_path: Path
) -> None:
    text = program(ask).replace("future = self.client.call_async(SetBool.Request())", "pass")
    run = run_program(tmp_path, text, 4.0, distro="jazzy@7.1.6")
    assert [each.rule.id for each in diagnose(run.timeline)] == ["nested-spin"]


def test_a_request_that_a_spinning_callback_keeps_out_is_a_ring_although_others_run(tmp_path: Path) -> None:
    apart = "self.create_timer(0.7, lambda: None, callback_group=MutuallyExclusiveCallbackGroup())"
    alone = "self.create_timer(0.5, self.tick)"
    text = program("rclpy.spin_until_future_complete(self, future)").replace(alone, f"{alone}; {apart}")
    run = run_program(
        tmp_path,
        f"from rclpy.callback_groups import MutuallyExclusiveCallbackGroup\n{text}",
        4.0,
        distro="jazzy@7.1.6",
    )
    (found,) = found_in(run)
    assert found.explained(run.timeline).what == (
        "deadlock: tick waits in spin_until_future_complete() for ever; /power waits for group A, "
        "which tick holds"
    )


def test_a_spin_without_end_inside_a_callback_is_a_ring_and_nothing_moves(tmp_path: Path) -> None:
    run = run_program(tmp_path, program("rclpy.spin_until_future_complete(self, future)", SINGLE), 4.0)
    (found,) = found_in(run)
    assert found.ring == ("tick", "spin_until_future_complete()", "group A", "tick")
    assert found.explained(run.timeline).for_ever
    assert [each.rule.id for each in diagnose(run.timeline)] == ["nested-spin"]


def test_the_reply_that_a_spinning_callback_keeps_out_is_a_ring_although_others_run(tmp_path: Path) -> None:
    apart = "self.create_timer(0.7, lambda: None, callback_group=MutuallyExclusiveCallbackGroup())"
    text = program("rclpy.spin_until_future_complete(self, future)", MULTI)
    alone = "self.create_timer(0.5, self.tick)"
    text = text.replace(alone, f"{alone}\n        {apart}")
    reentrant = "callback_group=ReentrantCallbackGroup()"
    text = text.replace("self.serve)", f"self.serve, {reentrant})")
    groups = "from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup"
    run = run_program(tmp_path, f"{groups}\n{text}", 4.0)
    (found,) = found_in(run)
    assert found.explained(run.timeline).what == REPLY_HELD
    assert found.ring == ("tick", "spin_until_future_complete()", "group B", "tick")
    assert not never_stuck().judge(run.timeline).passed


def test_a_node_of_its_own_may_be_spun_inside_a_callback(tmp_path: Path) -> None:
    ask = "rclpy.spin_until_future_complete(helper, future, timeout_sec=0.1)"
    spin = f"helper = rclpy.create_node('helper')\n{SINGLE}"
    assert found_in(run_program(tmp_path, program(ask, spin))) == []


def test_two_threads_that_spin_one_executor_are_told_of_too(tmp_path: Path) -> None:
    spin = (
        "threading.Thread(target=rclpy.spin, args=(caller,), daemon=True).start()\n"
        "future = caller.client.call_async(SetBool.Request())\n"
        "caller.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.1))\n"
        "rclpy.spin_until_future_complete(caller, future)"
    )
    run = run_program(tmp_path, program("pass", spin))
    (found,) = found_in(run)
    told = found.explained(run.timeline)
    assert told.what.startswith("the program spins an executor that another thread spins, by spin_until")
    assert told.cure.startswith("spin each node in one thread only")
    assert [(each.function, each.line) for each in run.events if isinstance(each, SpinClashed)] == [
        ("spin_until_future_complete", 30)
    ]


def lines_printed(run: Run) -> list[str]:
    return [each.text for each in run.events if isinstance(each, Printed)]


def test_a_traceback_has_the_learners_lines_alone(tmp_path: Path) -> None:
    run = run_program(tmp_path, program("rclpy.spin_until_future_complete(self, future)"))
    underlines = " ~^"  # of some calls, from 3.13 on
    assert [line for line in lines_printed(run) if line.strip(underlines)] == [
        "Traceback (most recent call last):",
        f'  File "{tmp_path}/node.py", line 27, in <module>',
        "    rclpy.spin(caller)",
        f'  File "{tmp_path}/node.py", line 22, in tick',
        "    rclpy.spin_until_future_complete(self, future)",
        "RuntimeError: Executor is already spinning",
    ]


def run_lines(tmp_path: Path, *lines: str, seconds: float = 4.0) -> Run:
    return run_program(tmp_path, "\n".join(["import time", "import rclpy", *lines]), seconds)


IN_CONSTRUCTOR = (
    "from rclpy.node import Node",
    "class Early(Node):",
    "    def __init__(self):",
    "        super().__init__('early')",
    "        rclpy.spin(self)",
    "        self.create_timer(0.5, self.tick)",
    "    def tick(self): pass",
    "rclpy.init()",
    "rclpy.spin(Early())",
)


def test_a_node_that_spins_in_its_constructor_is_told_with_the_line_of_the_spin(tmp_path: Path) -> None:
    run = run_lines(tmp_path, *IN_CONSTRUCTOR)
    (found,) = diagnose(run.timeline)
    told = found.explained(run.timeline)
    assert told.what == "__init__ calls spin(), which does not come back: what follows line 7 never runs"
    assert str(told.place) == "node.py:7"
    (remedy,) = told.remedies
    assert remedy.edit is not None
    assert remedy.edit.applied("\n".join(["import time", "import rclpy", *IN_CONSTRUCTOR])) == "\n".join(
        ["import time", "import rclpy", *IN_CONSTRUCTOR[:4], *IN_CONSTRUCTOR[5:]]
    )


def test_a_constructor_that_spins_for_a_moment_is_well(tmp_path: Path) -> None:
    lines = [each.replace("spin(self)", "spin_once(self, timeout_sec=0.5)") for each in IN_CONSTRUCTOR]
    run = run_lines(tmp_path, *lines)
    assert diagnose(run.timeline) == ()
    assert run.timeline.program_at(run.timeline.end) is None


def test_a_program_that_loops_and_never_spins_is_told_with_its_loop(tmp_path: Path) -> None:
    run = run_lines(
        tmp_path,
        "rclpy.init()",
        "node = rclpy.create_node('n')",
        "node.create_timer(0.5, lambda: None)",
        "while rclpy.ok():",
        "    time.sleep(0.2)",
    )
    (found,) = diagnose(run.timeline)
    told = found.explained(run.timeline)
    assert found.rule.id == "node-never-spins"
    assert "the program is in the loop of line 6, and comes to no spin()" in told.what
    assert str(told.place) == "node.py:6"


@pytest.mark.parametrize(
    ("loop", "told"),
    [
        (
            "while rclpy.ok():",
            ["on_news of /n cannot run: the program is in the loop of line 10, and comes to no spin()"],
        ),
        ("while time.time() < node.until:", []),
    ],
)
def test_a_program_that_loops_is_told_of_even_if_no_callback_is_ready_yet(
    tmp_path: Path, loop: str, told: list[str]
) -> None:
    run = run_lines(
        tmp_path,
        "from std_msgs.msg import Empty",
        "rclpy.init()",
        "node = rclpy.create_node('n')",
        "node.until = time.time() + 60",
        "def on_news(_):",
        "    pass",
        "node.create_subscription(Empty, '/news', on_news, 1)",
        loop,
        "    time.sleep(0.2)",
    )
    assert [each.explained(run.timeline).what for each in diagnose(run.timeline)] == told


RARELY = (
    "from std_msgs.msg import String",
    "rclpy.init()",
    "node = rclpy.create_node('n')",
    "node.create_subscription(String, 'a', lambda message: None, 3)",
    "publisher = node.create_publisher(String, 'a', 10)",
    "while rclpy.ok():",
    "    [publisher.publish(String()) for _ in range(2)]",
)


def test_a_loop_that_spins_too_rarely_is_told_with_its_line(tmp_path: Path) -> None:
    run = run_lines(tmp_path, *RARELY, "    rclpy.spin_once(node)", "    time.sleep(1.3)", seconds=6.4)
    [found] = [each for each in diagnose(run.timeline) if each.rule.id == "node-never-spins"]
    never = found.explained(run.timeline)
    assert never.what.endswith("does not run: the program is in the loop of line 8, and spins too rarely")
    assert found.at < 2 * SECOND  # when it began, not when it was worst
    assert str(never.place) == "node.py:8"


def test_a_loop_after_a_spin_that_has_returned_spins_no_more(tmp_path: Path) -> None:
    lines = (
        "rclpy.init()",
        "node = rclpy.create_node('n')",
        "executor = rclpy.executors.SingleThreadedExecutor()",
        "executor.add_node(node)",
        "node.create_timer(0.1, lambda: None)",
        "node.create_timer(0.5, lambda: executor.shutdown())",
        "executor.spin()",
        "while rclpy.ok():",
        "    time.sleep(0.1)",
    )
    run = run_lines(tmp_path, *lines, seconds=4.0)
    [told] = [each.explained(run.timeline) for each in diagnose(run.timeline)]
    assert told.what.endswith(", and spins no more")
    assert told.cure.startswith("keep spinning the node: ")


def test_messages_that_are_lost_between_two_spins_are_told_with_the_loop(tmp_path: Path) -> None:
    run = run_lines(tmp_path, *RARELY, "    rclpy.spin_once(node)", "    time.sleep(0.2)", seconds=5.0)
    (found,) = diagnose(run.timeline)
    told = found.explained(run.timeline)
    assert found.rule.id == "dropped-messages"
    assert str(told.place) == "node.py:8"
    assert told.cure.startswith("do one step of the loop in a timer's callback, and call rclpy.spin(node)")


def test_what_a_timer_could_know_is_not_told_where_the_node_is_spun_too_rarely(tmp_path: Path) -> None:
    timer = "node.create_timer(0.1, lambda: publisher.publish(String()))"
    spins = "    rclpy.spin_once(node, timeout_sec=0)"
    run = run_lines(tmp_path, *RARELY[:5], timer, RARELY[5], spins, "    time.sleep(1.2)", seconds=16.0)
    assert "stale-data" not in {each.rule.id for each in diagnose(run.timeline)}


def test_a_loop_in_the_main_thread_beside_a_thread_that_spins_is_well(tmp_path: Path) -> None:
    spins = "threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()"
    lines = (*RARELY[:5], "import threading", spins, *RARELY[5:], "    time.sleep(1.3)")
    run = run_lines(tmp_path, *lines, seconds=7.0)
    assert diagnose(run.timeline) == ()
    assert run.timeline.program_at(run.timeline.end) is None


def test_a_program_that_waits_for_a_service_before_it_spins_is_told_of_the_one_that_is_meant(
    tmp_path: Path,
) -> None:
    run = run_lines(
        tmp_path,
        "from std_srvs.srv import SetBool",
        "rclpy.init()",
        "node = rclpy.create_node('n')",
        "node.create_service(SetBool, 'lamp', lambda request, response: response)",
        "client = node.create_client(SetBool, 'lampe')",
        "while not client.wait_for_service(timeout_sec=1.0):",
        "    pass",
    )
    (found,) = diagnose(run.timeline)
    told = found.explained(run.timeline)
    assert told.what == (
        "the program waits in wait_for_service() for /lampe, which nobody has offered so far, "
        "and comes to no spin()"
    )
    assert told.cure == "call /lamp, which is offered (node.py:6)"
    assert told.for_ever
    assert str(told.place) == "node.py:8"


def test_a_program_that_spins_as_it_should_records_no_position(tmp_path: Path) -> None:
    run = run_program(tmp_path, program("pass"))
    assert not [each for each in run.events if isinstance(each, ProgramAt)]


@pytest.mark.parametrize("last_words", ["rclpy.shutdown()", "raise ValueError"])
def test_a_spin_that_came_back_is_not_said_to_keep_the_next_from_being_reached(
    last_words: str, tmp_path: Path
) -> None:
    text = (Path(__file__).parent / "beginners" / "two_spins_of_new_nodes.py").read_text()
    text = text.replace(
        "create_timer(0.5, lambda: self.pub", "create_timer(1.5, self.stop); (lambda: self.pub"
    )
    text = text.replace("class Listener", f"    def stop(self):\n        {last_words}\n\n\nclass Listener")
    found = diagnose(run_program(tmp_path, text, 3.0).timeline)
    assert "spin-not-reached" not in {each.rule.id for each in found}


def test_what_a_node_loses_once_a_spin_has_taken_it_is_put_down_to_that_and_no_thread_is_called_spare(
    tmp_path: Path,
) -> None:
    text = program("rclpy.spin_until_future_complete(self, future, timeout_sec=0.5)", MULTI).replace(
        "        self.create_timer(0.5, self.tick)",
        "        self.create_subscription(String, 'news', lambda message: None, 2)\n"
        "        self.create_timer(0.5, self.tick)",
    )
    text = text.replace("rclpy.init()", PAPER)
    run = run_program(tmp_path, text, 4.0)
    nested, lost = diagnose(run.timeline)
    assert nested.rule.id == "nested-spin"
    assert lost.rule.id == "dropped-messages"
    assert lost.weight_in(run.timeline) is Weight.REMARK
    told = lost.explained(run.timeline)
    assert "while it waited (nobody spins)" in told.what
    assert told.cure == "keep spinning its node; a longer queue only delays it"


PAPER = """from std_msgs.msg import String

rclpy.init()
paper = Node("paper")
publisher = paper.create_publisher(String, "news", 10)
paper.create_timer(0.05, lambda: publisher.publish(String()))
printing = SingleThreadedExecutor()
printing.add_node(paper)
threading.Thread(target=printing.spin, daemon=True).start()
"""


def spun_twice(end: float, *more: AnyEvent) -> Timeline:
    """A program that calls a service at 1 s, and from 2 s on spins what another thread spins."""
    function, line = "spin_until_future_complete", 17
    timeline = Timeline()
    timeline.extend([ServiceCalled(SECOND, 1, "/home", 0, "")])
    timeline.extend([SpinClashed(2 * SECOND, 0, 0, function, "node.py", line, endless=True, refused=False)])
    timeline.extend([ProgramAt(2 * SECOND, Doing.CALLS_ROS, function, (("node.py", "main", line),))])
    timeline.extend([*more, TimePassed(round(end * SECOND))])
    return timeline


WAITS_ON = (
    "the program waits in spin_until_future_complete() for 1.5 s, though its call of /home was answered"
)
REPLY = ServiceReplied(2 * SECOND, 1, "/home", "")


@pytest.mark.parametrize(
    ("end", "more", "weight"),
    [
        (3.5, [REPLY], Weight.PROBLEM),
        (3.5, [], Weight.REMARK),
        (2.5, [REPLY], Weight.REMARK),
        (3.5, [REPLY, ProgramAt(2 * SECOND, Doing.COMPUTES, "", ())], Weight.REMARK),
    ],
    ids=["waits on", "without reply", "not for long", "goes on"],
)
def test_two_threads_that_spin_one_executor_are_a_problem_once_one_waits_on_after_the_reply(
    end: float, more: list[AnyEvent], weight: Weight
) -> None:
    timeline = spun_twice(end, *more)
    (found,) = diagnose(timeline)
    told = found.explained(timeline)
    assert found.weight_in(timeline) is weight
    assert (told.what == WAITS_ON) is (weight is Weight.PROBLEM)
    assert ("cbtui explore" in told.why) is (weight is Weight.REMARK)


TWO_THREADS = """
import threading
import rclpy
from std_srvs.srv import Trigger

rclpy.init()
node = rclpy.create_node("caller")
node.create_service(Trigger, "home", lambda request, response: response)
client = node.create_client(Trigger, "home")
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
for _ in range(5000):
    future = client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(node, future)
"""


@needs_ros
@pytest.mark.slow
def test_on_real_ros_a_spin_that_another_thread_leaves_waiting_is_told_with_the_call(tmp_path: Path) -> None:
    (tmp_path / "node.py").write_text(TWO_THREADS)
    setup = program_setup(tmp_path / "node.py", 6.0, "real")
    timeline = run_to_end(replace(setup, real=RealRos())).timeline
    (found,) = diagnose(timeline)
    assert found.rule.id == "nested-spin"
    told = found.explained(timeline)
    assert told.what.startswith("the program waits in spin_until_future_complete() for")
    assert told.what.endswith("though its call of /home was answered")
    assert str(told.place) == "node.py:13"


ASKS_ITSELF = """
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup as Group
from rclpy.executors import MultiThreadedExecutor
from std_srvs.srv import Trigger


def serve(request, response):
    return response


def ask():
    ASK


rclpy.init()
node = rclpy.create_node("n")
node.create_service(Trigger, "own", serve)
client = node.create_client(Trigger, "own")
node.create_timer(0.5, ask)
executor = MultiThreadedExecutor(2)
executor.add_node(node)
executor.spin()
"""


def test_a_callback_that_spins_for_the_service_of_its_own_node_is_told_of_both_groups(tmp_path: Path) -> None:
    spins = "rclpy.spin_until_future_complete(node, client.call_async(Trigger.Request()))"
    timeline = run_program(tmp_path, ASKS_ITSELF.replace("ASK", spins), 2.0).timeline
    told = next(each.explained(timeline) for each in diagnose(timeline) if each.rule.id == "nested-spin")
    assert told.cure.endswith("use client.call(), and give ask and the client a callback group each")
    cured = ASKS_ITSELF.replace("ASK", "client.call(Trigger.Request())")
    for mine in ('"own")', "0.5, ask)"):
        assert mine in cured
        cured = cured.replace(mine, f"{mine[:-1]}, callback_group=Group())")
    assert [each.replied is not None for each in run_program(tmp_path, cured, 2.2).timeline.calls] == [
        True
    ] * 4


SPINS_IN_A_TASK = """
from functools import partial
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


class Caller(Node):
    def __init__(self):
        super().__init__("caller")
        self.create_service(Trigger, "own", lambda request, response: response)
        self.client = self.create_client(Trigger, "own")
        self.create_timer(0.5, self.ask)

    def ask(self):
        self.client.call_async(Trigger.Request()).add_done_callback(DONE)

    def answered(self, *_):
        NESTED


rclpy.init()
rclpy.spin(Caller())
"""
NESTED = "rclpy.spin_until_future_complete(self, self.client.call_async(Trigger.Request()))"


@pytest.mark.parametrize("done", ["self.answered", 'partial(self.answered, "more")'])
def test_a_done_callback_that_spins_what_runs_it_is_told_as_a_task_in_no_group(
    done: str, tmp_path: Path
) -> None:
    timeline = run_program(
        tmp_path, SPINS_IN_A_TASK.replace("DONE", done).replace("NESTED", NESTED), 2.0
    ).timeline
    (found,) = diagnose(timeline)
    told = found.explained(timeline)
    assert told.what == REFUSED.format("spin_until_future_complete").replace("tick", "answered")
    assert str(told.place) == "node.py:20"
    assert told.cure == (
        "after call_async() let answered return and go on in future.add_done_callback(), or await the future "
        "in an async def answered; to wait inside answered, use client.call(), and spin with "
        "MultiThreadedExecutor(num_threads=2)"
    )


@pytest.mark.parametrize(
    ("how", "asks", "spins"),
    [
        ("async def", "await self.client.call_async(Trigger.Request())", "rclpy.spin(Caller())"),
        ("def", "self.client.call(Trigger.Request())", "rclpy.spin(Caller(), MultiThreadedExecutor(2))"),
    ],
)
def test_what_is_told_of_such_a_done_callback_is_a_cure(
    how: str, asks: str, spins: str, tmp_path: Path
) -> None:
    cured = SPINS_IN_A_TASK.replace("DONE", "self.answered").replace("def answered", f"{how} answered")
    cured = cured.replace("NESTED", asks).replace("rclpy.spin(Caller())", spins)
    run = run_program(tmp_path, cured, 1.9)
    assert not diagnose(run.timeline)
    assert [each.replied is not None for each in run.timeline.calls] == [True] * 6
