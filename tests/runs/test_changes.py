"""What a person changed: what it makes of a set-up, how it is told, and which code would do it."""

from dataclasses import replace
from pathlib import Path

import msgspec
import pytest

from cbtui.runs.recorded.recording_file import about, setup_of
from cbtui.runs.setup.changeable import (
    ChangeableArgument,
    ChangeableCallback,
    ChangeableSetup,
    callbacks_of,
    changeable,
)
from cbtui.runs.setup.changes import GROUP_CHOICES, Changes, changes_in
from cbtui.runs.setup.equivalent_code import code_of, code_of_cure, code_of_group, edits_of
from cbtui.runs.setup.lesson_setup import RunRequest, setup_for
from cbtui.runs.setup.quantities import PERIOD, SENSOR_RATE, BadQuantityError, Quantity
from cbtui.runs.setup.shown_program import of_lesson
from cbtui.screens.windows.setup_rows import rows_of
from lessons.catalogue import find, lessons
from sim.engine.setup import GroupChange, PeriodChange, RobotUse, RunSetup
from sim.ros.middleware.callback_overrides import GroupChoice
from sim.trace.events import EntityKind
from sim.trace.timeline import Timeline
from tests.support.engine_runs import program_setup, run_to_end
from tests.support.runs import Run, dummy_server_run, shared_group_run

ODOM = ("/sub_node", "odom_callback")
SCRIPT = """
import rclpy

rclpy.init()
node = rclpy.create_node("plain")


def tick():
    pass


timer = node.create_timer(0.1, tick)
rclpy.spin(node)
"""
TIMER = ("/sub_node", "timer_callback")
WHOLE = Changes(
    threads=4,
    groups={ODOM: "own", ("", "/lamp"): "shared"},
    periods={TIMER: 200_000_000},
    settings={"-service_wait_time": 2.0},
    sensor_rate=5.0,
)
ABOUT = ChangeableSetup(
    "SingleThreadedExecutor",
    "SingleThreadedExecutor",
    None,
    (
        ChangeableCallback(ODOM, EntityKind.SUBSCRIPTION, "A exclusive, with timer", 0),
        ChangeableCallback(TIMER, EntityKind.TIMER, "A exclusive, with odom", 500_000_000),
        ChangeableCallback(("/sub_node", "/lamp"), EntityKind.CLIENT, "B exclusive, alone", 0),
    ),
    (),
    20.0,
    "jazzy@7.1.12",
)
SERVER = find("exclusive-2-threads")
LOCK = find("overlapping-timer")


def timeline_of(run: Run) -> Timeline:
    timeline = Timeline()
    timeline.extend(run.events)
    return timeline


# set-ups


def test_a_set_up_has_every_change() -> None:
    usual = setup_for(SERVER, speed=None)
    changed = WHOLE.applied(usual)
    assert changed.threads == 4
    assert changed.groups == (
        GroupChange("/sub_node", "odom_callback", "own"),
        GroupChange("", "/lamp", "shared"),
    )
    assert changed.periods == (PeriodChange("/sub_node", "timer_callback", 200_000_000),)
    assert changed.sensor_rate == 5.0
    (program,) = changed.programs
    place = program.arguments.index("-service_wait_time")
    assert program.arguments[place + 1] == "2"
    assert len(program.arguments) == len(usual.programs[0].arguments)


def test_no_change_leaves_a_set_up_as_it_is() -> None:
    recorded = WHOLE.applied(setup_for(SERVER))
    for setup in (setup_for(SERVER, threads=3), recorded):
        assert Changes().applied(setup) == setup


def test_changes_come_after_those_that_a_set_up_has_already() -> None:
    changed = Changes(groups={ODOM: "default"}).applied(WHOLE.applied(setup_for(SERVER)))
    assert changed.groups[-1] == GroupChange("/sub_node", "odom_callback", "default")
    assert changed.groups[0] == GroupChange("/sub_node", "odom_callback", "own")


def test_a_recording_holds_the_changes() -> None:
    setup = WHOLE.applied(setup_for(SERVER))
    recorded = setup_of(about(setup))
    assert recorded == setup
    assert recorded is not None
    assert changes_in(recorded) == without_arguments(WHOLE)


def without_arguments(changes: Changes) -> Changes:
    """The changes without those that are among a program's arguments."""
    return Changes(changes.threads, changes.groups, changes.periods, {}, changes.sensor_rate)


