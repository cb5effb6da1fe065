"""Lines of JSON: what they have, and that their documentation says so."""

import json
import subprocess
import sys
from math import inf, nan
from typing import Any

import pytest

from sim.export.jsonl import JsonLines, json_fields
from sim.trace import events as ev
from sim.trace.events import AnyEvent, kinds
from tests.support.runs import dummy_server_run
from tests.trace.events_page import PAGE, kinds_with_lines, page, unexplained
from tests.trace.samples import BARE, CAST, FULL, bare, full


def objects(events: list[AnyEvent]) -> list[dict[str, Any]]:
    return [json.loads(line) for line in JsonLines().lines(events)]


def line_of(event: AnyEvent) -> dict[str, Any]:
    return objects([ev.ProcessAppeared(0, 1, "talker-1"), *BARE[: len(CAST) + 1], event])[-1]


def test_the_page_is_written_from_the_classes_of_events() -> None:
    written = page()
    assert PAGE.read_text() == written, "write it anew: python -m tests.trace.events_page"


def test_every_field_is_explained() -> None:
    assert unexplained() == []


def test_that_time_passes_is_no_line() -> None:
    assert objects([ev.TimePassed(1)]) == []


@pytest.mark.parametrize("kind", kinds_with_lines())
def test_an_event_with_all_it_can_carry_has_all_fields_of_the_page(kind: type[AnyEvent]) -> None:
    fields = [name.rstrip("?") for field in json_fields(kind) for name in field.names]
    assert list(line_of(full(kind))) == ["t", "event", *fields]


@pytest.mark.parametrize("kind", kinds_with_lines())
def test_an_event_leaves_out_what_does_not_apply(kind: type[AnyEvent]) -> None:
    fields = [name for field in json_fields(kind) for name in field.names if not name.endswith("?")]
    assert list(line_of(bare(kind))) == ["t", "event", *fields]


@pytest.mark.parametrize("kind", kinds())
def test_an_event_is_packed_and_unpacked(kind: type[AnyEvent]) -> None:
    events = [full(kind), bare(kind)]
    assert ev.decode(ev.encode(events)) == events


