"""The lesson nodes as text: what they import, name and log, and how they read in a narrow pane."""

import ast
import sys

import pytest

from lessons.catalogue import find, lessons
from lessons.lesson import Lesson

ROBOT_LESSONS = [find(name) for name in ("single-thread", "shared-group", "split-groups")]
SERVER_LESSONS = [
    find(name)
    for name in ("exclusive-2-threads", "reentrant-2-threads", "reentrant-1-thread", "no-groups-at-all")
]
ROS_PACKAGES = {"rclpy", "geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "std_srvs", "numpy"} | {
    "example_interfaces",
    "message_filters",
    "rcl_interfaces",
    "rosgraph_msgs",
    "tf2_ros",
}

every_lesson = pytest.mark.parametrize("lesson", lessons(), ids=lambda lesson: lesson.id)
every_robot_lesson = pytest.mark.parametrize("lesson", ROBOT_LESSONS, ids=lambda lesson: lesson.id)
every_server_lesson = pytest.mark.parametrize("lesson", SERVER_LESSONS, ids=lambda lesson: lesson.id)


def tree(lesson: Lesson) -> ast.Module:
    return ast.parse(lesson.node_path.read_text(encoding="utf-8"))


def imported_packages(lesson: Lesson) -> set[str]:
    modules: set[str] = set()
    for node in ast.walk(tree(lesson)):
        if isinstance(node, ast.Import):
            modules.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "a node is started as a script and has no package"
            modules.add(node.module or "")
    return {module.split(".")[0] for module in modules}


def texts(lesson: Lesson) -> set[str]:
    """Return the node's string constants; an f-string counts as the texts between its fields."""
    return {
        node.value
        for node in ast.walk(tree(lesson))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }


def functions(lesson: Lesson) -> dict[str, ast.FunctionDef]:
    return {node.name: node for node in ast.walk(tree(lesson)) if isinstance(node, ast.FunctionDef)}


def calls(lesson: Lesson) -> set[str]:
    return {ast.unparse(node.func) for node in ast.walk(tree(lesson)) if isinstance(node, ast.Call)}


@every_lesson
def test_a_node_imports_only_what_a_ros_2_machine_has(lesson: Lesson) -> None:
    assert imported_packages(lesson) <= ROS_PACKAGES | set(sys.stdlib_module_names)


@every_lesson
def test_a_node_fits_an_80_column_pane(lesson: Lesson) -> None:
    long = [line for line in lesson.node_path.read_text(encoding="utf-8").splitlines() if len(line) > 79]
    assert long == []


@every_lesson
def test_the_functions_of_a_node_fit_on_a_screen(lesson: Lesson) -> None:
    lengths = {name: (node.end_lineno or 0) - node.lineno + 1 for name, node in functions(lesson).items()}
    assert {name for name, length in lengths.items() if length > 32} == set()


@every_lesson
def test_a_node_starts_as_ros_2_starts_it(lesson: Lesson) -> None:
    arguments = functions(lesson)["main"].args
    assert [argument.arg for argument in arguments.args] == ["args"]
    assert [ast.unparse(default) for default in arguments.defaults] == ["None"]


@every_lesson
def test_a_node_ends_quietly_on_ctrl_c(lesson: Lesson) -> None:
    spinning = functions(lesson).get("spin", functions(lesson)["main"])
    caught = [
        ast.unparse(node.type)
        for node in ast.walk(spinning)
        if isinstance(node, ast.ExceptHandler) and node.type
    ]
    assert caught == ["(KeyboardInterrupt, ExternalShutdownException)"]
    assert "rclpy.try_shutdown" in calls(lesson)


@every_lesson
def test_a_node_never_swallows_an_error(lesson: Lesson) -> None:
    handlers = [node for node in ast.walk(tree(lesson)) if isinstance(node, ast.ExceptHandler)]
    assert all(handler.type is not None for handler in handlers)
    assert not {"Exception", "BaseException"} & {
        ast.unparse(handler.type) for handler in handlers if handler.type
    }


