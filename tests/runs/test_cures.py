"""A cure is offered only if the run with it has the problem no more; tried on beginners' programs."""

from dataclasses import replace
from pathlib import Path
from threading import Event

import msgspec
import pytest

from cbtui.engines.follow import GivenUpError
from cbtui.runs.judged import cures as judged_cures
from cbtui.runs.judged.cures import (
    TriedRun,
    cures_of,
    judged,
    problem_of,
    try_run,
    with_inputs,
)
from cbtui.runs.setup.changes import Changes
from sim.diagnosis import Finding, diagnose
from sim.diagnosis.edits.profiles import match_quality
from sim.diagnosis.rule import CodeLocation, by_edit
from sim.engine.commands import CallService, input_text
from sim.engine.setup import RunSetup, TimedInput
from sim.trace.timeline import Timeline
from tests.support.engine_runs import SECOND, program_setup, run_to_end

PROGRAMS = Path(__file__).parents[1] / "diagnosis" / "beginners"


UNTIL = 3 * SECOND


def run_of(program: str, folder: Path = PROGRAMS) -> tuple[RunSetup, Timeline]:
    setup = program_setup(folder / f"{program}.py", 3.0)
    return setup, run_to_end(setup).timeline


def tried(program: str, folder: Path = PROGRAMS) -> tuple[RunSetup, Timeline, TriedRun]:
    """One run of a program as a cure is held against it, with its timeline."""
    setup, timelines = program_setup(folder / f"{program}.py", 3.0), list[Timeline]()

    def noted(timeline: Timeline) -> tuple[Finding, ...]:
        timelines.append(timeline)
        return diagnose(timeline)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(judged_cures, "diagnose", noted)
        before = try_run(setup, UNTIL, Event())
    return setup, timelines[0], before


def helpful(program: str, folder: Path = PROGRAMS) -> list[str]:
    setup, timeline, before = tried(program, folder)
    found = diagnose(timeline)[0]
    problem, told = problem_of(found, timeline), found.explained(timeline)
    cures = list(cures_of(told, Changes(), timeline))
    runs = ((cure, try_run(cure.changes.applied(setup), UNTIL, Event())) for cure in cures)
    return [
        f"{cure.words}{cure.diff and ' (diff)'}"
        for cure, after in runs
        if judged(problem, before, after, again=cure.again).helps
    ]


