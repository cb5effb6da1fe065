"""Launch files: what they start, in which order, with which arguments, and how it ends."""

from pathlib import Path

import pytest

from sim.launch import LaunchError, LaunchRun, describe_arguments
from sim.ros.context.arguments import parse_arguments
from tests.launch.fakes import HEAD_LINES, FakeMachine, launch, make_package


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return make_package(tmp_path)


def test_a_course_launch_file_starts_its_node_and_tells_of_its_end(root: Path) -> None:
    file = root / "launch" / "exercise51.launch.py"
    file.write_text(
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n"
        "def generate_launch_description():\n    return LaunchDescription([\n"
        "        Node(package='unit5_pkg', executable='exercise51', output='screen', emulate_tty=True)\n"
        "    ])\n"
    )
    machine = FakeMachine()
    run = LaunchRun(file, [], machine)
    run.start()
    spec = machine.spec()
    assert (spec.label, spec.module, spec.function, spec.output) == (
        "exercise51-1",
        "unit5_pkg.exercise51",
        "main",
        "screen",
    )
    assert (spec.path, spec.folder) == (root / "unit5_pkg" / "exercise51.py", root)
    assert spec.arguments == ("--ros-args",)
    machine.processes[0].on_exit(0)
    assert run.finished
    assert machine.said == [
        "[INFO] [launch]: Default logging verbosity is set to INFO",
        "[INFO] [exercise51-1]: process started with pid [1]",
        "[INFO] [exercise51-1]: process has finished cleanly [pid 1]",
    ]


def test_a_process_that_fails_is_told_with_its_code_and_command(root: Path) -> None:
    started = launch(root, "return [node(name='n')]")
    started.machine.processes[0].on_exit(1)
    path = root / "unit5_pkg" / "exercise51.py"
    assert started.machine.said[-1] == (
        f"[ERROR] [exercise51-1]: process has died [pid 1, exit code 1, "
        f"cmd '{path} --ros-args -r __node:=n']."
    )
    assert started.run.status == 0


def test_parameters_keep_their_types(root: Path) -> None:
    body = (
        "return [node(parameters=[{'i': 3, 'f': 2.0, 'big': 1e20, 'b': True, "
        "'s': ParameterValue('5', value_type=str),"
        " 'guessed': '5', 'text': 'a: \\\"b', 'l': [1, 2], 'words': ['on', 'x'], 'in': {'side': 1.5}}])]"
    ).replace('a: \\"b', 'hello \\"b')
    arguments = launch(root, body).machine.spec().arguments
    assert parse_arguments(arguments).parameters["/**"] == {
        "i": 3,
        "f": 2.0,
        "big": 1e20,
        "b": True,
        "s": "5",
        "guessed": 5,
        "text": 'hello "b',
        "l": [1, 2],
        "words": ["on", "x"],
        "in.side": 1.5,
    }


def test_names_namespaces_remaps_and_arguments_stand_in_launch_ros_order(root: Path) -> None:
    body = (
        "return [GroupAction([PushRosNamespace('a'), SetRemap('x', 'y'), SetParameter('p', 1),"
        " node(name='n', namespace='b', arguments=['-t', '1'], remappings=[('c', '/d')],"
        " parameters=[PathJoinSubstitution([FindPackageShare('unit5_pkg'), 'config', 'speeds.yaml'])],"
        " ros_arguments=['--log-level', 'debug'])]), node(namespace='/z')]"
    )
    machine = launch(root, body).machine
    first = list(machine.spec().arguments)
    file = first.pop(first.index("--params-file") + 1)
    assert Path(file).read_text().startswith("/**")
    assert " ".join(first) == (
        "-t 1 --ros-args --log-level debug -r __node:=n -r __ns:=/a/b -p p:=1 --params-file -r x:=y -r c:=/d"
    )
    assert machine.spec(1).arguments == ("--ros-args", "-r", "__ns:=/z")


def test_a_managed_node_is_started_like_any_other(root: Path) -> None:
    body = (
        "import launch_ros; return [launch_ros.actions.LifecycleNode("
        "package='unit5_pkg', executable='exercise51', name='n', namespace='')]"
    )
    assert launch(root, body).machine.spec().arguments == ("--ros-args", "-r", "__node:=n")


def test_launch_arguments_reach_conditions_and_expressions(root: Path) -> None:
    body = (
        "n = LaunchConfiguration('n')\n"
        "return [DeclareLaunchArgument('n', default_value='1', choices=['1', '2']),\n"
        " node(name=['r', n], condition=IfCondition(PythonExpression([n, ' > 1']))),\n"
        " node(name='one', condition=UnlessCondition(EqualsSubstitution(n, 2)))]"
    )
    assert "__node:=one" in launch(root, body).machine.spec().arguments
    assert "__node:=r2" in launch(root, body, "n:=2").machine.spec().arguments
    with pytest.raises(LaunchError, match="provided value '3' is not valid"):
        launch(root, body, "n:=3")


