"""What was recorded is read again, by this program and by others."""

import random
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import given, settings
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.interfaces import ConnectionExtRosbag2

from sim.recording import RecordingMetadata, RecordingWriter, read
from sim.trace.events import AnyEvent, MessageSent, Printed, TimePassed, TopicAppeared
from sim.trace.model import Window
from tests.recording.files import (
    ABOUT,
    TOPICS,
    message,
    run_in_batches,
    timeline_of,
    without_contents,
    write,
    write_in_chunks,
)
from tests.support.daily import first_daily
from tests.support.properties import examples
from tests.trace.samples import FULL
from tests.trace.systems import legal_runs
from tests.trace.test_timeline_properties import everything

BATCHES = run_in_batches()
EVENTS = [event for events in BATCHES for event in events]
COUNTS = Counter(("", "/flag", "/number")[e.topic] for e in EVENTS if isinstance(e, MessageSent))


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "run.mcap"
    write_in_chunks(path, BATCHES)
    return path


@pytest.mark.parametrize("times", first_daily(200, 1000))
def test_the_state_at_many_times_is_that_of_the_run(recorded: Path, times: int) -> None:
    live, replayed = timeline_of(BATCHES), timeline_of(read(recorded).batches())
    chance = random.Random(4)
    for _ in range(times):
        at = chance.randint(-1, live.end + 1)
        window = Window(at, at + chance.randint(0, live.end))
        for answer in everything(at, window):
            assert answer(replayed) == answer(live)


@given(legal_runs())
@settings(deadline=None, max_examples=examples(30))
def test_any_events_come_back_as_they_were(events: list[AnyEvent]) -> None:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        write(path, events)
        assert [event for batch in read(path).batches() for event in batch] == events


def test_every_kind_of_event_comes_back(tmp_path: Path) -> None:
    write(tmp_path / "run.mcap", FULL)
    recording = read(tmp_path / "run.mcap")
    assert [event for batch in recording.batches() for event in batch] == without_contents(FULL)
    assert [(topic.name, topic.count) for topic in recording.topics()] == [("/odom", 1)]


def test_of_time_in_which_nothing_happened_only_the_end_is_kept(tmp_path: Path) -> None:
    line = Printed(5, "line", error=False)
    events: list[AnyEvent] = [TimePassed(3), line, TimePassed(7), TimePassed(9)]
    for name, told, kept in (("goes-on", events, [line, TimePassed(9)]), ("ended", events[:2], [line])):
        write(tmp_path / name, told)
        assert [event for batch in read(tmp_path / name).batches() for event in batch] == kept


def test_what_it_tells_of_itself_comes_back_with_the_sources(recorded: Path) -> None:
    recording = read(recorded)
    assert recording.about == ABOUT
    assert recording.sources[ABOUT.programs[0]].startswith('"""Recordings for tests')
    assert recording.damage is None


def test_messages_come_back_with_their_topics(recorded: Path) -> None:
    recording = read(recorded)
    assert {(topic.name, topic.type): topic.count for topic in recording.topics()} == {
        ("/flag", "std_msgs/msg/Bool"): COUNTS["/flag"],
        ("/number", "std_msgs/msg/Int32"): COUNTS["/number"],
    }
    sent = [event.data for event in EVENTS if isinstance(event, MessageSent)]
    assert [each.data for each in recording.messages()] == sent
    assert next(recording.messages()).published == 1_631_462_000_000_000_000


def test_rosbags_reads_topics_types_and_messages(recorded: Path) -> None:
    with AnyReader([recorded]) as reader:
        counts = {name: (topic.msgtype, topic.msgcount) for name, topic in reader.topics.items()}
        assert counts == {
            "/cbtui/events": ("cbtui_msgs/msg/EventBatch", len(BATCHES)),
            "/flag": ("std_msgs/msg/Bool", COUNTS["/flag"]),
            "/number": ("std_msgs/msg/Int32", COUNTS["/number"]),
        }
        numbers: list[Any] = [
            reader.deserialize(data, connection.msgtype)
            for connection, _, data in reader.messages()
            if connection.topic == "/number"
        ]
    assert [number.data for number in numbers] == [
        e.message for e in EVENTS if isinstance(e, MessageSent) and e.topic == 2
    ]


