"""tf2_ros and its kin: programs as tutorials have them."""

from pathlib import Path

import numpy as np
import pytest

from sim.ros_packages.tf2_py.exceptions import ExtrapolationException
from sim.ros_packages.tf2_py.histories import FixedHistory, MovingHistory, Sample
from sim.ros_packages.tf2_py.motion import IDENTITY, Motion
from sim.trace.events import Printed
from tests.ros_packages.node_programs import printed, run

TREE = """
import math
import rclpy
from geometry_msgs.msg import PointStamped, PoseStamped, TransformStamped, Vector3Stamped
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster, TransformException
from tf2_ros.buffer import Buffer
from tf2_ros.transform_listener import TransformListener
from tf_transformations import euler_from_quaternion, quaternion_from_euler

def between(parent, child, stamp, x=0.0, y=0.0, z=0.0, yaw=0.0):
    made = TransformStamped()
    made.header.stamp = stamp.to_msg()
    made.header.frame_id = parent
    made.child_frame_id = child
    made.transform.translation.x = x
    made.transform.translation.y = y
    made.transform.translation.z = z
    turn = made.transform.rotation
    turn.x, turn.y, turn.z, turn.w = quaternion_from_euler(0, 0, yaw)
    return made

class Robot(Node):
    '''Drives along x at 1 m/s from the moment it starts, and has a laser 0.5 m above itself.'''
    def __init__(self):
        super().__init__("robot")
        self.fixed = StaticTransformBroadcaster(self)
        self.moving = TransformBroadcaster(self)
        self.start = self.get_clock().now()
        self.fixed.sendTransform(between("base_link", "laser", self.start, z=0.5, yaw=math.pi / 2))
        self.create_timer(0.1, self.move)
    def move(self):
        now = self.get_clock().now()
        way = (now - self.start).nanoseconds / 1e9
        self.moving.sendTransform(between("odom", "base_link", now, x=way))

class Listener(Node):
    def __init__(self, period):
        super().__init__("listener")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.start = self.get_clock().now()
        self.timer = self.create_timer(period, self.tick)
    def since(self, time):
        return round((Time.from_msg(time) - Time.from_msg(self.start.to_msg())).nanoseconds / 1e9, 3)

def spin(*nodes, executor=None, seconds=3.0):
    executor = executor or SingleThreadedExecutor()
    for each in nodes:
        executor.add_node(each)
    end = nodes[0].get_clock().now() + Duration(seconds=seconds)
    while nodes[0].get_clock().now() < end:
        executor.spin_once(timeout_sec=0.1)
    executor.shutdown()

rclpy.init()
"""


def test_a_listener_looks_up_the_newest_transform_and_transforms_data(tmp_path: Path) -> None:
    said = printed(
        tmp_path,
        TREE
        + """
import tf2_geometry_msgs

class Watcher(Listener):
    def tick(self):
        found = self.buffer.lookup_transform("odom", "laser", Time())
        shift, turn = found.transform.translation, found.transform.rotation
        yaw = euler_from_quaternion((turn.x, turn.y, turn.z, turn.w))[2]
        print(found.header.frame_id, found.child_frame_id, self.since(found.header.stamp), end=" ")
        print(f"{shift.x:.2f} {shift.y:.2f} {shift.z:.2f} {yaw:.3f}")
        seen = PointStamped()
        seen.header.frame_id = "laser"
        seen.point.x = 2.0
        there = self.buffer.transform(seen, "odom")
        print(there.header.frame_id, f"{there.point.x:.2f} {there.point.y:.2f} {there.point.z:.2f}")
        towards = Vector3Stamped()
        towards.header.frame_id = "laser"
        towards.vector.x = 1.0
        print(f"{self.buffer.transform(towards, 'odom').vector.y:.2f}")
        goal = PoseStamped()
        goal.header.frame_id = "odom"
        home = self.buffer.transform(goal, "base_link", timeout=Duration(seconds=1.0))
        print(f"{home.pose.position.x:.2f} {home.pose.orientation.w:.2f}")

spin(Robot(), Watcher(0.55), seconds=0.6)
""",
    )
    assert said == ["odom laser 0.5 0.50 0.00 0.50 1.571", "odom 0.50 2.00 0.50", "1.00", "-0.50 1.00"]