def test_a_timer_starts_its_node_later_and_not_after_a_shutdown(root: Path) -> None:
    body = "return [TimerAction(period=2.0, actions=[node()]), TimerAction(period=5.0, actions=[node()])]"
    started = launch(root, body)
    started.machine.pass_time(1.9)
    assert started.machine.processes == []
    started.machine.pass_time(2.0)
    assert len(started.machine.processes) == 1
    started.run.interrupt()
    assert started.run.finished
    started.machine.pass_time(9.0)
    assert len(started.machine.processes) == 1


def test_a_required_process_ends_the_launch(root: Path) -> None:
    started = launch(root, "return [node(on_exit=Shutdown()), node()]")
    started.machine.processes[0].on_exit(0)
    assert started.machine.said[-4:] == [
        "[INFO] [exercise51-1]: process has finished cleanly [pid 1]",
        "[INFO] [launch]: process[exercise51-1] was required: shutting down launched system",
        "[INFO] [exercise51-2]: sending signal 'SIGINT' to process[exercise51-2]",
        "[INFO] [exercise51-2]: process has finished cleanly [pid 2]",
    ]
    assert started.run.finished


def test_a_process_that_does_not_heed_is_terminated_then_killed(root: Path) -> None:
    started = launch(root, "return [node(sigterm_timeout='3')]", stubborn=True)
    started.run.interrupt()
    assert started.machine.said[-1] == "[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)"
    started.machine.pass_time(3.0)
    assert started.machine.processes[0].signals == ["SIGINT", "SIGTERM"]
    started.machine.pass_time(8.0)
    assert started.machine.processes[0].signals[-1] == "SIGKILL"
    assert started.run.finished


def test_a_respawned_process_starts_again_after_its_delay(root: Path) -> None:
    started = launch(root, "return [node(respawn=True, respawn_delay=1.5, respawn_max_retries=1)]")
    started.machine.processes[0].on_exit(2)
    assert not started.run.finished
    started.machine.pass_time(1.5)
    assert started.machine.spec(1).label == "exercise51-1"
    started.machine.processes[1].on_exit(2)
    assert started.run.finished


def test_event_handlers_start_what_follows(root: Path) -> None:
    body = (
        "a = node(name='a')\n"
        "return [a, RegisterEventHandler(OnProcessStart(target_action=a, on_start=[LogInfo(msg='up')])),\n"
        " RegisterEventHandler(OnProcessExit(target_action=a,\n"
        "  on_exit=lambda e, c: [node(name=f'code{e.returncode}')])),\n"
        " RegisterEventHandler(OnShutdown(on_shutdown=[LogInfo(msg='down')]))]"
    )
    started = launch(root, body)
    assert started.machine.said[-1] == "[INFO] [launch.user]: up"
    started.machine.processes[0].on_exit(4)
    assert "__node:=code4" in started.machine.spec(1).arguments
    started.run.interrupt()
    assert "[INFO] [launch.user]: down" in started.machine.said


def test_an_event_handler_hears_what_a_process_prints_and_logs_before_its_end(root: Path) -> None:
    body = (
        "a, b = node(name='a'), node(name='b')\n"
        "told = lambda where: lambda event: LogInfo(msg=f'{where} {event.process_name} {event.text!r}')\n"
        "return [a, b, RegisterEventHandler(OnProcessIO(target_action=b, on_stdout=told('out'),\n"
        "  on_stderr=lambda event: [node(name='next')] if b'ready' in event.text else None)),\n"
        " RegisterEventHandler(OnProcessExit(target_action=b, on_exit=[LogInfo(msg='over')]))]"
    )
    started = launch(root, body)
    first, second = started.machine.processes
    first.on_output("not asked for", False)
    second.on_output("hello", False)
    second.on_output("[INFO] [1.5] [b]: not yet", True)
    second.on_output("[INFO] [1.5] [b]: ready", True)
    assert len(started.machine.processes) == 2
    second.on_exit(0)
    started.machine.pass_time(0.0)
    told = [each for each in started.machine.said if "launch.user" in each]
    assert told == [
        "[INFO] [launch.user]: out exercise51-2 b'hello\\n'",
        "[INFO] [launch.user]: over",
    ]
    assert "__node:=next" in started.machine.spec(2).arguments
    second.on_output("too late", False)
    started.machine.pass_time(1.0)
    assert "too late" not in started.machine.said[-1]