def test_topics_have_the_metadata_that_rosbag2_gives_them(tmp_path: Path) -> None:
    offered = "- history: keep_last\n  depth: 10"
    number = TopicAppeared(0, 2, "/number", "std_msgs/msg/Int32", "int32 data\n", "RIHS01_ab", offered)
    write(tmp_path / "run.mcap", [TOPICS[0], number, message(1, 1)])
    with (tmp_path / "run.mcap").open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        metadata = {each.name: each.metadata for each in reader.iter_metadata()}
    assert summary is not None
    assert {channel.topic: channel.metadata for channel in summary.channels.values()} == {
        "/cbtui/events": {},
        "/flag": {},
        "/number": {"offered_qos_profiles": offered, "topic_type_hash": "RIHS01_ab"},
    }
    assert metadata["rosbag2"] == {"ROS_DISTRO": "jazzy"}


def test_rosbags_reads_what_publishers_offer(tmp_path: Path) -> None:
    text = (
        "- history: keep_last\n  depth: 10\n  reliability: best_effort\n  durability: volatile\n"
        "  deadline: {sec: 1, nsec: 0}\n  lifespan: {sec: 2, nsec: 0}\n  liveliness: automatic\n"
        "  liveliness_lease_duration: {sec: 3, nsec: 0}\n  avoid_ros_namespace_conventions: false"
    )
    topic = TopicAppeared(0, 2, "/number", "std_msgs/msg/Int32", "int32 data\n", "RIHS01_ab", text)
    write(tmp_path / "run.mcap", [topic, message(1, 1)])
    with AnyReader([tmp_path / "run.mcap"]) as reader:
        (connection,) = reader.topics["/number"].connections
        assert isinstance(connection.ext, ConnectionExtRosbag2)
        (qos,) = connection.ext.offered_qos_profiles
        assert (qos.depth, qos.reliability.name, qos.lifespan.sec) == (10, "BEST_EFFORT", 2)


def test_mcap_reads_topics_types_and_times(recorded: Path) -> None:
    with recorded.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        found = Counter(
            (channel.topic, schema.name if schema else "", schema.encoding if schema else "")
            for schema, channel, _ in reader.iter_messages()
        )
        assert reader.get_header().profile == "ros2"
    assert found == {
        ("/cbtui/events", "cbtui_msgs/msg/EventBatch", "ros2msg"): len(BATCHES),
        ("/flag", "std_msgs/msg/Bool", "ros2msg"): COUNTS["/flag"],
        ("/number", "std_msgs/msg/Int32", "ros2msg"): COUNTS["/number"],
    }


def test_a_file_that_is_there_is_not_replaced_unless_that_is_wanted(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    path.write_text("precious")
    with pytest.raises(FileExistsError):
        RecordingWriter(path, ABOUT)
    assert path.read_text() == "precious"
    RecordingWriter(path, ABOUT, replace=True).close()
    assert read(path).about == ABOUT


def test_a_message_of_an_unknown_topic_or_without_contents_is_no_error(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    hollow = MessageSent(5, 9, 1, None)
    write(path, [message(1, 1), *TOPICS, hollow])
    recording = read(path)
    assert [event for batch in recording.batches() for event in batch] == [hollow]
    assert [topic.count for topic in recording.topics()] == [0, 0]


def test_a_disk_that_is_full_ends_the_recording_and_says_so() -> None:
    recorder = RecordingWriter(Path("/dev/full"), ABOUT, replace=True)
    for batch in BATCHES:
        recorder.take(batch)
    recorder.flush()
    assert recorder.failure == "No space left on device"
    recorder.close()


def test_sources_that_are_no_short_text_files_stay_behind(tmp_path: Path) -> None:
    for name, content in (("long.py", b"#" * 600_000), ("binary.py", b"\xff\xfe"), ("good.py", b"x = 1\n")):
        (tmp_path / name).write_bytes(content)
    names = ("long.py", "binary.py", "good.py", "none.py", ".")
    path = tmp_path / "run.mcap"
    RecordingWriter(path, RecordingMetadata(programs=tuple(str(tmp_path / name) for name in names))).close()
    assert read(path).sources == {str(tmp_path / "good.py"): "x = 1\n"}