def test_what_is_missing_is_told_in_tf2s_words(tmp_path: Path) -> None:
    said = printed(
        tmp_path,
        TREE
        + """
buffer = Buffer()
at = lambda seconds: Time(nanoseconds=round(seconds * 1e9))
def ask(*question):
    try:
        buffer.lookup_transform(*question)
    except TransformException as error:
        print(f"{type(error).__name__}: {error}")
buffer.set_transform(between("odom", "base", at(1.0)), "test")
ask("odom", "base", at(2.0))
buffer.set_transform(between("odom", "base", at(1.5)), "test")
ask("odom", "base", at(2.0))
ask("odom", "base", at(0.5))
ask("map", "base", at(1.0))
ask("odom", "wheel", Time())
ask("/odom", "base", Time())
ask("", "base", Time())
buffer.set_transform(between("island", "tree", at(1.5)), "test")
ask("odom", "tree", Time())
ask("odom", "tree", at(1.5))
buffer.set_transform(between("base", "odom", at(1.5)), "test")
ask("island", "base", Time())
print(buffer.can_transform("odom", "wheel", Time(), return_debug_tuple=True))
print(buffer.can_transform("odom", "island", at(9)), buffer.can_transform("a", "a", Time()))
""",
    )
    asked = ", when looking up transform from frame [base] to frame [odom]"
    trees = "because they are not part of the same tree.Tf has two or more unconnected trees."
    assert said[:8] == [
        "ExtrapolationException: Lookup would require extrapolation at time 2.000000, "
        f"but only time 1.000000 is in the buffer{asked}",
        "ExtrapolationException: Lookup would require extrapolation into the future.  "
        f"Requested time 2.000000 but the latest data is at time 1.500000{asked}",
        "ExtrapolationException: Lookup would require extrapolation into the past.  "
        f"Requested time 0.500000 but the earliest data is at time 1.000000{asked}",
        'LookupException: "map" passed to lookupTransform argument target_frame does not exist. ',
        'LookupException: "wheel" passed to lookupTransform argument source_frame does not exist. ',
        'InvalidArgumentException: Invalid argument "/odom" passed to lookupTransform argument target_frame'
        " - in tf2 frame_ids cannot start with a '/'",
        'InvalidArgumentException: Invalid argument "" passed to lookupTransform argument target_frame'
        " - in tf2 frame_ids cannot be empty",
        f"ConnectivityException: Could not find a connection between 'odom' and 'tree' {trees}",
    ]
    assert said[8] == said[7]
    assert said[9] == "LookupException: The tf tree is invalid because it contains a loop."
    assert said[-2:] == [
        '(0, \'Invalid frame ID "wheel" passed to canTransform argument source_frame - '
        "frame does not exist')",
        "0 1",
    ]


def test_data_that_cannot_be_right_is_ignored_with_a_line_on_stderr(tmp_path: Path) -> None:
    said = printed(
        tmp_path,
        TREE
        + """
buffer = Buffer(Duration(seconds=2.0))
at = lambda seconds: Time(nanoseconds=round(seconds * 1e9))
buffer.set_transform(between("odom", "odom", at(1.0)), "me")
buffer.set_transform(between("odom", "", at(1.0)), "me")
buffer.set_transform(between("", "base", at(1.0)), "me")
flat = between("odom", "base", at(1.0))
flat.transform.rotation.w = 0.0
buffer.set_transform(flat, "me")
buffer.set_transform(between("odom", "base", at(1.0), x=float("nan")), "me")
buffer.set_transform(between("odom", "base", at(9.0)), "me")
buffer.set_transform(between("odom", "base", at(5.0)), "me")
""",
        error=True,
    )
    assert [line.split(":")[1].strip() for line in said[:5]] == [
        "TF_SELF_TRANSFORM",
        "TF_NO_CHILD_FRAME_ID",
        "TF_NO_FRAME_ID",
        "TF_DENORMALIZED_QUATERNION",
        "TF_NAN_INPUT",
    ]
    assert said[5] == (
        "Warning: TF_OLD_DATA ignoring data from the past for frame base at time 5.000000 according to "
        "authority me"
    )


