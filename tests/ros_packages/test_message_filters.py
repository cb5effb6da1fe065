"""message_filters: messages of several topics, brought together by their stamps."""

from pathlib import Path

from tests.ros_packages.node_programs import printed, run

TOPICS = """
import message_filters
import rclpy
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import CameraInfo, Image, Temperature
from std_msgs.msg import String

rclpy.init()
node = Node("fusion")
image = node.create_publisher(Image, "image", 10)
info = node.create_publisher(CameraInfo, "camera_info", 10)
image_sub = message_filters.Subscriber(node, Image, "image")
info_sub = message_filters.Subscriber(node, CameraInfo, "camera_info", qos_profile=5)

def at(kind, seconds):
    made = kind()
    made.header.stamp = Time(nanoseconds=round(seconds * 1e9)).to_msg()
    return made

def when(msg):
    return msg.header.stamp.sec + msg.header.stamp.nanosec / 1e9

def both(image_msg, info_msg, *more):
    print(when(image_msg), when(info_msg), *more)

def spin():
    for _ in range(20):
        rclpy.spin_once(node, timeout_sec=0.01)
"""


def test_messages_of_one_stamp_come_together(tmp_path: Path) -> None:
    program = (
        TOPICS
        + """
sync = message_filters.TimeSynchronizer([image_sub, info_sub], 3)
sync.registerCallback(both, "and more")
for second in (1, 2, 3, 4, 5):
    image.publish(at(Image, second))
spin()
for second in (6, 4, 2, 3, 5):
    info.publish(at(CameraInfo, second))
spin()
"""
    )
    assert printed(tmp_path, program) == ["4.0 4.0 and more", "5.0 5.0 and more"]


def test_a_synchroniser_whose_stamps_never_meet_says_nothing(tmp_path: Path) -> None:
    program = (
        TOPICS
        + """
sync = message_filters.TimeSynchronizer([image_sub, info_sub], 10)
sync.registerCallback(both)
for second in range(5):
    image.publish(at(Image, second))
    info.publish(at(CameraInfo, second + 0.001))
spin()
"""
    )
    assert printed(tmp_path, program) == []


def test_an_approximate_one_takes_the_nearest_within_its_slop(tmp_path: Path) -> None:
    program = (
        TOPICS
        + """
sync = message_filters.ApproximateTimeSynchronizer([image_sub, info_sub], 10, 0.1)
sync.registerCallback(both)
for each in (at(CameraInfo, 0.95), at(CameraInfo, 0.99), at(CameraInfo, 1.2)):
    info.publish(each)
spin()
image.publish(at(Image, 1.0))
image.publish(at(Image, 1.01))
image.publish(at(Image, 1.1))
spin()
image.publish(at(Image, 1.25))
spin()
"""
    )
    assert printed(tmp_path, program) == ["1.0 0.99", "1.01 0.95", "1.25 1.2"]


def test_messages_without_a_header_count_when_they_come_if_they_may(tmp_path: Path) -> None:
    program = (
        TOPICS
        + """
words = node.create_publisher(String, "words", 10)
sync = message_filters.ApproximateTimeSynchronizer(
    [message_filters.Subscriber(node, String, "words"), image_sub], 10, 0.5, allow_headerless=True)
sync.registerCallback(lambda word, image_msg: print(word.data))
strict = message_filters.Cache(message_filters.Subscriber(node, String, "words"), 5)
now = at(Image, 0)
now.header.stamp = node.get_clock().now().to_msg()
image.publish(now)
words.publish(String(data="hello"))
spin()
print(strict.getLast())
"""
    )
    ended = run(tmp_path, program)
    assert printed(tmp_path, program) == ["hello", "None"]
    assert any(
        "can not use message filters for messages without timestamp" in text for _, text in ended.logs()
    )


