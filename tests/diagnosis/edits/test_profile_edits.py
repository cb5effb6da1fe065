"""Edits of the quality of service that an end of a topic offers or requests."""

import pytest

from sim.diagnosis.edits.profiles import keep_for_late, match_quality, set_depth
from tests.diagnosis.edits.edited_source import changed, node

QOS = "from rclpy.node import Node\nfrom rclpy.timer import Timer"


@pytest.mark.parametrize(
    ("made", "policy", "brought"),
    [
        (
            "self.create_subscription(String, 'a', self.on, 5)  # here",
            "RELIABILITY",
            [
                "+from rclpy.qos import QoSProfile, ReliabilityPolicy",
                "+        requested = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)",
                "+        self.create_subscription(String, 'a', self.on, requested)  # here",
            ],
        ),
        (
            "self.create_publisher(String, 'a', qos_profile=QoSProfile(depth=1))  # here",
            "DURABILITY",
            [
                "+from rclpy.qos import DurabilityPolicy",
                "+        self.create_publisher(String, 'a', qos_profile=QoSProfile(depth=1, "
                "durability=DurabilityPolicy.TRANSIENT_LOCAL))  # here",
            ],
        ),
        (
            "mine = QoSProfile(depth=1, reliability=RELIABLE)\n"
            "    self.create_subscription(String, 'a', self.on, mine)  # here",
            "RELIABILITY",
            [
                "+from rclpy.qos import ReliabilityPolicy",
                "+        mine = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)",
            ],
        ),
        (
            "both = QoSProfile(depth=1)\n    self.create_publisher(String, 'b', both)\n"
            "    self.create_subscription(String, 'a', self.on, both)  # here",
            "RELIABILITY",
            [
                "+from copy import copy",
                "+",
                "+from rclpy.qos import ReliabilityPolicy",
                "+        requested = copy(both)",
                "+        requested.reliability = ReliabilityPolicy.BEST_EFFORT",
                "+        self.create_subscription(String, 'a', self.on, requested)  # here",
            ],
        ),
        ("self.create_subscription(String, 'a', self.on, 5)  # here", "DEADLINE", None),
        (
            "self.create_publisher(String, 'a', qos_profile_sensor_data)  # here",
            "DURABILITY",
            [
                "+from copy import copy",
                "+",
                "+from rclpy.qos import DurabilityPolicy",
                "+        offered = copy(qos_profile_sensor_data)",
                "+        offered.durability = DurabilityPolicy.TRANSIENT_LOCAL",
                "+        self.create_publisher(String, 'a', offered)  # here",
            ],
        ),
        (
            "queue = 10\n    self.create_subscription(String, 'a', self.on, queue)  # here",
            "RELIABILITY",
            [
                "+from rclpy.qos import QoSProfile, ReliabilityPolicy",
                "+        requested = QoSProfile(depth=queue, reliability=ReliabilityPolicy.BEST_EFFORT)",
                "+        self.create_subscription(String, 'a', self.on, requested)  # here",
            ],
        ),
    ],
)
def test_an_end_of_a_topic_gets_the_profile_that_fits(
    made: str, policy: str, brought: list[str] | None
) -> None:
    text = node(f"def __init__(self):\n    {made}", QOS)
    lines = changed(text, match_quality, policy)
    assert (None if lines is None else [each for each in lines if each[0] == "+"]) == brought


def test_both_ends_of_a_topic_keep_its_last_messages() -> None:
    text = node(
        """
        def __init__(self):
            self.speaker = self.create_publisher(String, "map", 1)
            self.create_subscription(String, "map", self.on_map, 10)  # here
        """
    )
    speaker = next(number for number, line in enumerate(text.splitlines(), 1) if "speaker" in line)
    assert [each for each in changed(text, keep_for_late, speaker) or () if each[0] == "+"] == [
        "+from rclpy.qos import DurabilityPolicy, QoSProfile",
        "+        offered = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)",
        '+        self.speaker = self.create_publisher(String, "map", offered)',
        "+        requested = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)",
        '+        self.create_subscription(String, "map", self.on_map, requested)  # here',
    ]


@pytest.mark.parametrize(
    ("made", "brought"),
    [
        ("on(String, 'a', self.on, 10)  # here", "on(String, 'a', self.on, 1)  # here"),
        (
            "on(String, 'a', self.on, QoSProfile(depth=9))  # here",
            "on(String, 'a', self.on, QoSProfile(depth=1))  # here",
        ),
        ("on(String, 'a', self.on, qos_profile_sensor_data)  # here", None),
    ],
)
def test_a_queue_of_one_keeps_the_newest_message(made: str, brought: str | None) -> None:
    begin = "    self.create_subscripti"
    lines = changed(node(f"def __init__(self):\n{begin}{made}", QOS), set_depth, 1)
    assert (lines and lines[1:]) == (brought and [f"+    {begin}{brought}"])