def test_a_recording_of_before_there_were_changes_is_still_known() -> None:
    old = msgspec.json.encode({"title": "old", "programs": []}).decode()
    recorded = msgspec.structs.replace(about(RunSetup(title="old", programs=())), setup=old)
    assert setup_of(recorded) == RunSetup(title="old", programs=())


def test_the_wishes_are_those_that_the_engine_knows() -> None:
    assert [*GROUP_CHOICES] == [wish.value for wish in GroupChoice]


# one change after another


def test_a_callback_gets_another_group_and_loses_it_again() -> None:
    once = Changes().with_group(ODOM, "own")
    assert once.group_of(ODOM) == "own"
    assert once.with_group(ODOM, "shared").groups == {ODOM: "shared"}
    assert once.with_group(ODOM, None) == Changes()


def test_what_holds_for_any_node_holds_for_one_until_that_is_changed() -> None:
    anyone = Changes(groups={("", "odom_callback"): "own"}, periods={("", "timer_callback"): 5})
    assert anyone.group_of(ODOM) == "own"
    assert anyone.period_of(TIMER) == 5
    assert anyone.with_group(ODOM, "default").groups == {ODOM: "default"}
    assert anyone.with_period(TIMER, None).periods == {}


def test_a_setting_comes_and_goes() -> None:
    once = Changes().with_setting("-wait", 2.0)
    assert once.settings == {"-wait": 2.0}
    assert once.with_setting("-wait", None) == Changes()


def test_what_is_beyond_others_is_what_they_do_not_say() -> None:
    more = WHOLE.with_group(TIMER, "own")
    assert more.without(WHOLE) == Changes(groups={TIMER: "own"})
    assert WHOLE.without(Changes()) == WHOLE
    assert WHOLE.without(WHOLE) == Changes()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (Changes(), ""),
        (Changes(threads=1), "1 thread"),
        (Changes(threads=4, groups={ODOM: "own"}), "odom own group, 4 threads"),
        (
            WHOLE,
            "odom own group, /lamp shared group, timer every 0.2 s, "
            "-service_wait_time 2, sensors 5 Hz, 4 threads",
        ),
    ],
)
def test_changes_are_told_in_few_words(changes: Changes, words: str) -> None:
    assert changes.words == words


# code


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        (Changes(), []),
        (Changes(threads=4), ["executor = MultiThreadedExecutor(num_threads=4)"]),
        (
            Changes(groups={ODOM: "own"}),
            [
                "self.odom_group = MutuallyExclusiveCallbackGroup()",
                "self.create_subscription(…, self.odom_callback, …,\n    callback_group=self.odom_group)",
            ],
        ),
        (
            Changes(groups={ODOM: "shared", ("", "timer_callback"): "shared"}),
            [
                "self.shared_group = MutuallyExclusiveCallbackGroup()",
                "self.create_subscription(…, self.odom_callback, …,\n    callback_group=self.shared_group)",
                "self.create_timer(…, self.timer_callback,\n    callback_group=self.shared_group)",
            ],
        ),
        (
            Changes(groups={("/sub_node", "/lamp"): "reentrant"}),
            [
                "self.reentrant_group = ReentrantCallbackGroup()",
                'self.create_client(…, "/lamp",\n    callback_group=self.reentrant_group)',
            ],
        ),
        (
            Changes(groups={ODOM: "default"}),
            ["self.create_subscription(…, self.odom_callback, …)  # no group named"],
        ),
        (
            Changes(groups={("/elsewhere", "odom_callback"): "default"}),
            ["self.create_…(…, self.odom_callback, …)  # no group named"],
        ),
        (Changes(periods={TIMER: 200_000_000}), ["self.create_timer(0.2, self.timer_callback, …)"]),
        (Changes(distro="kilted@9.1.2"), ["# cbtui: distro = kilted@9.1.2"]),
        (
            Changes(distro="lyrical"),
            ["# cbtui: distro = lyrical\n# it follows documentation and source, not runs"],
        ),
        (
            Changes(sensor_rate=5),
            ["# no line of the node: the robot's sensors measure 5 times a second"],
        ),
    ],
)
def test_changes_have_lines_of_code_that_would_make_them(changes: Changes, code: list[str]) -> None:
    assert code_of(changes, ABOUT) == code