APART = "give tick a callback group of its own, and spin with MultiThreadedExecutor(num_threads=2)"
DONE = "go on in a done-callback of the future (diff)"
AWAIT = "await the reply in an async def {0}, and give {0} a callback group of its own (diff)"
LATER = "return from tick, and look again at its next call (diff)"
ASLEEP = f"sleep in the loop, and {APART} (diff)"
STEP = "do one step of the loop at each call of {} (diff)"
EARLY = "take both locks at once, in the order of {}, one of them as a threading.RLock (diff)"
ONE = "make both locks one, a threading.RLock (diff)"
FIT = "define it with the parameters it is called with (diff)"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("program", "cures"),
    [
        ("nested_spin", [DONE, AWAIT.format("tick")]),
        ("spin_in_function", [AWAIT.format("tick")]),
        ("spin_in_method", [AWAIT.format("plan")]),
        ("two_spins", ["spin all nodes by one executor (diff)"]),
        ("two_spins_of_new_nodes", ["spin all nodes by one executor (diff)"]),
        ("two_executors", ["spin all nodes by one executor (diff)"]),
        ("sim_time_without_clock", ["leave use_sim_time false (diff)"]),
        ("equal_stamps_only", ["take an ApproximateTimeSynchronizer with slop=0.01 (diff)"]),
        ("time_of_before", ["set done_at back with the clock (diff)"]),
        ("published_at_once", ["keep the last messages for it (diff)"]),
        ("period_of_zero", ["keep the fraction of the period (diff)"]),
        ("lookup_in_timer", [APART.replace("tick", "look"), "ask for the newest transform there is (diff)"]),
        ("spin_past_executor", ["call ex.spin() in its place (diff)"]),
        ("call_longer_than_period", [DONE]),
        ("event_of_its_group", ["give on_bell a callback group of its own"]),
        ("int_for_float", ["write a float (diff)"]),
        ("misspelt_service", ["call /motor_power (diff)"]),
        ("publishes_in_loop", ["spin the node in a thread beside the loop (diff)"]),
        ("rate_in_main", ["spin the node in a thread beside the loop (diff)"]),
        ("spin_once", ["return from go, and go on where what it waits for is set (diff)"]),
        ("type_mismatch", ["take the type that is published (diff)"]),
        ("spin_with_timeout", [DONE, AWAIT.format("tick")]),
        ("event_never_set", ["wait for 0.1 s at most (diff)"]),
        ("barrier_of_more", ["make it a Barrier(1) (diff)"]),
        (
            "never_awaited",
            [f"put await before is_well(), in an async def tick, and {APART.partition(', and')[0]} (diff)"],
        ),
        ("wait_for_event", [APART.replace("tick", "go")]),
        ("semaphore_in_reentrant_group", ["give take a callback group of its own"]),
        ("job_waits_for_job", []),
        ("call_in_timer", [APART, DONE, AWAIT.format("tick")]),
        (
            "call_in_subscription",
            [
                "give on_order a callback group of its own",
                DONE,
                AWAIT.format("on_order"),
            ],
        ),
        ("call_in_script", [APART.replace("tick", "ask"), AWAIT.format("ask")]),
        (
            "calls_of_two_peers",
            [
                APART.replace("tick", "tick (/left)").replace("=2", "=3"),
                DONE,
                AWAIT.format("tick (/left)"),
            ],
        ),
        (
            "calls_back_and_forth",
            [
                "give begin a callback group of its own, and give on_ask a callback group of its own, and "
                "spin with MultiThreadedExecutor(num_threads=3)",
                f"{DONE[:-7]}, and give on_ask a callback group of its own (diff)",
                f"{AWAIT.format('begin')[:-7]}, and give on_ask a callback group of its own (diff)",
            ],
        ),
        ("call_in_service", [APART.replace("tick", "cook"), AWAIT.format("cook")]),
        ("spin_in_service", [AWAIT.format("cook")]),
        ("wait_for_future", [APART, DONE, AWAIT.format("tick")]),
        ("busy_wait_for_future", [DONE, AWAIT.format("tick")]),
        ("join_in_timer", [APART]),
        ("result_of_job", [APART]),
        ("while_true", [LATER, ASLEEP]),
        ("busy_wait_in_service", ["sleep in the loop, and give close a callback group of its own (diff)"]),
        ("while_sleeping", [STEP.format("wander")]),
        ("loop_with_break", [STEP.format("drive")]),
        ("loop_in_subscription", []),
        ("qos_mismatch", ["request no more than is offered (diff)"]),
        ("qos_mismatch_of_two", ["offer what is requested (diff)"]),
        ("late_map", ["offer what is requested (diff)"]),
        ("function_called", ["hand over the function itself (diff)"]),
        ("rate_sleep", ["do one round of the loop at each call of tick (diff)", APART]),
        ("wrong_arity", [FIT]),
        ("wrong_arity_of_timer", [FIT]),
        ("wrong_arity_of_done_callback", [FIT]),
        ("hides_a_name", ["give it another name (diff)"]),
        ("wait_for_service", [LATER]),
        ("service_created_later", [APART.replace("tick", "pick")]),
        ("wait_in_service", ["return the response from grip at once if the service is not there (diff)"]),
        (
            "lock_across_callbacks",
            ["take both locks at once, in the order of look (diff)", ONE],
        ),
        ("lock_during_call", ["let go of the lock during the call (diff)"]),
        ("lock_during_reentrant_call", ["let go of the lock during the call (diff)"]),
        ("lock_taken_twice", ["make the lock a threading.RLock (diff)"]),
        ("lock_by_decorator", ["make the lock a threading.RLock (diff)"]),
        ("locks_by_acquire", ["take both locks in the order of earn (diff)", ONE]),
        ("locks_by_try", ["take both locks by one with, in the order of spend (diff)", ONE]),
        ("locks_in_methods", [EARLY.format("sell"), ONE]),
        ("locks_in_helpers", [EARLY.format("report"), ONE]),
        ("lock_not_released", ["take the lock by with, which releases it whatever happens (diff)"]),
        ("lock_left_by_another", ["take the lock by with, which releases it whatever happens (diff)"]),
        ("lock_across_await", ["let go of the lock during the call (diff)"]),
        (
            "lock_across_await_in_one_group",
            ["let go of the lock during the call, and give ask a callback group of its own (diff)"],
        ),
        ("lock_acquired_twice", ["make the lock a threading.RLock (diff)"]),
        ("sensor_misspelt", ["subscribe to /scan (diff)"]),
        ("goal_awaited_in_one_group", ["give send a callback group of its own"]),
        ("messages_in_bursts", ["give count a queue of 5 (diff)"]),
        ("call_in_parameter_callback", [APART.replace("tick", "tune")]),
        ("no_response", ["end answer with: return response (diff)"]),
        ("held_group", ["give on_chatter a callback group of its own"]),
        (
            "two_timers_too_much",
            ["give right a callback group of its own, and spin with MultiThreadedExecutor(num_threads=2)"],
        ),
        ("sleep_in_service", [APART.replace("tick", "gripper")]),
    ],
)
def test_the_cures_that_are_offered_end_the_problem(program: str, cures: list[str]) -> None:
    assert helpful(program) == cures


