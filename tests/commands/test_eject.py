"""Lessons taken home: packages that ROS 2 accepts, with the lessons' own nodes, and no file lost."""

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree

import pytest
from msgspec import structs

from cbtui import cli
from cbtui.eject.ament_package import AmentPackage, LessonProgram
from cbtui.eject.eject import CourseUnit, EjectError, chosen, package_of, units_of
from lessons.catalogue import find, lessons, lessons_in
from lessons.lesson import Lesson
from sim.launch import LaunchRun
from sim.packages import Package, find_packages
from tests.launch.fakes import FakeMachine

UNITS = units_of(lessons())
NODE = b"import rclpy\n\n\ndef main():\n    pass\n"


@pytest.fixture(scope="module")
def ejected(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("workspace") / "src"
    assert cli.main(["eject", str(folder)]) == 0
    return folder


def _package(folder: Path, unit: CourseUnit) -> Package:
    return find_packages(folder).package(unit.package)


def _arguments(launch_file: Path, *given: str) -> list[str]:
    machine = FakeMachine()
    LaunchRun(launch_file, given, machine).start()
    words = list(machine.spec().arguments)
    return words[: words.index("--ros-args")] if "--ros-args" in words else words


def _program(name: str = "node", source: bytes = NODE, arguments: tuple[str, ...] = ()) -> LessonProgram:
    return LessonProgram(name=name, title="A node", teaches="So.", source=source, arguments=arguments)


def _made(folder: Path, *programs: LessonProgram) -> Path:
    """A package of these programs, written into the folder."""
    root = folder / "made_pkg"
    for place, content in AmentPackage(name="made_pkg", title="Made", programs=programs).files().items():
        (root / place).parent.mkdir(parents=True, exist_ok=True)
        (root / place).write_bytes(content)
    return root


def _lesson_in(folder: Path, source: bytes) -> Lesson:
    (folder / "node.py").write_bytes(source)
    return structs.replace(find("single-thread"), folder=folder)


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.package)
def test_every_lesson_is_an_executable_with_its_own_node_word_for_word(
    ejected: Path, unit: CourseUnit
) -> None:
    package = _package(ejected, unit)
    for lesson in unit.lessons:
        executable = package.executable(lesson.id.replace("-", "_"))
        assert executable.path.read_bytes() == lesson.node_path.read_bytes()
        assert executable.function == "main"
        assert executable.path.is_relative_to(ejected)
        if lesson.solution_path is not None:
            solution = package.executable(f"{lesson.id.replace('-', '_')}_solution")
            assert solution.path.read_bytes() == lesson.solution_path.read_bytes()


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.package)
def test_every_lesson_has_a_launch_file_that_gives_it_its_arguments(ejected: Path, unit: CourseUnit) -> None:
    package = _package(ejected, unit)
    for lesson in unit.lessons:
        launch_file = package.launch_file(f"{lesson.id.replace('-', '_')}.launch.py")
        assert _arguments(launch_file) == list(lesson.setup.arguments)


def test_a_launch_file_takes_another_value_for_an_argument(ejected: Path) -> None:
    package = _package(ejected, chosen(UNITS, ["5"])[0])
    words = _arguments(package.launch_file("exclusive_2_threads.launch.py"), "threads:=3")
    assert words[words.index("-threads") + 1] == "3"
    assert words[words.index("-callback_group_type") + 1] == "exclusive"


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.package)
def test_lines_for_the_packages_beside_the_lessons_mean_the_same_at_home(
    ejected: Path, unit: CourseUnit
) -> None:
    package = _package(ejected, unit)
    for folder in {lesson.folder.parent / unit.package for lesson in unit.lessons}:
        beside = Package(unit.package, folder)
        if not folder.is_dir():
            continue
        for name in beside.executables:
            assert package.executable(name).path.read_bytes() == beside.executable(name).path.read_bytes()
        for name in beside.launch_files:
            assert package.launch_file(name).read_bytes() == beside.launch_file(name).read_bytes()


def test_a_package_beside_lessons_may_hold_links_to_their_nodes_or_copies(tmp_path: Path) -> None:
    unit = chosen(UNITS, ["5"])[0]
    shutil.copytree(unit.lessons[0].folder.parent, tmp_path / "unit5")
    (copied,) = units_of(lessons_in(tmp_path / "unit5"))
    names = {name: program.name for name, program in package_of(copied).also.items()}
    assert names == {name: program.name for name, program in package_of(unit).also.items()}
    assert names["exercise51"] == "single_thread"


def test_an_executable_beside_lessons_that_is_no_lesson_is_named(tmp_path: Path) -> None:
    shutil.copytree(chosen(UNITS, ["5"])[0].lessons[0].folder.parent, tmp_path / "unit5")
    path = tmp_path / "unit5" / "unit5_pkg" / "unit5_pkg" / "exercise52.py"
    path.write_text("def main():\n    pass\n")
    (unit,) = units_of(lessons_in(tmp_path / "unit5"))
    with pytest.raises(EjectError, match=r"exercise52\.py is the node of no lesson"):
        package_of(unit)


