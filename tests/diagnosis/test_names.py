"""Topics and services whose two ends do not meet, as their names or their types differ."""

from collections.abc import Callable
from pathlib import Path

import pytest

from sim.diagnosis.rules.names import is_slip, nearest
from sim.interfaces import message, service
from sim.ros.node.node import Node
from sim.trace.descriptions import silent_topics
from sim.trace.events import ArenaShown
from sim.trace.figures.summary import summarise
from sim.trace.figures.summary_text import plain_text
from tests.diagnosis.findings import Diagnosed, Int32, SetBool, diagnosed, spin
from tests.support.simulation import Simulation, Trace

Bool = message("std_msgs", "Bool")
Trigger = service("std_srvs", "Trigger")


def talk(published: str, heard: str, until: float = 3.0) -> Diagnosed:
    """A timer that publishes, and a subscription."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(Int32, published, 10)

        def tick() -> None:
            publisher.publish(Int32(data=1))

        def hear(_: object) -> None: ...

        node.create_timer(0.5, tick)
        node.create_subscription(Int32, heard, hear, 10)
        spin(node, None)

    return diagnosed(program, until)


def drive(published: str, also: str = "odom") -> Diagnosed:
    """A timer that publishes on two topics, in a run with a robot."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        publishers = [node.create_publisher(Int32, name, 10) for name in (published, also)]

        def tick() -> None:
            for publisher in publishers:
                publisher.publish(Int32(data=1))

        node.create_timer(0.5, tick)
        spin(node, None)

    trace = diagnosed(program, 3.0).trace
    return Diagnosed(Trace([ArenaShown(0, (), (0.9, 0.0, 0.2), 0.1), *trace.events]))


