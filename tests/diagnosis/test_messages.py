"""Messages that are lost, that are old when used, or that never come."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from msgspec.structs import replace

from sim.diagnosis import diagnose
from sim.ros.node.node import Node
from sim.ros.qos.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sim.ros.rclpy._entities.wait_for_message import wait_for_message
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.trace.events import EntityAppeared, Reason
from sim.trace.timeline import Timeline
from tests.diagnosis.findings import Diagnosed, Int32, diagnosed, once, spin
from tests.support.builder import Run, ns
from tests.support.simulation import Simulation

BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
RELIABLE = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def sensor_and_sleeper(
    depth: int, *, threads: int | None = None, own_group: bool = False, decide_each: float = 1.0
) -> Diagnosed:
    """``hear`` gets ten messages a second, ``decide`` sleeps from 3 to 6 s."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        simulation.publisher_at_rate("t", 0.1, offset=0.05)

        def hear(_: object) -> None: ...

        def decide() -> None:
            if 3.0 <= simulation.now < 3.1:
                simulation.sleep(3.0)

        group = MutuallyExclusiveCallbackGroup() if own_group else None
        node.create_subscription(Int32, "t", hear, depth, callback_group=group)
        node.create_timer(decide_each, decide)
        spin(node, threads)

    return diagnosed(program)


def test_what_a_held_group_loses_is_part_of_its_one_problem() -> None:
    run = sensor_and_sleeper(10)
    assert run.problems() == {("group-starvation", "hear")}
    first, *remarks = run.findings
    assert first.rule.id == "group-starvation"
    parts = {each.rule.id for each in remarks if each.due_to == first.culprit}
    assert parts == {"stale-data", "dropped-messages"}


def test_lost_messages_are_counted_with_what_their_callback_waited_for() -> None:
    run = sensor_and_sleeper(10)
    found = run.one("dropped-messages")
    assert found.count == run.trace.drops("hear") == 20
    told = run.explained("dropped-messages").what
    assert told == "hear lost 20 messages while it waited (group A held by decide): its queue holds 10"


def test_losses_are_dated_when_they_began_and_the_worst_second_is_told() -> None:
    run = sensor_and_sleeper(5)
    assert ns(3.4) < run.one("dropped-messages").at < ns(3.7)
    assert run.explained("dropped-messages").why.endswith("; most in the second from 4 s on, 10")


def test_messages_lost_during_several_calls_are_not_said_to_be_lost_in_one() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        simulation.publisher_at_rate("t", 0.1, offset=0.05)
        node.create_subscription(Int32, "t", lambda _: simulation.sleep(0.6), 10)
        spin(node, None)

    run = diagnosed(program)
    told = run.explained("dropped-messages").what
    assert "lost 73 messages while its calls ran; each took 600 ms, and its queue holds 10" in told
    early = diagnosed(program, until=7.0).explained("dropped-messages").what
    assert "while its calls ran; each took 600 ms" in early, "the call that is not over has no length yet"


def placed(run: Run) -> Timeline:
    """A run whose callbacks were all made in line 5."""
    timeline = Timeline()
    timeline.extend(
        [
            replace(each, made_at=("node.py", 5)) if isinstance(each, EntityAppeared) else each
            for each in run.events
        ]
    )
    return timeline


@pytest.mark.parametrize("seen", [True, False], ids=["waits seen", "waits missed by a busy machine"])
def test_a_loss_between_two_calls_does_not_hide_that_the_callback_is_too_slow(seen: bool) -> None:
    run = Run(clock="real")
    thread = run.thread("MainThread")
    run.executor("SingleThreadedExecutor", 1)
    hear = run.subscription(run.exclusive(run.node("n")), "t", "hear", depth=2)
    for place in range(8):
        at = 0.15 + place * 0.2
        run.callback(hear, thread, at + 0.001, 0.198)
        if seen:
            run.wait(hear, at + 0.01, at + 0.199, Reason.GROUP_HELD, hear)
        for after in (0.0, 0.05, 0.1, 0.15):
            run.message(hear, at + after)
    run.stop(1.75)
    timeline = placed(run)
    (told,) = (each.explained(timeline) for each in diagnose(timeline) if each.rule.id == "dropped-messages")
    assert ("while its calls ran" in told.what) is seen
    assert "so many at once" not in told.cure


