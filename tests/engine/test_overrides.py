"""A run with other groups, periods and sensor rates than its program asks for, its text untouched."""

from typing import Any

import msgspec
import pytest

from cbtui.runs.setup.lesson_setup import setup_for
from lessons.catalogue import find
from sim.engine.callback_overrides import overrides_of
from sim.engine.setup import GroupChange, PeriodChange, RunSetup
from sim.ros.middleware.callback_overrides import CallbackOverrides, GroupChoice
from sim.trace.events import GroupKind, NodeAppeared, RunEnded
from sim.trace.timeline import Timeline
from tests.support.engine_runs import SECOND, Run, run_to_end

SUB_NODE = "/sub_node"


def overridden(lesson: str, seconds: float, **changes: Any) -> Run:
    setup = msgspec.structs.replace(
        setup_for(find(lesson), speed=None), until=round(seconds * SECOND), **changes
    )
    return run_to_end(setup)


def groups_of(timeline: Timeline) -> dict[str, tuple[int, GroupKind]]:
    """By callback: the group's id, and its kind."""
    return {
        each.callback: (each.group, timeline.groups[each.group].kind)
        for each in timeline.entities.values()
        if each.callback.endswith("_callback")
    }


def group(callback: str, wish: str, node: str = SUB_NODE) -> GroupChange:
    return GroupChange(node, callback, wish)


@pytest.mark.slow
def test_a_group_of_its_own_and_a_thread_more_let_a_starved_callback_run() -> None:
    run = overridden("shared-group", 20, threads=2, groups=(group("scan_callback", "own"),))
    assert [at for at in run.starts("scan_callback") if 5 < at < 13]
    assert not [at for at in run.starts("odom_callback") if 5 < at < 13]


def test_callbacks_that_share_are_in_one_group_whatever_the_program_says() -> None:
    wishes = tuple(group(name, "shared") for name in ("odom_callback", "scan_callback", "timer_callback"))
    run = overridden("split-groups", 12, groups=wishes)
    found = groups_of(run.timeline)
    assert len({found[wish.callback] for wish in wishes}) == 1
    assert not run.timeline.groups[found["odom_callback"][0]].is_own
    assert not [at for at in run.starts("scan_callback") if 5 < at < 12]


def test_reentrant_callbacks_are_in_one_reentrant_group() -> None:
    wishes = tuple(group(name, "reentrant") for name in ("odom_callback", "scan_callback"))
    found = groups_of(overridden("split-groups", 1, groups=wishes).timeline)
    assert found["odom_callback"] == found["scan_callback"]
    assert found["odom_callback"][1] is GroupKind.REENTRANT
    assert found["timer_callback"][1] is GroupKind.EXCLUSIVE


def test_the_default_group_is_the_one_of_the_node() -> None:
    wishes = tuple(group(name, "default") for name in ("odom_callback", "timer_callback"))
    run = overridden("split-groups", 1, groups=wishes)
    found = groups_of(run.timeline)
    assert found["odom_callback"] == found["timer_callback"] != found["scan_callback"]
    assert found["odom_callback"][1] is GroupKind.EXCLUSIVE


def test_another_node_s_callback_of_that_name_stays_as_it_is() -> None:
    run = overridden("split-groups", 1, groups=(group("odom_callback", "reentrant", "/other"),))
    assert groups_of(run.timeline)["odom_callback"][1] is GroupKind.EXCLUSIVE


def test_a_change_without_a_node_is_for_the_callback_of_every_node() -> None:
    run = overridden(
        "split-groups",
        3,
        groups=(group("odom_callback", "reentrant", ""),),
        periods=(PeriodChange("", "timer_callback", SECOND),),
    )
    assert groups_of(run.timeline)["odom_callback"][1] is GroupKind.REENTRANT
    assert run.starts("timer_callback") == [1.0, 2.0]