def ask(offered: tuple[type, str], called: tuple[type, str]) -> Diagnosed:
    """A service, and a timer that calls one."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_service(*offered, lambda _, response: response)
        client = node.create_client(*called)
        request = called[0].Request  # type: ignore[attr-defined]

        def tick() -> None:
            client.call_async(request())

        node.create_timer(1.0, tick)
        spin(node, None)

    return diagnosed(program, 1.5)


def line_with(text: str) -> int:
    lines = Path(__file__).read_text().splitlines()
    return next(number for number, line in enumerate(lines, 1) if text in line)


def test_a_subscription_on_a_misspelt_topic_is_told_of_at_the_line_that_makes_it() -> None:
    run = talk("chatter", "chattr")
    assert run.problems() == {("misspelt-topic", "hear")}
    told = run.explained("misspelt-topic")
    assert told.what == (
        "hear hears nothing: nobody publishes on /chattr, "
        "and nobody hears /chatter, which is published by tick"
    )
    assert "subscribe to /chatter, or publish on /chattr" in told.cure
    assert told.place is not None
    assert told.place.first_line == line_with("create_subscription(Int32, heard")


def test_it_is_told_within_half_a_second_of_the_first_message() -> None:
    assert talk("chatter", "chattr", 0.9).told() == set()
    assert talk("chatter", "chattr", 1.1).problems() == {("misspelt-topic", "hear")}


def test_topics_of_different_names_and_one_that_is_heard_are_well() -> None:
    assert talk("speed", "scan").told() == set()
    assert talk("chatter", "chatter").told() == set()


def test_topics_on_which_nothing_came_are_known_also_beside_a_finding() -> None:
    assert silent_topics(talk("speed", "scan").timeline) == ("/scan",)
    assert silent_topics(talk("chatter", "chattr").timeline) == ("/chattr",)
    assert silent_topics(talk("chatter", "chatter").timeline) == ()
    summary = plain_text(summarise(talk("speed", "scan").timeline))
    assert "topics   nothing has come on /scan\n" in summary


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("/chattr", "/chatter"),
        ("/Scan", "/scan"),
        ("/scan", "/robot/scan"),
        ("/laser_scan", "/scan"),
        ("/cmd_vell", "/cmd_vel"),
        ("/left", ""),
        ("/imu", ""),
    ],
)
def test_names_are_alike_but_for_a_letter_their_case_or_their_namespace(name: str, near: str) -> None:
    assert nearest(name, ["/chatter", "/scan" if near == "/scan" else "/robot/scan", "/cmd_vel"]) == near


def test_a_slip_in_a_topic_that_another_node_hears_is_told_with_the_name_that_is_meant() -> None:
    def program(also: str, kind: type) -> Callable[[Simulation], None]:
        def run(_: Simulation) -> None:
            node = Node("n")
            publisher = node.create_publisher(Int32, "chatter", 10)

            def chat() -> None:
                publisher.publish(Int32(data=1))

            node.create_timer(0.5, chat)
            node.create_subscription(Int32, "chatter", lambda _: None, 10)
            node.create_subscription(kind, also, lambda _: None, 10)
            spin(node, None)

        return run

    run = diagnosed(program("chattr", Int32), 2.0)
    told = run.explained("misspelt-topic")
    assert told.what.endswith(
        "nobody publishes on /chattr; did you mean /chatter, which is published by chat?"
    )
    assert told.cure == "if one topic is meant, give it one name: subscribe to /chatter"
    assert len(told.remedies) == 1
    assert diagnosed(program("chattr", Bool), 2.0).told() == set()
    assert diagnosed(program("chatter2", Int32), 2.0).told() == set()


@pytest.mark.parametrize(
    ("name", "other", "slip"),
    [
        ("/chatter", "/chattr", True),
        ("/odom", "/odmo", True),
        ("/cmd_vel", "/cnd_vel", True),
        ("/joint_state", "/joint_states", True),
        ("/Scan", "/scan", True),
        ("/robot/scan", "/robot/scann", False),
        ("/scan", "/scan2", False),
        ("/scan1", "/scan2", False),
        ("/wheel_l", "/wheel_r", False),
        ("/arm_fl_goal", "/arm_fr_goal", False),
        ("/left/image", "/right/image", False),
        ("/image", "/image_raw", False),
        ("/scan", "/rscan", False),
        ("/map", "/mop", False),
        ("/front", "/floor", False),
    ],
)
def test_a_slip_is_a_letter_in_a_word_and_not_what_tells_two_sensors_apart(
    name: str, other: str, slip: bool
) -> None:
    assert is_slip(name, other) is is_slip(other, name) is slip
    assert not is_slip(name, name)


def test_a_topic_with_two_types_is_told_with_both_lines() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_publisher(Int32, "speed", 10)
        node.create_subscription(Bool, "speed", lambda _: None, 10)
        spin(node, None)

    run = diagnosed(program, 1.0)
    told = run.explained("qos-mismatch")
    assert told.what.startswith("message types differ; ")
    assert told.what.endswith("hears nothing from a publisher of /speed")
    ends = line_with('create_publisher(Int32, "speed"'), line_with('create_subscription(Bool, "speed"')
    assert told.cure == (
        "give both ends of /speed the same message type: "
        "the publisher of test_names.py:{} and the subscription of test_names.py:{}".format(*ends)
    )


def test_a_service_of_another_type_is_named_with_both_types_and_lines() -> None:
    run = ask((SetBool, "lamp"), (Trigger, "lamp"))
    told = run.explained("nobody-offers")
    assert told.what.startswith(
        "tick called /lamp as std_srvs/srv/Trigger, but it is offered as std_srvs/srv/SetBool"
    )
    ends = line_with("create_client(*called"), line_with("create_service(*offered")
    assert "client of test_names.py:{} and the service of test_names.py:{}".format(*ends) in told.cure
    assert told.place is not None
    assert told.place.first_line == ends[0]


def test_a_misspelt_service_is_told_with_the_one_that_is_offered() -> None:
    told = ask((SetBool, "lamp"), (SetBool, "lampe")).explained("nobody-offers")
    assert told.cure.startswith("call /lamp, which is offered (test_names.py:")
    assert len(told.remedies) == 1


def test_a_service_that_nothing_resembles_is_to_be_started() -> None:
    told = ask((SetBool, "lamp"), (SetBool, "door")).explained("nobody-offers")
    assert "start the node that offers it" in told.cure
    assert told.remedies == ()


def test_a_misspelt_topic_of_the_robot_is_told_at_the_callback_that_publishes() -> None:
    run = drive("cmd_vell")
    assert run.problems() == {("misspelt-topic", "")}
    told = run.explained("misspelt-topic")
    assert told.what == (
        "the robot hears nothing: nobody publishes on /cmd_vel, and nobody hears /cmd_vell, "
        "on which tick publishes"
    )
    assert told.place is not None
    assert told.place.first_line == line_with("for publisher in publishers:") - 1


def test_a_robot_that_is_told_where_to_go_or_that_nobody_means_is_well() -> None:
    assert drive("cmd_vell", also="cmd_vel").problems() == set()
    assert drive("speed").problems() == set()