def test_what_is_lost_while_nobody_spins_is_not_laid_to_the_callback() -> None:
    def program(simulation: Simulation) -> None:
        node, talker = Node("n"), Node("talker")
        node.create_subscription(Int32, "numbers", lambda message: None, 2)
        publisher = talker.create_publisher(Int32, "numbers", 2)
        talker.create_timer(0.5, lambda: publisher.publish(Int32()))
        spin(talker, None)

    told = diagnosed(program).explained("dropped-messages")
    assert "while it waited (nobody spins)" in told.what
    assert told.cure == "keep spinning its node; a longer queue only delays it"


def test_a_queue_that_is_long_enough_loses_nothing() -> None:
    assert "dropped-messages" not in {rule for rule, _ in sensor_and_sleeper(100).told()}


@pytest.mark.parametrize("apart", [0.0, 0.00001])
def test_a_burst_is_what_comes_before_the_callback_runs_again(apart: float) -> None:
    run = Run()
    thread = run.thread("MainThread")
    heard = run.subscription(run.exclusive(run.node("/n")), "/t", "hear", depth=10)
    for number in range(200):
        run.message(heard, 0.1 + apart * number)
    for number in range(10):
        run.callback(heard, thread, 0.2 + number / 100, 0.001)
    run.stop(1.0)
    [found] = diagnose(timeline := placed(run))
    assert "a queue of 200: its messages come so many at once" in found.explained(timeline).cure


def test_a_queue_of_one_is_meant_to_keep_the_newest() -> None:
    run = sensor_and_sleeper(1)
    assert ("dropped-messages", "hear") in run.told() - run.problems()


@pytest.mark.parametrize(
    ("work", "group", "cure", "is_problem"),
    [
        (0.5, 0.0, "let /t return sooner, or publish less often", False),
        (0.0, 0.28, "give /t a callback group of its own", True),
    ],
)
def test_a_queue_of_one_that_loses_three_quarters_to_others_is_a_problem(
    work: float, group: float, cure: str, *, is_problem: bool
) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        simulation.publisher_at_rate("t", 0.02)
        node.create_subscription(Int32, "t", lambda _: simulation.sleep(work), 1)
        node.create_timer(0.3, lambda: simulation.sleep(group))
        spin(node, 2)

    run = diagnosed(program)
    told = run.explained("dropped-messages")
    assert ("dropped-messages" in {rule for rule, _ in run.problems()}) == is_problem
    assert told.cure.startswith(cure)
    assert bool(re.search(r"lost \d+ of \d+ messages", told.what)) == is_problem


def test_a_timer_that_runs_before_the_waiting_messages_decides_on_old_data() -> None:
    run = sensor_and_sleeper(10)
    found = run.one("stale-data")
    assert (found.at, found.count, found.culprit) == (ns(6.0), 1, run.trace.entity("hear"))
    assert found.size == ns(2.95)
    assert "newer messages had waited 3.0 s for" in run.explained("stale-data").what


def test_a_sensor_with_a_thread_and_a_group_of_its_own_is_well() -> None:
    assert sensor_and_sleeper(10, threads=2, own_group=True).problems() == set()


def test_data_that_nobody_has_ever_seen_is_not_old() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_subscription(Int32, "t", lambda _: None, 10)
        publisher = node.create_publisher(Int32, "t", 10)

        def publish_and_sleep() -> None:
            publisher.publish(Int32())
            simulation.sleep(2.0)

        once(node, 1.0, publish_and_sleep)
        once(node, 1.5, lambda: None)
        spin(node, None)

    assert "stale-data" not in {rule for rule, _ in diagnosed(program).told()}


def test_data_of_another_node_does_not_matter() -> None:
    def program(simulation: Simulation) -> None:
        simulation.publisher_at_rate("t", 0.1)
        hearing, deciding = Node("hearing"), Node("deciding")

        def hear(_: object) -> None:
            simulation.sleep(1.0)

        hearing.create_subscription(Int32, "t", hear, 100)
        deciding.create_timer(0.5, lambda: None)
        simulation.start(lambda: spin(hearing, None))
        spin(deciding, None)

    assert "stale-data" not in {rule for rule, _ in diagnosed(program).told()}