def test_an_included_file_gets_its_arguments(root: Path) -> None:
    (root / "launch" / "inner.launch.py").write_text(
        "from launch import LaunchDescription\nfrom launch.actions import *\n"
        "from launch.substitutions import *\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription(\n"
        "        [DeclareLaunchArgument('who'), LogInfo(msg=LaunchConfiguration('who'))])\n"
    )
    source = "PythonLaunchDescriptionSource([ThisLaunchFileDir(), '/inner.launch.py'])"
    given = f"return [IncludeLaunchDescription({source}, launch_arguments={{'who': 'me'}}.items())]"
    assert launch(root, given).machine.said[-1] == "[INFO] [launch.user]: me"
    with pytest.raises(
        LaunchError, match=rf"test.launch.py:{HEAD_LINES + 1}: .*missing required argument 'who'"
    ):
        launch(root, f"return [IncludeLaunchDescription({source})]")


def test_a_ros2_line_is_handed_to_the_shell_and_other_programs_are_refused(root: Path) -> None:
    line = "return [ExecuteProcess(cmd=[['ros2 topic pub ', '/a ', '\"{x: 1}\"']], shell=True)]"
    assert launch(root, line).machine.processes[0].spec == ("ros2", "topic", "pub", "/a", "{x: 1}")
    with pytest.raises(LaunchError, match="cannot run 'gazebo'"):
        launch(root, "return [ExecuteProcess(cmd=['gazebo'])]")


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        (
            "return [Node(package='nope', executable='x')]",
            "Package 'nope' not found; known packages: unit5_pkg",
        ),
        ("return [Node(package='unit5_pkg', executable='x')]", "No executable found.*exercise51, exercise52"),
        (
            "return [Node(package='unit5_pkg', executable='exercise52')]",
            r"setup.py:20: .*no .*exercise52\.py",
        ),
        (
            "return [Node(package='unit5_pkg', executable='exercise51', parameters=['/no/such.yaml'])]",
            "parameters file /no/such.yaml does not exist",
        ),
        (
            "return [DeclareLaunchArgument('a', description='d')]",
            r"'a' \(description: 'd'\) was not provided",
        ),
        ("return [LogInfo(msg=LaunchConfiguration('q'))]", "launch configuration 'q' does not exist"),
        ("return [ComposableNodeContainer()]", "ComposableNodeContainer is not supported"),
        ("return [get_package_share_directory('nope')]", "Package 'nope' not found"),
        ("return [1 / 0]", "ZeroDivisionError: division by zero"),
        ("return [OpaqueFunction(function=lambda c: [c.nothing])]", "AttributeError"),
        ("return [Node(executable='x', prefix='gdb')]", "prefix"),
    ],
)
def test_what_is_wrong_is_told_with_file_and_line_and_nothing_starts(
    root: Path, body: str, sentence: str
) -> None:
    body = body.replace("return [", "return [node(), ")
    with pytest.raises(LaunchError, match=sentence) as error:
        launch(root, body)
    assert str(error.value).startswith(f"test.launch.py:{HEAD_LINES + 1}: ")


def test_a_file_that_describes_no_launch_is_refused(tmp_path: Path) -> None:
    for text, sentence in (
        ("import nothing_of_the_kind\n", "bad.launch.py:1: No module named"),
        ("x = (\n", "bad.launch.py:1: "),
        ("x = 1\n", "defines no function generate_launch_description"),
        ("def generate_launch_description():\n    return []\n", "must return a LaunchDescription, not list"),
    ):
        (tmp_path / "bad.launch.py").write_text(text)
        with pytest.raises(LaunchError, match=sentence):
            describe_arguments(tmp_path / "bad.launch.py")


def test_declared_arguments_are_shown_as_ros2_launch_does(root: Path) -> None:
    launch(root, "return [DeclareLaunchArgument('speed', default_value='0.5', description='How fast')]")
    assert describe_arguments(root / "launch" / "test.launch.py") == (
        "Arguments (pass arguments as '<name>:=<value>'):\n\n"
        "    'speed':\n        How fast\n        (default: '0.5')"
    )


def test_an_error_in_a_handler_ends_the_launch_and_is_kept(root: Path) -> None:
    started = launch(root, "return [node(on_exit=lambda e, c: 1 / 0), node()]")
    started.machine.processes[0].on_exit(0)
    assert started.machine.processes[1].signals == ["SIGINT"]
    assert started.run.finished
    assert started.run.status == 1
    assert "ZeroDivisionError" in str(started.run.error)


def test_an_interrupt_ends_what_runs_and_what_waits_to_start_again(root: Path) -> None:
    started = launch(root, "return [node(respawn=True, respawn_delay=9.0), node()]")
    first, second = started.machine.processes
    first.on_exit(0)
    started.run.interrupt()
    started.run.interrupt()
    assert second.signals == ["SIGINT"]
    assert started.run.finished
