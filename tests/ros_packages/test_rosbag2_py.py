"""rosbag2_py: bags written by a node, read by a program, and recordings of runs."""

from pathlib import Path

import pytest

from cbtui.cli import main
from tests.ros_packages.node_programs import printed

WRITER = """
import rclpy
import rosbag2_py
from rclpy.node import Node
from rclpy.serialization import serialize_message
from std_msgs.msg import String

class Recorder(Node):
    def __init__(self):
        super().__init__("recorder")
        self.writer = rosbag2_py.SequentialWriter()
        self.writer.open(
            rosbag2_py._storage.StorageOptions(uri="FOLDER/my_bag", storage_id="mcap"),
            rosbag2_py._storage.ConverterOptions("", ""),
        )
        self.writer.create_topic(rosbag2_py._storage.TopicMetadata(
            id=0, name="chatter", type="std_msgs/msg/String", serialization_format="cdr"))
        self.count = 0
        self.create_timer(0.5, self.tick)
    def tick(self):
        self.count += 1
        text = serialize_message(String(data=f"hello {self.count}"))
        self.writer.write("chatter", text, self.get_clock().now().nanoseconds)
        if self.count == 3:
            raise SystemExit

rclpy.init()
rclpy.spin(Recorder())
"""
READER = """
import rosbag2_py
from rclpy.serialization import deserialize_message
from rosidl_runtime_py.utilities import get_message

reader = rosbag2_py.SequentialReader()
reader.open(
    rosbag2_py.StorageOptions(uri="BAG", storage_id="mcap"),
    rosbag2_py.ConverterOptions(input_serialization_format="cdr", output_serialization_format="cdr"),
)
kinds = {each.name: each.type for each in reader.get_all_topics_and_types()}
reader.set_filter(rosbag2_py.StorageFilter(topics=["TOPIC"]))
start = None
while reader.has_next():
    topic, data, t = reader.read_next()
    start = t if start is None else start
    message = deserialize_message(data, get_message(kinds[topic]))
    print(topic, kinds[topic], round((t - start) / 1e9, 3), message.data)
"""


def test_what_a_node_wrote_is_read(tmp_path: Path) -> None:
    printed(tmp_path, WRITER.replace("FOLDER", str(tmp_path)))
    said = printed(tmp_path, READER.replace("BAG", f"{tmp_path}/my_bag").replace("TOPIC", "chatter"))
    assert said == [f"chatter std_msgs/msg/String {0.5 * each} hello {each + 1}" for each in range(3)]
    more = printed(
        tmp_path,
        f"""
        import rosbag2_py
        about = rosbag2_py.Info().read_metadata("{tmp_path}/my_bag", "mcap")
        print(about.message_count, about.duration.nanoseconds, about.storage_identifier)
        reader = rosbag2_py.SequentialReader()
        reader.open(rosbag2_py.StorageOptions("{tmp_path}/my_bag"), rosbag2_py.ConverterOptions("", ""))
        reader.seek(about.starting_time.nanoseconds + 1)
        print(reader.read_next()[1][8:15], reader.has_next())
        (definition,) = reader.get_all_message_definitions()
        print(definition.topic_type, definition.encoding, definition.encoded_message_definition.split()[-2:])
        print(reader.set_read_order(rosbag2_py.ReadOrder()), reader.set_read_order(rosbag2_py.ReadOrder(
            rosbag2_py.ReadOrderSortBy.File, reverse=True)), rosbag2_py.get_default_storage_id())
        again = rosbag2_py.SequentialCompressionReader()
        again.open_uri("{tmp_path}/my_bag")
        print(again.get_all_topics_and_types()[0].equals(reader.get_all_topics_and_types()[0]))
        def wrong(deed):
            try:
                deed()
            except RuntimeError as error:
                print(str(error).replace("{tmp_path}/", ""))
        options = rosbag2_py.StorageOptions("{tmp_path}/my_bag")
        wrong(lambda: rosbag2_py.SequentialWriter().open(options, rosbag2_py.ConverterOptions()))
        wrong(lambda: rosbag2_py.SequentialReader().open(rosbag2_py.StorageOptions("{tmp_path}/none")))
        wrong(lambda: rosbag2_py.SequentialWriter().write("chatter", b"", 0))
        """,
    )
    assert more == [
        "3 1000000001 mcap",
        "b'hello 2' True",
        "std_msgs/msg/String ros2msg ['string', 'data']",
        "True False mcap",
        "True",
        "Bag directory already exists (my_bag), can't overwrite existing bag",
        "No storage could be initialized from the inputs: none: it does not exist.",
        "Bag is not open. Call open() before writing.",
    ]


def test_a_recording_of_a_run_is_a_bag(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    talker = tmp_path / "talker.py"
    talker.write_text(
        "import rclpy\nfrom std_msgs.msg import Int32\nrclpy.init()\nnode = rclpy.create_node('talker')\n"
        "publisher = node.create_publisher(Int32, 'numbers', 10)\nnode.create_subscription(Int32, 'numbers', "
        "lambda message: None, 10)\nnode.create_timer(0.25, lambda: publisher.publish(Int32(data=7)))\n"
        "rclpy.spin(node)\n"
    )
    recording = tmp_path / "run.mcap"
    main(["run", str(talker), "--for", "1", "--clock", "virtual", "--record", str(recording)])
    capsys.readouterr()
    said = printed(tmp_path, READER.replace("BAG", str(recording)).replace("TOPIC", "/numbers"))
    assert said[:2] == [f"/numbers std_msgs/msg/Int32 {each} 7" for each in (0.0, 0.25)]