def publisher_and_subscription(offered: QoSProfile, requested: QoSProfile) -> Diagnosed:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_subscription(Int32, "t", hear, requested)
        publisher = node.create_publisher(Int32, "t", offered)
        node.create_timer(1.0, lambda: publisher.publish(Int32()))
        spin(node, None)

    def hear(_: object) -> None: ...

    return diagnosed(program)


@pytest.mark.parametrize(
    ("offered", "requested", "policy"),
    [(BEST_EFFORT, RELIABLE, "RELIABILITY"), (RELIABLE, LATCHED, "DURABILITY")],
)
def test_a_subscription_that_asks_for_more_than_is_offered_is_told(
    offered: QoSProfile, requested: QoSProfile, policy: str
) -> None:
    run = publisher_and_subscription(offered, requested)
    assert run.told() == {("qos-mismatch", "hear")}
    told = run.explained("qos-mismatch")
    assert told.what == f"{policy} does not match; hear hears nothing from a publisher of /t"
    ends = re.search(r"the publisher of (.*):(\d+) and the subscription of (.*):(\d+)$", told.cure)
    assert ends is not None
    assert ends[1] == ends[3] == Path(__file__).name
    lines = Path(__file__).read_text().splitlines()
    assert "create_publisher" in lines[int(ends[2]) - 1]
    assert "create_subscription" in lines[int(ends[4]) - 1]
    assert str(told.place) == f"{ends[3]}:{ends[4]}"


def test_all_policies_of_a_file_that_do_not_match_are_named() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(
            Int32, "t", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        )
        wanted = QoSProfile(
            depth=1,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
        )
        node.create_subscription(Int32, "t", lambda _: None, wanted)
        node.create_timer(1.0, lambda: publisher.publish(Int32()))
        spin(node, None)

    told = diagnosed(program).explained("qos-mismatch")
    assert told.what.startswith("DURABILITY and RELIABILITY do not match; ")


def test_a_subscription_that_waits_for_a_message_is_one_of_the_program() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_publisher(Int32, "t", BEST_EFFORT)
        wait_for_message(Int32, node, "t", qos_profile=RELIABLE, time_to_wait=0.1)

    told = diagnosed(program).explained("qos-mismatch")
    assert "; a subscription of the program hears nothing from a publisher of /t" in told.what
    assert told.cure.count(Path(__file__).name) == 2


@pytest.mark.parametrize(
    ("offered", "requested"), [(RELIABLE, BEST_EFFORT), (LATCHED, RELIABLE), (RELIABLE, RELIABLE)]
)
def test_a_subscription_that_asks_for_what_is_offered_is_well(
    offered: QoSProfile, requested: QoSProfile
) -> None:
    assert publisher_and_subscription(offered, requested).told() == set()


def test_a_publisher_of_another_program_that_does_not_match_is_told() -> None:
    def program(simulation: Simulation) -> None:
        outside = simulation.outside_node()
        outside.create_publisher(Int32, "t", BEST_EFFORT)
        node = Node("n")

        def hear(_: object) -> None: ...

        node.create_subscription(Int32, "t", hear, RELIABLE)
        spin(node, None)

    assert diagnosed(program).told() == {("qos-mismatch", "hear")}


def test_where_others_are_heard_a_publisher_of_another_program_that_does_not_match_is_a_remark() -> None:
    def program(simulation: Simulation) -> None:
        simulation.outside_node().create_publisher(Int32, "t", BEST_EFFORT)
        simulation.publisher_at_rate("t", 0.5)
        node = Node("n")

        def hear(_: object) -> None: ...

        node.create_subscription(Int32, "t", hear, RELIABLE)
        spin(node, None)

    run = diagnosed(program)
    assert run.told() == {("qos-mismatch", "hear")}
    assert run.problems() == set()


def test_of_two_publishers_that_do_not_match_the_one_in_the_program_is_told_with_both_lines() -> None:
    def program(simulation: Simulation) -> None:
        simulation.outside_node().create_publisher(Int32, "t", BEST_EFFORT)
        node = Node("n")
        node.create_publisher(Int32, "t", BEST_EFFORT)

        def hear(_: object) -> None: ...

        node.create_subscription(Int32, "t", hear, RELIABLE)
        spin(node, None)

    told = diagnosed(program).explained("qos-mismatch")
    assert "outside" not in told.what
    assert told.cure.count(Path(__file__).name) == 2