@pytest.mark.parametrize("unit", UNITS, ids=lambda unit: unit.package)
def test_a_package_has_all_that_colcon_and_the_ament_index_look_for(ejected: Path, unit: CourseUnit) -> None:
    root = _package(ejected, unit).root
    assert re.fullmatch(r"[a-z](_?[a-z0-9]+)*", root.name)
    manifest = ElementTree.fromstring((root / "package.xml").read_bytes())
    assert (manifest.get("format"), manifest.findtext("name")) == ("3", root.name)
    assert manifest.findtext("export/build_type") == "ament_python"
    assert manifest.findtext("description")
    assert (root / "resource" / root.name).read_bytes() == b""
    assert (root / root.name / "__init__.py").is_file()
    assert f"$base/lib/{root.name}\n" in (root / "setup.cfg").read_text()
    assert PurePosixPath("package.xml") in _package(ejected, unit).share_files
    for path in root.rglob("*.py"):
        ast.parse(path.read_bytes())


def test_the_readme_names_every_executable(ejected: Path) -> None:
    for unit in UNITS:
        package = _package(ejected, unit)
        readme = (package.root / "README.md").read_text()
        assert [name for name in package.executables if f"`{name}`" not in readme] == []
        assert "$" not in readme


@pytest.mark.slow
def test_an_ejected_launch_file_runs_in_the_console_as_it_is(ejected: Path) -> None:
    launch_file = ejected / "unit5_pkg" / "launch" / "exclusive_2_threads.launch.py"
    command = [sys.executable, "-m", "cbtui", "run", str(launch_file), "--clock", "virtual", "--for", "3"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "DummyServer Started with threads=2" in done.stderr


@pytest.mark.slow
def test_ros2_lines_typed_in_the_ejected_folder_find_its_programs(ejected: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "cbtui", "ros2", "pkg", "executables", "unit5_pkg"]
    done = subprocess.run(
        command,
        cwd=ejected / "unit5_pkg",
        env={**os.environ, "XDG_RUNTIME_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "unit5_pkg single_thread\n" in done.stdout
    assert "unit5_pkg exercise51\n" in done.stdout


def test_dependencies_are_what_nodes_and_launch_files_import_and_not_python_itself(tmp_path: Path) -> None:
    source = (
        b"import math, rclpy.node\nfrom std_srvs.srv import SetBool\nfrom .other import some\n"
        b"def main():\n    import numpy as np\n    from tf2_ros import Buffer\n"
    )
    manifest = ElementTree.parse(_made(tmp_path, _program(source=source)) / "package.xml")
    assert [each.text for each in manifest.iterfind("exec_depend")] == [
        "launch",
        "launch_ros",
        "python3-numpy",
        "rclpy",
        "ros2launch",
        "std_srvs",
        "tf2_ros_py",
    ]


@pytest.mark.parametrize(
    ("words", "given", "expected"),
    [
        (("--speed", "-1.5", "file name"), ("speed:=2",), ["--speed", "2", "file name"]),
        (("--verbose", "--top-speed", "3"), ("top_speed:=4",), ["--verbose", "--top-speed", "4"]),
        (("-n", "1", "-n", "2"), ("n:=3",), ["-n", "3", "-n", "2"]),
        (('say "hello"\\n', "$(x)", "  two  "), (), ['say "hello"\\n', "$(x)", "  two  "]),
    ],
)
def test_values_behind_options_become_launch_arguments_and_other_words_stay(
    tmp_path: Path, words: tuple[str, ...], given: tuple[str, ...], expected: list[str]
) -> None:
    root = _made(tmp_path, _program(arguments=words))
    assert _arguments(root / "launch" / "node.launch.py") == list(words)
    assert _arguments(root / "launch" / "node.launch.py", *given) == expected


def test_arguments_for_ros_itself_are_no_launch_arguments(tmp_path: Path) -> None:
    words = ("--ros-args", "-p", "speed:=1.0")
    root = _made(tmp_path, _program(arguments=words))
    text = (root / "launch" / "node.launch.py").read_text()
    assert "DeclareLaunchArgument" not in text
    assert all(f'"{word}"' in text for word in words)


@pytest.mark.parametrize("name", ["class", "2_threads"])
def test_an_executable_whose_name_cannot_be_imported_gets_a_module_that_can(
    tmp_path: Path, name: str
) -> None:
    root = _made(tmp_path, _program(name))
    executable = find_packages(root).package("made_pkg").executable(name)
    assert executable.module == f"made_pkg.lesson_{name}"
    assert executable.path.read_bytes() == NODE


def test_units_go_by_their_number_and_become_valid_names() -> None:
    lesson = find("single-thread")
    names = ["5 Threads & groups", "5 The same unit", "6b More", "Über die 2. Sache", "3"]
    units = units_of(structs.replace(lesson, unit=name) for name in names)
    assert [(unit.number, unit.package) for unit in units] == [
        ("5", "unit5_pkg"),
        ("6b", "unit6b_pkg"),
        ("", "ber_die_2_sache_pkg"),
        ("", "unit_3_pkg"),
    ]
    assert units[0].title == "Threads & groups"
    assert len(units[0].lessons) == 2
    assert chosen(units, ["unit_3_pkg", "5"]) == [units[0], units[3]]
    assert chosen(units, []) == units


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        (b"def main(:\n", "is not Python: invalid syntax"),
        (b"\0", "is not Python"),
        (b"import rclpy\nrclpy.init()\n", "has no function main()"),
        (b"import helper\ndef main():\n    pass\n", "imports helper from its own folder"),
    ],
)
def test_a_node_that_a_package_cannot_hold_is_named(tmp_path: Path, source: bytes, sentence: str) -> None:
    (tmp_path / "helper.py").touch()
    lesson = _lesson_in(tmp_path, source)
    with pytest.raises(EjectError) as caught:
        package_of(units_of([lesson])[0])
    assert str(caught.value).startswith(f"{tmp_path / 'node.py'} ")
    assert sentence in str(caught.value)


def test_a_node_that_is_gone_is_named(tmp_path: Path) -> None:
    lesson = structs.replace(find("single-thread"), folder=tmp_path)
    with pytest.raises(EjectError, match=r"node\.py cannot be read: No such file or directory"):
        package_of(units_of([lesson])[0])


def test_a_second_time_writes_nothing_and_is_well(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["eject", str(tmp_path), "--unit", "5"]) == 0
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")}
    assert cli.main(["eject", str(tmp_path), "--unit", "5"]) == 0
    assert "0 files written" in capsys.readouterr().out
    assert {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*")} == before


def test_only_the_unit_that_is_asked_for_is_written(tmp_path: Path) -> None:
    assert cli.main(["eject", str(tmp_path), "--unit", "5"]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["unit5_pkg"]


def test_a_changed_file_is_named_and_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    changed = tmp_path / "unit5_pkg" / "unit5_pkg" / "shared_group.py"
    changed.parent.mkdir(parents=True)
    changed.write_text("mine")
    assert cli.main(["eject", str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"cbtui: {changed} is there with other content; --force replaces it\n"
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [changed]
    assert changed.read_text() == "mine"


def test_several_changed_files_are_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root = tmp_path / "unit5_pkg"
    (root / "launch").mkdir(parents=True)
    (root / "package.xml").touch()
    (root / "launch" / "single_thread.launch.py").symlink_to("nowhere")
    assert cli.main(["eject", str(tmp_path)]) == 2
    assert "package.xml and 1 other file are there with other content" in capsys.readouterr().err


def test_force_replaces_changed_files_and_links_but_not_what_links_lead_to(tmp_path: Path) -> None:
    mine = tmp_path / "mine.py"
    mine.write_text("mine")
    folder = tmp_path / "unit5_pkg" / "unit5_pkg"
    folder.mkdir(parents=True)
    (folder / "single_thread.py").symlink_to(mine)
    (folder / "shared_group.py").write_text("changed")
    (folder / "notes.txt").write_text("kept")
    assert cli.main(["eject", str(tmp_path), "--unit", "5", "--force"]) == 0
    for lesson in ("single-thread", "shared-group"):
        path = folder / f"{lesson.replace('-', '_')}.py"
        assert not path.is_symlink()
        assert path.read_bytes() == find(lesson).node_path.read_bytes()
    assert mine.read_text() == "mine"
    assert (folder / "notes.txt").read_text() == "kept"
    assert [path.name for path in folder.iterdir() if path.name.startswith(".")] == []


def test_force_does_not_remove_a_folder_that_is_in_the_way(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    in_the_way = tmp_path / "unit5_pkg" / "setup.py"
    in_the_way.mkdir(parents=True)
    assert cli.main(["eject", str(tmp_path), "--unit", "5", "--force"]) == 2
    assert capsys.readouterr().err == f"cbtui: cannot write {in_the_way}: Is a directory\n"
    assert not list(tmp_path.rglob(".*.part"))


@pytest.mark.parametrize(
    ("folder", "options", "sentence"),
    [
        ("file", [], r"file is a file; name a folder for the packages"),
        ("file/below", [], r"cannot write .*/file/below/unit\w+: Not a directory"),
        ("/proc/nowhere", [], r"cannot write /proc/nowhere.*: "),
        ("x" * 300, [], r"cannot write x*: File name too long"),
        ("new", ["--unit", "99"], r"there is no unit 99; there are: 5"),
    ],
)
def test_a_wrong_command_is_refused_in_one_sentence(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    folder: str,
    options: list[str],
    sentence: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    place = folder if len(folder) == 300 else str(tmp_path / folder)
    assert cli.main(["eject", place, *options]) == 2
    said = capsys.readouterr()
    assert re.fullmatch(rf"cbtui: (\S*/)?{sentence}.*\n", said.err)
    assert said.out == ""
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
