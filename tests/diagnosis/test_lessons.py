"""The lessons have exactly these findings: their own trouble, and no false alarm where they are well made."""

import pytest

from sim.diagnosis import Weight, diagnose
from tests.support.daily import first_row_daily
from tests.support.engine_runs import run_lesson

GROUP_HELD = {("group-starvation", "odom_callback")}
TURNS_FOR_LONG = ("overrun-timer", "timer_callback")
PARTS = {
    TURNS_FOR_LONG,
    ("stale-data", "timer_callback"),
    ("dropped-messages", "odom_callback"),
    ("dropped-messages", "scan_callback"),
}
"""What a group that is held brings about."""

Findings = set[tuple[str, str]]


@pytest.mark.parametrize(
    ("lesson", "calls", "threads", "problems", "remarks"),
    first_row_daily(
        ("single-thread", (), None, GROUP_HELD, PARTS),
        ("shared-group", (), None, GROUP_HELD, PARTS),
        ("shared-group", (), 4, GROUP_HELD, {*PARTS, ("groups-change-nothing", "odom_callback")}),
        ("split-groups", (), None, set(), {TURNS_FOR_LONG, ("threads-never-used", "")}),
        ("exclusive-2-threads", (2.55,), None, set(), set()),
        ("reentrant-2-threads", (2.55,), None, set(), set()),
        (
            "reentrant-1-thread",
            (2.55,),
            None,
            {("no-free-worker", "timer_callback")},
            {("groups-change-nothing", "SetBool_callback")},
        ),
    ),
)
def test_a_lesson_has_exactly_its_own_findings(
    lesson: str, calls: tuple[float, ...], threads: int | None, problems: Findings, remarks: Findings
) -> None:
    run = run_lesson(lesson, 30.0 if not calls else 12.0, *calls, threads=threads)
    timeline = run.timeline
    found: dict[Weight | None, Findings] = {Weight.PROBLEM: set(), Weight.REMARK: set()}
    for each in diagnose(timeline):
        entity = timeline.entities.get(each.subject)
        name = "" if entity is None else entity.spoken_name
        found[each.weight_in(timeline)].add((each.rule.id, name))
    assert found == {Weight.PROBLEM: problems, Weight.REMARK: remarks}


def test_calls_that_overlap_at_a_lock_are_told_which() -> None:
    timeline = run_lesson("lock-or-group", 8.0).timeline
    (found,) = (each for each in diagnose(timeline) if each.rule.id == "overlapping-callback")
    told = found.explained(timeline)
    assert "; the lock of line 51 lets one of them on at a time, and guards nothing outside it" in told.why
    assert told.cure.endswith("who waits there keeps no thread")
    assert found.weight_in(timeline) is Weight.REMARK
