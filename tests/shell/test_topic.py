"""``ros2 topic``: lists, counts, rates and sizes."""

import pytest

from sim.interfaces import message
from sim.ros.node.node import Node
from sim.shell.verbs.topic_statistics import Bandwidth, RateMeter, as_bytes
from tests.shell.lines import carry_out, own
from tests.support.simulation import Simulation

Int32 = message("std_msgs", "Int32")
PointStamped = message("geometry_msgs", "PointStamped")


def talker_and_listener(_: Simulation) -> None:
    """Two nodes on /t, and a hidden topic."""
    talker, listener = Node("talker"), Node("listener")
    talker.create_publisher(Int32, "/t", 10)
    talker.create_publisher(Int32, "/_hidden", 10)
    listener.create_subscription(Int32, "/t", lambda _: None, 10)
    listener.create_subscription(Int32, "/t", lambda _: None, 10)


@pytest.mark.parametrize(
    ("line", "out"),
    [
        ("topic list", "/t\n"),
        ("topic list --include-hidden-topics", "/_hidden\n/t\n"),
        ("topic list -t", "/t [std_msgs/msg/Int32]\n"),
        (
            "topic list -v",
            "Published topics:\n"
            " * /t [std_msgs/msg/Int32] 1 publisher\n"
            "\n"
            "Subscribed topics:\n"
            " * /t [std_msgs/msg/Int32] 2 subscribers\n"
            "\n",
        ),
        ("topic info /t", "Type: std_msgs/msg/Int32\nPublisher count: 1\nSubscription count: 2\n"),
        ("topic type /t", "std_msgs/msg/Int32\n"),
        ("topic find std_msgs/msg/Int32", "/t\n"),
        ("topic find -c std_msgs/msg/Int32", "1\n"),
    ],
)
def test_what_is_known_of_topics(line: str, out: str) -> None:
    assert own(carry_out(line, talker_and_listener).out) == out


def test_topics_are_counted() -> None:
    count = len(carry_out("topic list", talker_and_listener).out.splitlines())
    assert carry_out("topic list -c", talker_and_listener).out == f"{count}\n"


def test_verbose_info_tells_of_both_ends() -> None:
    out = carry_out("topic info -v /t", talker_and_listener).out
    assert out.startswith("Type: std_msgs/msg/Int32\n\nPublisher count: 1\n\nNode name: talker\n")
    assert out.count("Endpoint type: SUBSCRIPTION") == 2
    assert "  Reliability: RELIABLE\n  History (Depth): KEEP_LAST (10)\n" in out


@pytest.mark.parametrize("verb", ["info", "type"])
def test_an_unknown_topic_is_said_as_ros2_says_it(verb: str) -> None:
    result = carry_out(f"topic {verb} /x", talker_and_listener)
    assert (result.err, result.status) == ("Unknown topic '/x'\n", 1)


def counting(simulation: Simulation) -> None:
    """A publisher that counts ten times a second, from 0.05 s on."""
    simulation.publisher_at_rate("count", 0.1, offset=0.05)


def test_hz_tells_the_rate_once_a_second() -> None:
    result = carry_out("topic hz /count", counting, interrupt_at=2.5)
    assert result.out == (
        "average rate: 10.000\n\tmin: 0.100s max: 0.100s std dev: 0.00000s window: 11\n"
        "average rate: 10.000\n\tmin: 0.100s max: 0.100s std dev: 0.00000s window: 21\n"
    )
    assert [each.at for each in result.said[::2]] == [1.15, 2.15]
    assert result.status == 2


def test_hz_waits_for_a_topic_to_be_published() -> None:
    def later(simulation: Simulation) -> None:
        def come_up() -> None:
            simulation.sleep(1.0)
            counting(simulation)

        simulation.start(come_up)

    out = carry_out("topic hz -w 5 /count", later, interrupt_at=3.0).out
    assert out.startswith(
        "WARNING: topic [/count] does not appear to be published yet\naverage rate: 10.000\n"
    )
    assert "window: 5\n" in out


def test_bw_tells_what_came_once_a_second() -> None:
    result = carry_out("topic bw /count", counting, interrupt_at=2.5)
    assert result.out == (
        "Subscribed to [/count]\n"
        "84 B/s from 10 messages\n\tMessage size mean: 8 B min: 8 B max: 8 B\n"
        "82 B/s from 20 messages\n\tMessage size mean: 8 B min: 8 B max: 8 B\n"
    )


def test_delay_compares_with_the_stamp() -> None:
    def stamped(simulation: Simulation) -> None:
        node = simulation.outside_node()
        publisher = node.create_publisher(PointStamped, "/p", 10)

        def run() -> None:
            while True:
                point = PointStamped()
                point.header.stamp = node.get_clock().now().to_msg()
                simulation.sleep(0.25)
                publisher.publish(point)

        simulation.start(run)

    out = carry_out("topic delay /p", stamped, interrupt_at=1.1).out
    assert out == "average delay: 0.250\n\tmin: 0.250s max: 0.250s std dev: 0.00000s window: 3\n"


def test_delay_needs_a_header() -> None:
    assert carry_out("topic delay /count", counting).err == "msg does not have header\n"


def test_a_window_forgets_what_is_older() -> None:
    rate = RateMeter(window=2)
    for moment in (0, 5, 6, 7, 7 + 10**9):
        rate.message(moment)
        rate.report()
    rate.message(2 * 10**9 + 20)
    assert "window: 2" in str(rate.report())
    assert Bandwidth(window=2).report(5) is None


@pytest.mark.parametrize(("size", "text"), [(12, "12 B"), (1_500, "1.50 KB"), (2_000_000, "2.00 MB")])
def test_sizes_are_written_as_ros2_writes_them(size: float, text: str) -> None:
    assert as_bytes(size) == text
