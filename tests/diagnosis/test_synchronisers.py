"""Synchronisers of message_filters that hand on nothing: which are told, why, and which are not."""

from pathlib import Path

import pytest

from sim.diagnosis import diagnose
from sim.diagnosis.rule import Explanation
from tests.support.engine_runs import run_program

NODE = """
import rclpy
from message_filters import ApproximateTimeSynchronizer, Subscriber, TimeSynchronizer
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import Image, LaserScan

rclpy.init()
node = Node("fusion")
filters = [Subscriber(node, Image, "picture"), Subscriber(node, LaserScan, "scan")]
sync = {sync}
sync.registerCallback(lambda *_: print("FUSED"))
camera = node.create_publisher(Image, "picture", 10)
lidar = node.create_publisher(LaserScan, "scan", 10)
number = 0

def send(publisher, message, stamp):
    message.header.stamp = Time(nanoseconds=round(stamp * 1e9)).to_msg()
    publisher.publish(message)

def take():
    global number
    number += 1
    now = 1000 + number / 10
    send(camera, Image(), now)
    {scan}

node.create_timer(0.1, take)
rclpy.spin(node)
"""
EXACT = "TimeSynchronizer(filters, 10)"
CLOSE = "ApproximateTimeSynchronizer(filters, 10, slop=0.01)"


def told(folder: Path, sync: str, scan: str, until: float = 8.0) -> Explanation | None:
    """What is told of a synchroniser of pictures, ten a second, and the scans that are sent beside them."""
    timeline = run_program(folder, NODE.replace("{sync}", sync).replace("{scan}", scan), until).timeline
    found = [each for each in diagnose(timeline) if each.rule.id == "never-synchronised"]
    assert len(found) <= 1
    return found[0].rule.explain(found[0], timeline) if found else None


@pytest.mark.parametrize(
    ("sync", "scan", "what", "why", "cure"),
    [
        (EXACT, "send(lidar, LaserScan(), now + 0.018)", "at least 18 ms apart", "equal", "with slop=0.05"),
        (CLOSE, "send(lidar, LaserScan(), now + 0.018)", "at least 18 ms", "slop, 10 ms", "a slop of 0.05"),
        (EXACT, "send(lidar, LaserScan(), 0)", "stamps of /scan are 0, as take", "until", "header.stamp"),
        (CLOSE, "send(lidar, LaserScan(), now + 3e8)", "/scan at last", "different clocks", "one clock"),
        (EXACT, "send(lidar, LaserScan(), now - 1.5)", "belong together", "queue_size", "raise queue_size"),
        (EXACT, "pass", "no message of /scan came: ", "one message", "publish on"),
    ],
)  # fmt: skip
def test_it_is_told_why_nothing_is_handed_on(
    sync: str, scan: str, what: str, why: str, cure: str, tmp_path: Path
) -> None:
    explained = told(tmp_path, sync, scan)
    assert explained is not None
    assert what in explained.what
    assert why in explained.why
    assert cure in explained.cure
    assert explained.place is not None
    assert sync in Path(explained.place.file).read_text().splitlines()[explained.place.first_line - 1]


@pytest.mark.parametrize(
    ("scan", "until"),
    [
        ("send(lidar, LaserScan(), now)", 8.0),
        ("number % 10 or send(lidar, LaserScan(), now)", 8.0),
        ("send(lidar, LaserScan(), now if number > 40 else now + 0.018)", 8.0),
        ("number > 60 and send(lidar, LaserScan(), now + 0.018)", 6.3),
        ("send(lidar, LaserScan(), now + 0.018)", 1.9),
        ("number > 40 or send(lidar, LaserScan(), now)", 8.0),
    ],
    ids=["pairs", "pairs, seldom", "pairs at last", "a late start", "too early to tell", "pairs at first"],
)
def test_a_synchroniser_that_hands_on_or_may_do_so_yet_is_well(
    scan: str, until: float, tmp_path: Path
) -> None:
    assert told(tmp_path, EXACT, scan, until) is None


def test_what_follows_a_late_start_is_judged_again(tmp_path: Path) -> None:
    explained = told(tmp_path, EXACT, "number > 60 and send(lidar, LaserScan(), now + 0.018)", 9.0)
    assert explained is not None
    assert "18 ms apart" in explained.what