@pytest.mark.slow
def test_where_a_lock_and_a_group_are_in_the_way_of_a_reply_only_a_cure_of_both_helps(tmp_path: Path) -> None:
    text = (PROGRAMS / "lock_during_call.py").read_text()
    text = text.replace("callback_group=MutuallyExclusiveCallbackGroup()", "callback_group=None")
    (tmp_path / "camera.py").write_text(text.replace("callback_group=taking", "callback_group=None"))
    assert helpful("camera", tmp_path) == [
        "let go of the lock during the call, and give take_picture a callback group of its own (diff)"
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("program", "old", "new", "cure"),
    [
        (
            "lock_during_call",
            "        with self.lock:\n            self.storage.call(Trigger.Request())\n",
            "        self.lock.acquire()\n        self.storage.call(Trigger.Request())\n"
            "        self.lock.release()\n",
            "let go of the lock during the call (diff)",
        ),
        (
            "wait_for_service",
            "        self.client.wait_for_service()\n",
            "        if self.client:\n            self.client.wait_for_service()\n",
            LATER,
        ),
    ],
)
def test_other_ways_to_write_the_same_have_the_same_cure(
    program: str, old: str, new: str, cure: str, tmp_path: Path
) -> None:
    text = (PROGRAMS / f"{program}.py").read_text()
    assert old in text
    (tmp_path / "node.py").write_text(text.replace(old, new, 1))
    assert helpful("node", tmp_path) == [cure]


def test_a_deadlock_is_the_same_whoever_of_two_was_the_last_to_wait() -> None:
    _, timeline = run_of("lock_across_callbacks")
    found = diagnose(timeline)[0]
    turned = replace(found, subject=found.culprit, culprit=found.subject)
    assert problem_of(turned, timeline) == problem_of(found, timeline)


TAKES_JOBS = """\
import queue
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

rclpy.init()
node, jobs = Node("n"), queue.Queue()

def work():
    while jobs.get():
        pass

node.create_timer(0.5, lambda: None)
node.create_timer(1.0, work)
executor = MultiThreadedExecutor(3)
executor.add_node(node)
executor.spin()
"""


def test_a_wait_in_a_loop_is_one_problem_however_long_it_has_lasted(tmp_path: Path) -> None:
    found = []
    (tmp_path / "node.py").write_text(TAKES_JOBS)
    for seconds in (3.0, 6.0):
        timeline = run_to_end(program_setup(tmp_path / "node.py", seconds)).timeline
        found += [(each.rule.id, problem_of(each, timeline)) for each in diagnose(timeline)[:1]]
    (early, one), (late, other) = found
    assert (early, late) == ("stays-in-loop", "endless-wait")
    assert one == other


def test_an_edited_copy_is_run_and_the_file_stays() -> None:
    before = (PROGRAMS / "qos_mismatch.py").read_text()
    assert helpful("qos_mismatch") == ["request no more than is offered (diff)"]
    assert (PROGRAMS / "qos_mismatch.py").read_text() == before


def test_threads_alone_do_not_open_a_held_group() -> None:
    setup, timeline, before = tried("held_group")
    problem = problem_of(diagnose(timeline)[0], timeline)
    after = try_run(Changes(threads=6).applied(setup), UNTIL, Event())
    assert not judged(problem, before, after).helps


def test_a_second_cure_edits_what_the_first_made() -> None:
    setup, timeline = run_of("qos_mismatch")
    found = diagnose(timeline)[0]
    told, path = found.explained(timeline), setup.programs[0].path
    text = f"# a note\n{Path(path).read_text()}"
    line = CodeLocation(path, told.place.first_line + 1, told.place.first_line + 1) if told.place else None
    remedies = by_edit(line, "again", match_quality, found.detail)
    (cure,) = cures_of(replace(told, remedies=remedies), Changes(texts={path: text}), timeline)
    assert cure.changes.texts[path].startswith("# a note\n")


@pytest.mark.slow
def test_a_cure_may_be_in_a_module_that_the_program_imports(tmp_path: Path) -> None:
    module = tmp_path / "arm" / "robot.py"
    module.parent.mkdir()
    (module.parent / "__init__.py").touch()
    text = (PROGRAMS / "call_in_timer.py").read_text()
    module.write_text(text)
    (tmp_path / "start.py").write_text("from arm.robot import main\n\nmain()\n")
    assert helpful("start", tmp_path) == [APART, DONE, AWAIT.format("tick")]
    assert module.read_text() == text