LOOKUP_IN_A_CALLBACK = """
class Impatient(Listener):
    def tick(self):
        self.timer.cancel()
        begun = self.get_clock().now()
        try:
            self.buffer.lookup_transform("odom", "base_link", begun, timeout=Duration(seconds=0.5))
            result = "found"
        except TransformException as error:
            result = type(error).__name__
        print(result, (self.get_clock().now() - begun).nanoseconds // 10_000_000)
"""


def test_with_one_thread_a_lookup_waits_for_the_callback_that_it_keeps_from_running(tmp_path: Path) -> None:
    program = TREE + LOOKUP_IN_A_CALLBACK + "spin(Robot(), Impatient(0.25), seconds=2.0)\n"
    assert printed(tmp_path, program) == ["ExtrapolationException 50"]


def test_a_second_thread_hears_the_transform_that_a_lookup_waits_for(tmp_path: Path) -> None:
    executor = "executor=MultiThreadedExecutor(4)"
    program = TREE + LOOKUP_IN_A_CALLBACK + f"spin(Robot(), Impatient(0.25), {executor}, seconds=2.0)\n"
    assert printed(tmp_path, program) == ["found 6"]


def test_a_listener_with_a_thread_of_its_own_hears_while_the_node_waits(tmp_path: Path) -> None:
    program = (
        TREE
        + """
import threading
robot = Robot()
def drive():
    try:
        rclpy.spin(robot)
    except rclpy.executors.ExternalShutdownException:
        pass
threading.Thread(target=drive).start()
node = rclpy.create_node("asker")
buffer = Buffer()
listener = TransformListener(buffer, node, spin_thread=True)
begun = node.get_clock().now()
found = buffer.lookup_transform("odom", "laser", Time(), timeout=Duration(seconds=3.0))
print((node.get_clock().now() - begun).nanoseconds // 10_000_000)
rclpy.shutdown()
listener.dedicated_listener_thread.join()
"""
    )
    assert printed(tmp_path, program) == ["10"]


def test_a_callback_awaits_a_transform_while_its_executor_goes_on(tmp_path: Path) -> None:
    program = (
        TREE
        + """
class Patient(Listener):
    async def tick(self):
        self.timer.cancel()
        asked = self.get_clock().now() + Duration(seconds=0.22)
        found = await self.buffer.wait_for_transform_async("odom", "base_link", asked)
        waited = (self.get_clock().now() - self.start).nanoseconds // 10_000_000
        print(f"{found.transform.translation.x:.2f}", waited)
        again = await self.buffer.lookup_transform_async("odom", "base_link", Time())
        print(f"{again.transform.translation.x:.2f}")
spin(Robot(), Patient(0.25), seconds=1.0)
"""
    )
    assert printed(tmp_path, program) == ["0.47 50", "0.50"]


def test_travelling_in_time_takes_a_frame_that_stood_still(tmp_path: Path) -> None:
    program = (
        TREE
        + """
buffer = Buffer()
at = lambda seconds: Time(nanoseconds=round(seconds * 1e9))
for second in range(1, 9):
    buffer.set_transform(between("world", "carrot", at(second), x=float(second)), "test")
    buffer.set_transform(between("world", "turtle", at(second), y=float(second)), "test")
found = buffer.lookup_transform_full("turtle", at(8), "carrot", at(3), "world", timeout=Duration(seconds=1))
print(found.transform.translation.x, found.transform.translation.y, found.header.stamp.sec)
half = buffer.lookup_transform("world", "carrot", at(2.5)).transform.translation.x
print(half, buffer.get_latest_common_time("turtle", "carrot").nanoseconds)
print(buffer.all_frames_as_string(), end="")
print(buffer.all_frames_as_yaml().splitlines()[:4])
"""
    )
    assert printed(tmp_path, program) == [
        "3.0 -8.0 8",
        "2.5 8000000000",
        "Frame carrot exists with parent world.",
        "Frame turtle exists with parent world.",
        "['carrot: ', \"  parent: 'world'\", \"  broadcaster: 'test'\", '  rate: 1.143']",
    ]