def test_a_cache_is_asked_by_time(tmp_path: Path) -> None:
    program = (
        TOPICS
        + """
heat = node.create_publisher(Temperature, "heat", 10)
cache = message_filters.Cache(message_filters.Subscriber(node, Temperature, "heat"), 3)
cache.registerCallback(lambda msg: print("new", when(msg)))
print(cache.getLast(), cache.getOldestTime())
for second in (1, 2, 3, 4):
    heat.publish(at(Temperature, second))
spin()
s = lambda seconds: Time(nanoseconds=round(seconds * 1e9), clock_type=rclpy.clock.ClockType.ROS_TIME)
print([when(each) for each in cache.getInterval(s(1.5), s(3.0))])
print(when(cache.getElemAfterTime(s(2.5))), when(cache.getElemBeforeTime(s(2.5))), when(cache.getLast()))
print(cache.getElemBeforeTime(s(1)), cache.getLastestTime().nanoseconds, cache.getOldestTime().nanoseconds)
"""
    )
    assert printed(tmp_path, program) == [
        "None None",
        *(f"new {each}.0" for each in (1, 2, 3, 4)),
        "[2.0, 3.0]",
        "3.0 2.0 4.0",
        "None 4000000000 2000000000",
    ]


def test_a_subscriber_passes_on_what_a_subscription_has(tmp_path: Path) -> None:
    program = TOPICS + "print(info_sub.getTopic(), info_sub.topic_name, info_sub.qos_profile.depth)\n"
    assert printed(tmp_path, program) == ["camera_info /camera_info 5"]


def test_a_chain_is_one_filter_of_several(tmp_path: Path) -> None:
    program = (
        TOPICS
        + """
first, second = message_filters.Cache(message_filters.SimpleFilter(), 5), message_filters.SimpleFilter()
second.add = lambda msg: second.signalMessage(msg, "second")
chain = message_filters.Chain(image_sub)
chain.registerCallback(lambda msg, *more: print(when(msg), *more))
for each in (1, 2, 3):
    image.publish(at(Image, each))
    spin()
    if each < 3:
        chain.addFilter((first, second)[each - 1])
print(when(first.getLast()), chain.getFilter(1) is second)
for deed in (lambda: chain.getFilter(2), lambda: chain.connectInput(info_sub)):
    try:
        deed()
    except Exception as error:
        print(type(error).__name__, error)
"""
    )
    assert printed(tmp_path, program) == [
        "1.0",
        "2.0",
        "3.0 second",
        "3.0 True",
        "KeyError 2",
        "RuntimeError Already connected",
    ]


def test_a_delta_filter_lets_changes_pass(tmp_path: Path) -> None:
    """As in message_filters' own tutorial: a topic is quiet while what is watched stays as it is."""
    program = (
        TOPICS
        + """
from geometry_msgs.msg import PointStamped
from message_filters.delta_filter import DeltaFilter, PathDeltaFilter
points = message_filters.SimpleFilter()
far = DeltaFilter([lambda msg: msg.point.x > 1.0], points)
far.registerCallback(lambda msg: print("far", msg.point.x))
moved = PathDeltaFilter(["point.x", "point.y"], points)
moved.registerCallback(lambda msg: print("moved", msg.point.x, msg.point.y))
for x, y in ((0.0, 0.0), (0.0, 0.0), (0.5, 0.0), (0.5, 2.0), (1.5, 2.0)):
    message = PointStamped()
    message.point.x, message.point.y = x, y
    points.signalMessage(message)
for wrong in (PathDeltaFilter(["point.w"]), DeltaFilter([lambda msg: msg.point])):
    try:
        wrong.add(message)
        wrong.add(message)
    except Exception as error:
        print(type(error).__name__, error)
"""
    )
    assert printed(tmp_path, program) == [
        "far 0.0",
        "moved 0.0 0.0",
        "moved 0.5 0.0",
        "moved 0.5 2.0",
        "far 1.5",
        "moved 1.5 2.0",
        "RuntimeError Unable to access field 'w' of Point (full path: 'point.w')",
        "TypeError Unable to compare fields of types <class 'geometry_msgs.msg._point.Point'> and "
        "<class 'geometry_msgs.msg._point.Point'>",
    ]