def test_a_trial_can_be_given_up() -> None:
    given_up = Event()
    given_up.set()
    setup = program_setup(PROGRAMS / "held_group.py", 3.0)
    with pytest.raises(GivenUpError):
        try_run(setup, 3 * SECOND, given_up)


def test_a_trial_tells_how_far_it_is() -> None:
    told: list[int] = []
    try_run(program_setup(PROGRAMS / "held_group.py", 3.0), 3 * SECOND, Event(), told.append)
    assert told == sorted(told)
    assert told[-1] == 3 * SECOND


@pytest.mark.slow
def test_a_loop_without_a_wait_is_recognised_in_a_trial_of_a_run_on_the_real_clock(tmp_path: Path) -> None:
    text = (PROGRAMS / "while_sleeping.py").read_text().replace("            time.sleep(0.1)\n", "")
    program = tmp_path / "wanderer.py"
    program.write_text(text)
    setup = program_setup(program, 4.0)
    timeline = run_to_end(msgspec.structs.replace(setup, clock="real", speed=1.0)).timeline
    found = diagnose(timeline)[0]
    assert found.rule.id == "stays-in-loop"
    problem, before = problem_of(found, timeline), try_run(setup, UNTIL, Event())
    cures = list(cures_of(found.explained(timeline), Changes(), timeline))
    after = {
        cure.words: judged(problem, before, try_run(cure.changes.applied(setup), UNTIL, Event()))
        for cure in cures
    }
    assert [words for words, verdict in after.items() if verdict.helps] == [
        "do one step of the loop at each call of wander"
    ]
    assert "stands still while the loop computes" in judged(problem, before, before).reason


def test_a_trial_tells_which_rules_found_effects_alone() -> None:
    before = try_run(program_setup(PROGRAMS / "held_group.py", 3.0), UNTIL, Event())
    assert {rule for rule, *_ in before.problems} == {"group-starvation"}
    assert {rule for rule, _ in before.effects} <= {"dropped-messages", "stale-data", "overrun-timer"}


def test_the_calls_of_a_run_belong_to_its_trial(tmp_path: Path) -> None:
    text = (PROGRAMS / "sleep_in_service.py").read_text().replace("self.create_timer(2.0, self.close)", "")
    program = tmp_path / "served.py"
    program.write_text(text)
    setup = program_setup(program, 3.0)
    assert try_run(setup, 3 * SECOND, Event()).problems == {}
    called = TimedInput(SECOND // 2, input_text(CallService(None, True)))
    found = try_run(with_inputs(setup, (called,)), 3 * SECOND, Event())
    assert [rule for rule, _, _ in found.problems] == ["group-starvation"]


def test_a_call_of_a_run_before_is_made_on_the_real_clock_too(tmp_path: Path) -> None:
    called = TimedInput(SECOND // 10, input_text(CallService("/gripper", True)))
    setup = with_inputs(program_setup(PROGRAMS / "sleep_in_service.py", 1.0), (called,))
    timeline = run_to_end(msgspec.structs.replace(setup, clock="real", speed=1.0)).timeline
    assert [call.service for call in timeline.calls if call.caller == 0] == ["/gripper"]


def test_what_a_queue_of_one_loses_on_purpose_is_no_problem_in_the_place_of_old_messages(
    tmp_path: Path,
) -> None:
    (tmp_path / "node.py").write_text(FALLS_BEHIND)
    setup = program_setup(tmp_path / "node.py", 10.0)
    timeline = run_to_end(setup).timeline
    found = diagnose(timeline)[0]
    (cure,) = cures_of(found.explained(timeline), Changes(), timeline)
    assert (found.rule.id, cure.words) == ("falls-behind", "give hear a queue of 1")
    before, after = (try_run(each, 10 * SECOND, Event()) for each in (setup, cure.changes.applied(setup)))
    assert judged(problem_of(found, timeline), before, after).helps


FALLS_BEHIND = """
import time
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

class Slow(Node):
    def __init__(self):
        super().__init__("slow")
        self.create_subscription(String, "news", self.hear, 1000)

    def hear(self, msg):
        time.sleep(0.3)

def main():
    rclpy.init()
    teller, executor = Node("teller"), MultiThreadedExecutor()
    publisher = teller.create_publisher(String, "news", 10)
    teller.create_timer(0.05, lambda: publisher.publish(String()))
    executor.add_node(Slow())
    executor.add_node(teller)
    executor.spin()

main()
"""