def test_static_transforms_reach_those_who_come_later_and_hold_for_all_time(tmp_path: Path) -> None:
    program = (
        TREE
        + """
sender = rclpy.create_node("sender")
fixed = StaticTransformBroadcaster(sender)
now = sender.get_clock().now()
fixed.sendTransform([between("base", "left", now, y=1.0), between("base", "right", now, y=-1.0)])
fixed.sendTransform(between("base", "left", now, y=2.0))
class Late(Listener):
    def tick(self):
        ever = Time(nanoseconds=77)
        print(self.buffer.lookup_transform("right", "left", ever).transform.translation.y)
spin(sender, Late(0.15), seconds=0.2)
print([each.qos_profile.durability.name for each in sender.get_publishers_info_by_topic("/tf_static")])
"""
    )
    assert printed(tmp_path, program) == ["3.0", "['TRANSIENT_LOCAL']"]


def test_the_frames_that_a_buffer_knows_are_served(tmp_path: Path) -> None:
    program = (
        TREE
        + """
from tf2_msgs.srv import FrameGraph
node = rclpy.create_node("asker")
buffer = Buffer(node=node)
buffer.set_transform_static(between("a", "b", node.get_clock().now()), "me")
reply = node.create_client(FrameGraph, "tf2_frames").call_async(FrameGraph.Request())
rclpy.spin_until_future_complete(node, reply)
print(reply.result().frame_yaml.splitlines()[1])
"""
    )
    assert printed(tmp_path, program) == ["  parent: 'a'"]


def test_a_type_that_nobody_registered_is_named(tmp_path: Path) -> None:
    ended = run(
        tmp_path,
        TREE + "Buffer().transform(PointStamped(), 'odom')\n",
    )
    assert "TypeException: Type <class 'geometry_msgs.msg._point_stamped.PointStamped'> is not loaded" in (
        ended.ending.reason
    )


def test_a_polygon_is_moved_with_all_its_points(tmp_path: Path) -> None:
    program = (
        TREE
        + """
from geometry_msgs.msg import Point32, PolygonStamped
import tf2_geometry_msgs
buffer = Buffer()
at = Time(nanoseconds=10**9)
buffer.set_transform_static(between("base", "laser", at, x=1.0, yaw=math.pi / 2), "me")
field = PolygonStamped()
field.header.frame_id, field.polygon.points = "laser", [Point32(x=2.0), Point32(y=1.0, z=3.0)]
moved = buffer.transform(field, "base")
print(moved.header.frame_id, [(round(p.x, 3), round(p.y, 3), p.z) for p in moved.polygon.points])
"""
    )
    assert printed(tmp_path, program) == ["base [(1.0, 2.0, 0.0), (0.0, 0.0, 3.0)]"]


def test_a_name_that_is_not_here_is_told_by_what_does_its_work(tmp_path: Path) -> None:
    wanted = "is not modelled here; it asks a buffer_server, which is a program in C++; give"
    for program in ("from tf2_ros import BufferClient\n", "import tf2_ros\ntf2_ros.BufferClient\n"):
        reason = run(tmp_path, program).ending.reason
        assert f"tf2_ros.BufferClient {wanted}" in reason
        assert "sim." not in reason


def test_a_cloud_is_moved_with_all_its_points(tmp_path: Path) -> None:
    program = (
        TREE
        + """
import numpy as np
from sensor_msgs_py import point_cloud2
from std_msgs.msg import Header
import tf2_sensor_msgs
buffer = Buffer()
at = Time(nanoseconds=10**9)
buffer.set_transform_static(between("base", "laser", at, x=1.0, yaw=math.pi / 2), "me")
cloud = point_cloud2.create_cloud_xyz32(Header(frame_id="laser", stamp=at.to_msg()), [(1, 0, 0), (0, 2, 3)])
moved = buffer.transform(cloud, "base")
print(moved.header.frame_id, np.round(point_cloud2.read_points_numpy(moved), 3).tolist())
"""
    )
    assert printed(tmp_path, program) == ["base [[1.0, 1.0, 0.0], [-1.0, 0.0, 3.0]]"]