@every_robot_lesson
def test_the_robot_node_has_the_courses_names_and_log_lines(lesson: Lesson) -> None:
    assert {"odom_callback", "scan_callback", "timer_callback"} <= set(functions(lesson))
    assert {
        "sub_node",
        "cmd_vel",
        "odom",
        "scan",
        "Odom CallBack",
        "Scan CallBack",
        "Timer CallBack",
        ">>>>>>>>>RANGES Value=",
        "STOP ROTATE",
        "MOVE STRAIGHT",
        "Rotating for ",
        "SLEEPING==",
        " seconds",
    } <= texts(lesson)


def test_the_robot_nodes_differ_only_in_groups_executor_and_words() -> None:
    """A learner who compares two lessons should find the difference that the lesson is about."""

    def behaviour(lesson: Lesson) -> dict[str, str]:
        same = functions(lesson)
        del same["__init__"], same["main"]
        return {name: ast.unparse(node) for name, node in same.items()}

    first, *others = ROBOT_LESSONS
    assert all(behaviour(other) == behaviour(first) for other in others)


@pytest.mark.parametrize(
    ("lesson_id", "groups", "executors"),
    [
        ("single-thread", 0, {"rclpy.spin"}),
        ("shared-group", 1, {"SingleThreadedExecutor", "executor.spin"}),
        ("split-groups", 3, {"MultiThreadedExecutor", "executor.spin"}),
    ],
)
def test_a_robot_node_has_the_groups_and_the_executor_of_its_lesson(
    lesson_id: str, groups: int, executors: set[str]
) -> None:
    lesson = find(lesson_id)
    created = [ast.unparse(node.func) for node in ast.walk(tree(lesson)) if isinstance(node, ast.Call)]
    assert created.count("MutuallyExclusiveCallbackGroup") == groups
    spinning = {name for name in created if name.endswith(("Executor", ".spin"))}
    assert spinning == executors


@every_server_lesson
def test_the_server_node_has_the_courses_names_and_log_lines(lesson: Lesson) -> None:
    assert {"SetBool_callback", "timer_callback"} <= set(functions(lesson))
    assert {
        "service_start_turn",
        "/dummy_server_srv",
        "cmd_vel",
        "Setting ",
        " Groups",
        "ReentrantCallbackGroup Set",
        "MutuallyExclusiveCallbackGroup Set",
        "NO GROUPS SET Set",
        "DummyServer Started with threads=",
        "TICK",
        "TACK",
        "Processing Server Message...",
        "...",
        "[WAITING...]",
        "Processing Server Message...DONE",
        "TURNING",
    } <= texts(lesson)


@every_server_lesson
def test_the_server_node_knows_the_arguments_its_lesson_gives(lesson: Lesson) -> None:
    given = lesson.arguments_with(None)
    assert set(given[::2]) == {"-service_wait_time", "-timer_period", "-callback_group_type", "-threads"}
    assert set(given[::2]) <= texts(lesson)


@pytest.mark.parametrize(
    ("lesson_id", "group_type", "threads"),
    [
        ("exclusive-2-threads", "exclusive", "2"),
        ("reentrant-2-threads", "reentrant", "2"),
        ("reentrant-1-thread", "reentrant", "1"),
        ("no-groups-at-all", "none", "2"),
    ],
)
def test_a_server_lesson_is_set_up_as_its_name_says(lesson_id: str, group_type: str, threads: str) -> None:
    words = find(lesson_id).arguments_with(None)
    setup = dict(zip(words[::2], words[1::2], strict=True))
    assert setup == {
        "-service_wait_time": "5.0",
        "-timer_period": "1.0",
        "-callback_group_type": group_type,
        "-threads": threads,
    }


def test_the_server_lessons_run_one_and_the_same_node() -> None:
    assert len({lesson.node_path for lesson in SERVER_LESSONS}) == 1


@every_robot_lesson
def test_a_robot_lesson_calls_the_motors(lesson: Lesson) -> None:
    assert (lesson.service.name, lesson.service.type) == ("/motor_power", "std_srvs/srv/SetBool")
    assert lesson.setup.threads_argument is None


@every_server_lesson
def test_a_server_lesson_calls_the_server(lesson: Lesson) -> None:
    assert (lesson.service.name, lesson.service.type) == ("/dummy_server_srv", "std_srvs/srv/SetBool")
    assert lesson.setup.threads_argument == "-threads"
