"""The rule on waits without a timeout, for notices with and without the fields that older recordings lack."""

import msgspec

from sim.diagnosis.diagnoses import diagnose
from sim.trace.events import AnyEvent, Notice, NoticeKind, Severity, decode
from sim.trace.timeline import Timeline
from tests.trace.samples import CAST


def explained(*events: AnyEvent) -> list[tuple[str, str]]:
    timeline = Timeline()
    timeline.extend([*CAST, *events])
    told = [(found, found.rule.explain(found, timeline)) for found in diagnose(timeline)]
    return [(each.what, each.cure) for found, each in told if found.rule.id == "endless-wait"]


def test_what_is_wrong_and_what_to_do_are_fields_of_the_notice() -> None:
    fields = ("it waits; its own lock", "let; go")
    notice = Notice(1, Severity.WARN, "words", 1, False, NoticeKind.DEADLOCK, *fields)
    assert explained(notice) == [("odom_callback is in a deadlock: it waits; its own lock", "let; go")]


def test_a_recording_without_these_fields_is_told_in_the_words_of_its_notice() -> None:
    old = [["notice", 1, "ERROR", "deadlock: it waits; let go", 1]]
    events = decode(msgspec.msgpack.encode(old))
    assert explained(*events) == [
        (
            "odom_callback: deadlock: it waits; let go",
            "wait with a timeout, and see that something ends the wait",
        )
    ]