def test_golden_lines() -> None:
    about = '"node":"/sub_node","callback":"odom_callback","kind":"subscription","entity":"/odom","group":"A"'
    about += ',"group_type":"exclusive"'
    assert b"".join(JsonLines().lines(FULL)).decode().splitlines()[len(CAST) + 1 :] == [
        '{"t":1.5,"event":"publish","node":"robot","callback":"timer_callback","entity":"/odom","message_id":7}',
        '{"t":1.5,"event":"qos_mismatch","node":"/sub_node","callback":"odom_callback","entity":"/odom",'
        '"policy":"RELIABILITY","publisher":"node.py:9","subscription":"node.py:12"}',
        '{"t":1.5,"event":"synchroniser","callback":"odom_callback","made_at":"node.py:14","topics":["/odom"],'
        '"slop":5e-9,"apart":9e-9,"mostly":9e-9,"matched":false}',
        '{"t":1.5,"event":"topic","entity":"/odom","type":"std_msgs/msg/Bool","definition":"bool data\\n"}',
        '{"t":1.5,"event":"message","entity":"/odom","message_id":7,"size":5}',
        f'{{"t":1.502,"event":"ready",{about},"depth":1,"message_id":7}}',
        f'{{"t":1.502,"event":"wait_start",{about},"reason":"group held","held_by":"timer_callback",'
        '"since":1.502,"workers_busy":true}',
        f'{{"t":1.502,"event":"message_drop",{about},"depth":10,"message_id":6}}',
        f'{{"t":1.502,"event":"timer_cancel",{about}}}',
        f'{{"t":1.502,"event":"timer_reset",{about}}}',
        f'{{"t":2.0,"event":"wait_end",{about}}}',
        f'{{"t":2.0,"event":"callback_start",{about},"thread":"talker-1 MainThread",'
        '"depth":0,"age":0.5,"message_id":7}',
        '{"t":2.0,"event":"log","node":"sub_node","callback":"odom_callback","thread":"talker-1 MainThread",'
        '"message":"Odom CallBack","severity":"INFO"}',
        f'{{"t":2.0,"event":"callback_suspend",{about},"thread":"talker-1 MainThread"}}',
        f'{{"t":2.1,"event":"callback_resume",{about},"thread":"talker-1 MainThread"}}',
        '{"t":2.1,"event":"service_call","callback":"odom_callback","entity":"/motor_power","call":1,'
        '"request":"SetBool_Request(data=True)"}',
        '{"t":2.1,"event":"request_lost","entity":"/motor_power","call":2}',
        '{"t":2.1,"event":"blocked","callback":"odom_callback","entity":"/motor_power",'
        '"thread":"talker-1 MainThread","call":1}',
        '{"t":2.2,"event":"service_reply","entity":"/motor_power","call":1,'
        '"response":"SetBool_Response(success=True, message=\'\')"}',
        '{"t":2.2,"event":"unblocked","thread":"talker-1 MainThread","call":1}',
        f'{{"t":2.25,"event":"callback_at",{about},"thread":"talker-1 MainThread","doing":"sleeps",'
        '"call":"time.sleep","frames":["node.py:60, in odom_callback"]}',
        '{"t":2.25,"event":"program_at","doing":"in rclpy","call":"spin","frames":["node.py:70, in main"],'
        '"loop":"node.py:69"}',
        '{"t":2.25,"event":"own_thread_at","thread":"worker","doing":"waits","call":"Event.wait",'
        '"frames":["node.py:40, in work"]}',
        '{"t":2.25,"event":"spin_clash","node":"/sub_node","callback":"odom_callback",'
        '"function":"spin_until_future_complete","file":"node.py","line":60}',
        '{"t":2.25,"event":"times_kept","node":"/sub_node","length":8.0,"attributes":["done_at"]}',
        f'{{"t":2.25,"event":"callback_error",{about},"thread":"talker-1 MainThread",'
        '"message":"IndexError: no beam 720","file":"node.py","line":60}',
        f'{{"t":2.25,"event":"callback_end",{about},"thread":"talker-1 MainThread"}}',
        '{"t":2.25,"event":"exception_surfaced","thread":"talker-1 MainThread",'
        '"message":"IndexError: no beam 720","file":"node.py","line":60}',
        '{"t":2.3,"event":"print","process":"talker-1","message":"hello","error":true}',
        '{"t":2.35,"event":"arena","walls":[[0.0,0.0,1.0,0.0]],"sphere":[0.9,0.0,0.2],"robot_radius":0.1}',
        '{"t":2.35,"event":"robot","x":0.5,"y":0.0,"yaw":-0.1,"front":null,"linear":0.08,"angular":0.0,'
        '"motors":true,"touching":false,"turned":-0.1,"travelled":0.5}',
        '{"t":2.35,"event":"scan","beams":4,"front":0.5,"message_id":8}',
        '{"t":2.4,"event":"cmd_vel","linear":0.08,"angular":-0.2}',
        '{"t":2.5,"event":"command","message":"/motor_power SetBool data=True"}',
        '{"t":2.5,"event":"input","message":"{\\"type\\":\\"call\\",\\"name\\":\\"/motor_power\\",'
        '\\"data\\":true}"}',
        '{"t":2.5,"event":"halt","message":"step"}',
        '{"t":2.5,"event":"run_ending","reason":"its time was up"}',
        '{"t":2.5,"event":"keyboard","program":"teleop.py","reads":"raw"}',
        '{"t":2.5,"event":"typed","message":"w"}',
        '{"t":2.5,"event":"line","line":1,"message":"ros2 topic list"}',
        '{"t":2.5,"event":"line_text","line":1,"message":"/odom","error":false}',
        '{"t":2.5,"event":"line_end","line":1,"status":0}',
        '{"t":2.5,"event":"completion","line":2,"start":5,"words":["list","pub"]}',
        '{"t":2.5,"event":"process_end","process":"talker-1","reason":"the program returned","status":0}',
        '{"t":2.6,"event":"notice","callback":"odom_callback","message":"The robot touches the wall.",'
        '"severity":"WARN"}',
        '{"t":2.7,"event":"lost","count":12}',
        '{"t":2.7,"event":"contents_lost","count":3}',
        f'{{"t":2.8,"event":"entity_gone",{about}}}',
        '{"t":3.0,"event":"run_end","reason":"its time was up","failed":false}',
    ]


def test_numbers_that_json_cannot_write_become_null() -> None:
    event = ev.RobotMoved(0, nan, inf, -inf, inf, 0.0, 0.0, True, False, 0.0, 0.0)
    (line,) = objects([event])
    assert [line[name] for name in ("x", "y", "yaw", "front")] == [None] * 4


def test_a_timer_is_called_by_its_callback_where_a_topic_would_stand() -> None:
    ticks = [line for line in objects(dummy_server_run().events) if line["event"] == "callback_start"]
    assert {(line["entity"], line["kind"]) for line in ticks} == {
        ("timer_callback", "timer"),
        ("/dummy_server_srv", "service"),
    }
    assert {(line["group"], line["group_type"]) for line in ticks} == {("A", "reentrant")}


def test_lines_do_not_depend_on_the_batches() -> None:
    events = dummy_server_run().events
    one_by_one = JsonLines()
    pieces = [line for event in events for line in one_by_one.lines([event])]
    assert pieces == list(JsonLines().lines(events))


def test_ids_that_were_never_introduced_still_make_a_line() -> None:
    lines = objects([ev.CallbackStarted(0, 9, 9, 1, 0, 0), ev.Published(0, 1, "/t", 9, 9)])
    assert lines[0] == {"t": 0.0, "event": "callback_start", "thread": "thread 9", "depth": 0, "age": 0.0} | {
        "message_id": 1
    }
    assert lines[1]["node"] == "node 9"


def test_what_stands_for_an_event_until_it_is_packed_is_no_kind_of_its_own() -> None:
    script = (
        "import sim.ros.middleware.contents as contents\n"
        "from sim.trace.events import Notice, Severity, decode, encode\n"
        "notice = Notice(1, Severity.INFO, 'x')\n"
        "assert decode(encode([notice])) == [notice]"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