def along_x(stamp: int, x: float, parent: str = "odom") -> Sample:
    return Sample(stamp, parent, Motion(IDENTITY.rotation, np.array((x, 0.0, 0.0))))


def test_a_history_keeps_its_length_and_puts_late_data_in_its_place() -> None:
    history = MovingHistory(length=10)
    assert history.add(along_x(5, 5.0))
    assert history.add(along_x(20, 20.0))
    assert [each.stamp for each in history.samples] == [20]
    assert not history.add(along_x(9, 9.0))
    assert history.add(along_x(10, 10.0))
    assert history.add(along_x(10, 10.0))
    assert [each.stamp for each in history.samples] == [10, 20]
    assert history.at(15).motion.translation[0] == 15.0
    assert history.add(along_x(15, 0.0, parent="map"))
    assert history.at(12).parent == "odom"
    assert history.at(17).parent == "map"


def test_a_cleared_history_has_nothing_and_a_static_one_stays() -> None:
    moving, fixed = MovingHistory(10), FixedHistory()
    for each in (moving, fixed):
        each.add(along_x(1, 1.0))
        each.clear()
    assert fixed.at(12345).parent == "odom"
    with pytest.raises(ExtrapolationException):
        moving.at(0)


def test_a_motion_and_its_inverse_cancel_out() -> None:
    turn = np.array((0.5, 0.5, -0.5, 0.5))
    motion = Motion(turn, np.array((1.0, 2.0, 3.0)))
    back = motion.inverse().after(motion)
    assert np.allclose(back.rotation, IDENTITY.rotation)
    assert np.allclose(back.translation, 0.0)
    there = Motion(-turn, motion.translation)
    assert np.allclose(np.abs(motion.towards(there, 0.5).rotation), np.abs(turn))


SET_BACK = """
import threading
import time
from rclpy.executors import ExternalShutdownException
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock
world = Node("world")
clock = world.create_publisher(Clock, "/clock", 10)
node = Node("asker", parameter_overrides=[Parameter("use_sim_time", value=True)])
buffer = Buffer(node=node)
def spin():
    try:
        rclpy.spin(node)
    except ExternalShutdownException:
        pass
threading.Thread(target=spin).start()
def set_clock(seconds):
    clock.publish(Clock(clock=Time(seconds=seconds).to_msg()))
    time.sleep(0.1)
set_clock(100.0)
buffer.set_transform(between("odom", "base", Time(seconds=100.0)), "me")
buffer.set_transform_static(between("base", "laser", Time(seconds=100.0)), "me")
set_clock(101.0)
print(buffer.can_transform("odom", "base", Time()), buffer.can_transform("base", "laser", Time()))
def later():
    time.sleep(0.5)
    set_clock(10.0)
    knows = [buffer.can_transform(*pair, Time()) for pair in (("odom", "base"), ("base", "laser"))]
    print("set back", *knows)
    time.sleep(0.4)
    if AGAIN:
        buffer.set_transform(between("odom", "base", Time(seconds=10.5)), "me")
threading.Thread(target=later).start()
begun = time.monotonic()
try:
    found = buffer.lookup_transform("odom", "base", Time(seconds=10.5), timeout=Duration(seconds=2.0))
    print("found", found.header.stamp.sec, end=" ")
except TransformException as error:
    print(type(error).__name__, end=" ")
print(f"{time.monotonic() - begun:.1f}")
rclpy.shutdown()
"""


@pytest.mark.parametrize(
    ("again", "ends"), [("True", "found 10 1.0"), ("False", "ExtrapolationException 2.0")]
)
def test_a_clock_that_is_set_back_empties_the_buffer_and_a_lookup_waits_on(
    tmp_path: Path, again: str, ends: str
) -> None:
    """Its timeout is counted on the system's clock, and what is static stays: so has tf2_ros_py of Jazzy."""
    ended = run(tmp_path, TREE + SET_BACK.replace("AGAIN", again))
    said = [event.text for event in ended.events if isinstance(event, Printed)]
    assert said == ["1 1", "set back 0 1", ends]
    assert [text for _, text in ended.logs()].count("Detected jump back in time. Clearing tf buffer.") == 1
