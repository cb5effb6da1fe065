"""Offered qualities of service are told as rosbag2's own files tell them."""

import yaml
from rosbags.interfaces import QosDurability, QosHistory, QosReliability, QosTime
from rosbags.rosbag2.metadata import parse_qos

from sim.ros.qos.offered import offered_qos_text
from sim.ros.qos.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sim.ros.time.duration import Duration

FOR_EVER = {"sec": 9223372036, "nsec": 854775807}


def test_what_was_left_open_is_told_as_others_see_it() -> None:
    assert yaml.safe_load(offered_qos_text(QoSProfile(depth=7))) == [
        {
            "history": "keep_last",
            "depth": 7,
            "reliability": "reliable",
            "durability": "volatile",
            "deadline": FOR_EVER,
            "lifespan": FOR_EVER,
            "liveliness": "automatic",
            "liveliness_lease_duration": FOR_EVER,
            "avoid_ros_namespace_conventions": False,
        }
    ]


def test_rosbags_reads_every_policy() -> None:
    profile = QoSProfile(
        depth=3,
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
        deadline=Duration(seconds=1.5),
    )
    (read,) = parse_qos(offered_qos_text(profile))
    assert (read.history, read.depth) == (QosHistory.KEEP_LAST, 3)
    assert (read.reliability, read.durability) == (QosReliability.BEST_EFFORT, QosDurability.TRANSIENT_LOCAL)
    assert read.deadline == QosTime(1, 500_000_000)