def test_a_subscription_of_another_program_that_does_not_match_is_told() -> None:
    def program(simulation: Simulation) -> None:
        outside = simulation.outside_node()
        outside.create_subscription(Int32, "t", lambda _: None, RELIABLE)
        node = Node("n")
        node.create_publisher(Int32, "t", BEST_EFFORT)
        spin(node, None)

    run = diagnosed(program)
    assert run.told() == {("qos-mismatch", "")}
    told = run.explained("qos-mismatch")
    assert "; a subscription outside the program hears nothing" in told.what
    assert told.cure.startswith(f"let the publisher of {Path(__file__).name}:")
    assert told.cure.endswith("offer ReliabilityPolicy.RELIABLE: the subscription is outside the program")


@pytest.mark.parametrize(
    ("offered", "requested", "change"),
    [
        (BEST_EFFORT, RELIABLE, "request ReliabilityPolicy.BEST_EFFORT"),
        (RELIABLE, LATCHED, "request DurabilityPolicy.VOLATILE"),
    ],
)
def test_only_the_programs_own_end_of_a_topic_is_to_be_changed(
    offered: QoSProfile, requested: QoSProfile, change: str
) -> None:
    def program(simulation: Simulation) -> None:
        simulation.outside_node().create_publisher(Int32, "t", offered)
        node = Node("n")
        node.create_subscription(Int32, "t", lambda _: None, requested)
        spin(node, None)

    told = diagnosed(program).explained("qos-mismatch")
    assert told.cure.startswith(f"let the subscription of {Path(__file__).name}:")
    assert told.cure.endswith(f"{change}: the publisher is outside the program")


def early(
    offered: QoSProfile | int = 10, requested: QoSProfile | int = 10, *, number: int = 1, until: float = 2.0
) -> Diagnosed:
    """Messages that are published before, or for a negative number after, a subscription is made."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(Int32, "t", offered)
        for _ in range(number):
            publisher.publish(Int32())

        def hear(_: object) -> None: ...

        node.create_subscription(Int32, "t", hear, requested)
        for _ in range(-number):
            publisher.publish(Int32())
        once(node, 1.5, lambda: None)
        spin(node, None)

    return diagnosed(program, until)


def test_what_is_published_before_anybody_listens_is_told_at_the_subscription() -> None:
    run = early(number=3)
    assert run.problems() == {("sent-too-early", "hear")}
    told = run.explained("sent-too-early")
    assert told.what == (
        "hear hears nothing: all 3 messages of /t were published before the publisher knew of the "
        "subscription"
    )
    assert told.place is not None
    line = Path(told.place.file).read_text().splitlines()[told.place.first_line - 1]
    assert "create_subscription" in line


@pytest.mark.parametrize(
    "run",
    [lambda: early(LATCHED, LATCHED), lambda: early(number=-1), lambda: early(until=0.9)],
    ids=["kept for it", "published later", "may be published again"],
)
def test_what_is_heard_or_may_be_is_not_told_to_be_too_early(run: Callable[[], Diagnosed]) -> None:
    assert run().told() == set()


def test_what_a_timer_publishes_comes_again() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(Int32, "t", 10)
        node.create_timer(2.0, lambda: publisher.publish(Int32()))
        once(node, 2.5, lambda: node.create_subscription(Int32, "t", lambda _: None, 10))
        spin(node, None)

    assert "sent-too-early" not in {rule for rule, _ in diagnosed(program, 3.9).told()}


def test_old_data_is_laid_to_what_kept_the_messages_until_then() -> None:
    def program(simulation: Simulation) -> None:
        simulation.publisher_at_rate("t", 0.1, offset=0.05)
        node = Node("n")

        def hear(_: object) -> None: ...

        def early() -> None:
            simulation.sleep(1.0)

        def late() -> None:
            simulation.sleep(5.0)

        once(node, 1.0, early)
        once(node, 1.5, late)
        node.create_subscription(Int32, "t", hear, 10)
        spin(node, None)

    run = diagnosed(program)
    assert run.one("stale-data").subject == run.trace.entity("late")
    assert run.one("stale-data").due_to == run.trace.entity("early")