def test_a_change_for_a_node_goes_before_one_for_any_node() -> None:
    wishes = (group("odom_callback", "reentrant"), group("odom_callback", "own", ""))
    run = overridden("split-groups", 1, groups=wishes)
    assert groups_of(run.timeline)["odom_callback"][1] is GroupKind.REENTRANT


def test_of_a_node_that_lacks_a_callback_its_own_are_told_and_which_node_has_that_one() -> None:
    overrides = CallbackOverrides({("/lidar", "on_control"): GroupChoice.OWN})
    for node, callback in (("/lidar", "on_sweep"), ("/control", "on_control")):
        overrides.group_choice(node, callback)
    (told,) = overrides.unmatched()
    assert told == "no callback is named on_control in /lidar; there is on_sweep; /control has it"


def test_callbacks_that_there_are_not_are_told_of_at_the_end() -> None:
    run = overridden(
        "split-groups",
        1,
        groups=(group("odo", "own", ""), group("odom_callback", "own", "/other")),
        periods=(PeriodChange("", "odom_callback", SECOND),),
    )
    assert [notice.text for notice in run.timeline.notices] == [
        "no callback is named odo; there are odom_callback, scan_callback, timer_callback; "
        "did you mean odom?",
        "no callback is named odom_callback in /other; "
        "there are odom_callback, scan_callback, timer_callback; /sub_node has it",
        "no timer callback is named odom_callback; there is timer_callback",
    ]
    assert isinstance(run.events[-1], RunEnded)


def test_changes_that_were_met_are_not_told_of() -> None:
    run = overridden(
        "split-groups",
        1,
        groups=(group("odom_callback", "own", ""),),
        periods=(PeriodChange(SUB_NODE, "timer_callback", SECOND),),
    )
    assert not run.timeline.notices


def test_a_callback_is_found_by_the_short_name_that_the_panes_show() -> None:
    changes = {"groups": (group("odom", "own", ""),), "periods": (PeriodChange(SUB_NODE, "timer", SECOND),)}
    run = overridden("shared-group", 3, **changes)
    assert not run.timeline.notices
    found = groups_of(run.timeline)
    assert found["odom_callback"] != found["scan_callback"]
    assert run.starts("timer_callback") == [1.0, 2.0]


def test_the_services_that_every_node_brings_along_are_no_callbacks_of_the_program() -> None:
    run = overridden("split-groups", 1, groups=(group("/sub_node/get_parameters", "own", ""),))
    (notice,) = run.timeline.notices
    assert notice.text.startswith("no callback is named /sub_node/get_parameters; there are odom_callback")


def test_a_timer_s_period_is_the_one_that_was_chosen() -> None:
    run = overridden("split-groups", 3, periods=(PeriodChange(SUB_NODE, "timer_callback", SECOND),))
    assert run.starts("timer_callback") == [1.0, 2.0]
    timer = next(e for e in run.timeline.entities.values() if e.callback == "timer_callback")
    assert timer.period == SECOND


def test_sensors_measure_as_often_as_was_chosen() -> None:
    run = overridden("split-groups", 3, sensor_rate=5.0)
    assert 13 <= len(run.starts("odom_callback")) <= 15
    assert 13 <= len(run.starts("scan_callback")) <= 15


def test_the_names_of_a_change_are_those_of_the_trace() -> None:
    run = overridden("split-groups", 0.1)
    assert SUB_NODE in [event.name for event in run.events if isinstance(event, NodeAppeared)]


def test_of_two_changes_of_one_callback_the_later_one_counts() -> None:
    wishes = (group("odom_callback", "own"), group("odom_callback", "reentrant"))
    overrides = overrides_of(RunSetup(title="", programs=(), groups=wishes))
    assert overrides is not None
    assert overrides.groups[SUB_NODE, "odom_callback"] == "reentrant"


def test_a_wish_that_there_is_not_is_refused() -> None:
    with pytest.raises(ValueError, match="alone"):
        overrides_of(RunSetup(title="", programs=(), groups=(group("odom_callback", "alone"),)))