def test_an_edited_copy_is_told_with_the_lines_that_take_it_over(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text("threads = 1\nspin()\n")
    comment, lines = edits_of(Changes(texts={str(path): "threads = 2\nspin()\n"}))
    assert comment.startswith("# an edited copy of node.py is run, node.py is unchanged")
    assert lines.splitlines()[3:] == ["-threads = 1", "+threads = 2", " spin()"]


def test_a_program_that_takes_arguments_gets_them() -> None:
    about_server = changeable(of_lesson(SERVER, lessons()), setup_for(SERVER), Timeline())
    changes = Changes(threads=4, settings={"-service_wait_time": 2.0})
    assert code_of(changes, about_server) == ["node.py … -service_wait_time 2 -threads 4"]


def test_a_short_name_is_told_in_code_by_the_whole_one() -> None:
    changes = Changes(groups={("", "odom"): "default"}, periods={("", "timer"): 5})
    assert (changes.group_of(ODOM), changes.period_of(TIMER)) == ("default", 5)
    told = "".join(code_of(changes, ABOUT))
    assert "self.odom_callback" in told
    assert "self.timer_callback" in told
    assert changes.with_group(ODOM, None).groups == {}


def test_a_cure_by_threads_has_the_lines_that_spin_them_unless_they_are_there() -> None:
    more = Changes(threads=2)
    made = "executor = MultiThreadedExecutor(num_threads=2)"
    source = "from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor\n"
    assert code_of_cure(more, ABOUT, source) == [made, "executor.add_node(node)", "executor.spin()"]
    assert code_of_cure(more, replace(ABOUT, executor_now="MultiThreadedExecutor(1)"), source) == [made]


def test_a_cure_has_the_imports_that_the_program_lacks() -> None:
    apart = Changes(threads=2, groups={ODOM: "own"})
    assert code_of_cure(apart, ABOUT, "import rclpy\n\nrclpy.spin(node)\n")[:2] == [
        "from rclpy.callback_groups import MutuallyExclusiveCallbackGroup",
        "from rclpy.executors import MultiThreadedExecutor",
    ]


def test_a_script_without_a_class_has_no_self_in_its_code(tmp_path: Path) -> None:
    path = tmp_path / "script.py"
    path.write_text(SCRIPT)
    callbacks = callbacks_of(run_to_end(program_setup(path, 0.5)).timeline)
    about = replace(ABOUT, callbacks=tuple(callbacks.values()))
    tick = ("/plain", "tick")
    assert code_of(Changes(groups={tick: "own"}, periods={tick: 200_000_000}), about) == [
        "tick_group = MutuallyExclusiveCallbackGroup()",
        "node.create_timer(…, tick,\n    callback_group=tick_group)",
        "node.create_timer(0.2, tick, …)",
    ]


@pytest.mark.parametrize("wish", GROUP_CHOICES)
def test_a_callback_without_a_name_is_left_out_of_the_code(wish: str) -> None:
    assert "lambda" not in "".join(code_of_group("<lambda>", EntityKind.TIMER, "self", wish))


@pytest.mark.parametrize("wish", GROUP_CHOICES)
@pytest.mark.parametrize("kind", [kind for kind in EntityKind if kind is not EntityKind.WAITABLE])
def test_the_lines_fit_in_the_narrowest_window(wish: str, kind: EntityKind) -> None:
    lines = "\n".join(code_of_group("SetBool_callback", kind, "self", wish)).splitlines()
    assert max(map(len, lines)) <= 72


# what can be changed


def test_the_callbacks_are_those_of_the_program_with_their_groups() -> None:
    found = callbacks_of(timeline_of(shared_group_run()))
    assert {name: callback.group for (_, name), callback in found.items()} == {
        "odom_callback": "A exclusive, with scan, timer",
        "scan_callback": "A exclusive, with odom, timer",
        "timer_callback": "A exclusive, with odom, scan",
    }
    assert {callback.name for callback in found.values() if callback.period} == {"timer_callback"}


def test_callbacks_of_one_name_are_told_apart_by_their_nodes() -> None:
    run = Run()
    for node in ("/one", "/other"):
        run.timer(run.exclusive(run.node(node)), "callback", 1.0)
    run.timer(run.exclusive(run.node("/third")), "tick", 1.0)
    found = callbacks_of(timeline_of(run)).values()
    assert [each.title for each in found] == ["callback (/one)", "callback (/other)", "tick"]
    assert {each.name for each in found} == {"callback", "tick"}


def test_a_lesson_that_takes_numbers_offers_them() -> None:
    about_server = changeable(
        of_lesson(SERVER, lessons()), setup_for(SERVER), timeline_of(dummy_server_run())
    )
    wait = Quantity("service wait time", "s", 0, 3600)
    assert about_server.arguments == (ChangeableArgument("-service_wait_time", wait, 5.0),)
    rows = {(row.what, row.aspect): row.now for row in rows_of(about_server)}
    assert rows["executor", "threads"] == "MultiThreadedExecutor(2)"
    assert rows["service wait time", "number"] == "5 s"
    assert rows["timer_callback", "period"] == "1 s"
    assert rows["robot's sensors", "rate"] == "20 Hz"


def test_what_a_run_was_changed_to_is_what_it_has_now() -> None:
    changed = Changes(settings={"-service_wait_time": 2.5}, sensor_rate=5).applied(setup_for(SERVER))
    found = changeable(of_lesson(SERVER, lessons()), changed, Timeline())
    assert [argument.now for argument in found.arguments] == [2.5]
    assert found.sensor_rate == 5


def test_a_run_without_a_robot_has_no_sensors() -> None:
    setup = msgspec.structs.replace(setup_for(SERVER), robot=RobotUse.NEVER)
    found = changeable(of_lesson(SERVER, lessons()), setup, Timeline())
    assert not [row for row in rows_of(found) if row.aspect == "rate"]


def test_a_lesson_with_a_scene_in_place_of_the_robot_has_no_sensors() -> None:
    about = changeable(of_lesson(LOCK, lessons()), setup_for(LOCK), Timeline())
    assert about.sensor_rate is None


def test_a_program_that_uses_no_robot_has_no_sensors_and_a_release_from_the_start() -> None:
    setup = msgspec.structs.replace(setup_for(SERVER), robot=RobotUse.WHEN_USED)
    found = changeable(of_lesson(SERVER, lessons()), setup, Timeline())
    rows = {(row.what, row.aspect): row.now for row in rows_of(found)}
    assert ("robot's sensors", "rate") not in rows
    assert rows["rclpy", "release"] == "jazzy@7.1.12"


# numbers


@pytest.mark.parametrize(
    ("text", "number"), [("0.001", 0.001), (" 2 s ", 2), ("1,5", 1.5), ("3600", 3600), ("1e-2s", 0.01)]
)
def test_a_number_may_have_its_unit(text: str, number: float) -> None:
    assert PERIOD.read(text) == number


@pytest.mark.parametrize(
    ("quantity", "text", "sentence"),
    [
        (PERIOD, "0", "0 is not a period; give 0.001 to 3600 s"),
        (PERIOD, "-1", "-1 is not a period; give 0.001 to 3600 s"),
        (PERIOD, "nan", "nan is not a period; give 0.001 to 3600 s"),
        (PERIOD, "soon", "'soon' is not a number; give 0.001 to 3600 s"),
        (PERIOD, "", "'' is not a number; give 0.001 to 3600 s"),
        (SENSOR_RATE, "101 Hz", "101 is not a sensor rate; give 0.1 to 100 Hz"),
    ],
)
def test_what_is_no_such_number_gets_a_sentence(quantity: Quantity, text: str, sentence: str) -> None:
    with pytest.raises(BadQuantityError) as caught:
        quantity.read(text)
    assert str(caught.value) == sentence


def test_a_seed_is_a_change_that_set_ups_keep_and_lanes_tell() -> None:
    setup = Changes(seed=17).applied(setup_for(SERVER))
    assert setup.seed == 17
    assert Changes(threads=2).applied(setup).seed == 17
    assert changes_in(setup).words == "seed 17"
    assert Changes(seed=17).without(Changes(seed=17)) == Changes()


def test_each_of_several_files_has_arguments_behind_a_double_dash_of_its_own() -> None:
    files = [Path("a.py"), Path("b.py"), Path("c.py")]
    words = ["-x", "1", "--", "-y", "2"]
    setup = RunRequest(files=files, arguments=words).setup()
    assert [each.arguments for each in setup.programs] == [("-x", "1"), ("-y", "2"), ()]
    assert RunRequest(files=files[:1], arguments=words).setup().programs[0].arguments == tuple(words)
