"""To open, list or describe a thing runs nothing of it, and writes nothing but what was asked for."""

import pickle
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

from cbtui import cli
from cbtui.app import CbtuiApp
from cbtui.keys.config import read_file
from cbtui.learning.preview import CannotPreviewError, PreviewRun
from cbtui.runs.live.replay import of_recording
from cbtui.runs.setup.own_files import entry_for
from cbtui.runs.setup.recent import RecentEntry, RecentKind, RecentList
from lessons import catalogue
from lessons.catalogue import find, lessons
from lessons.lesson import BadLesson
from lessons.progress import Progress
from sim.files.plain_yaml import YamlError, load
from sim.packages import PackageError, find_packages
from sim.recording import Recording, RecordingError, RecordingMetadata, RecordingWriter, read
from sim.ros.context.arguments import ArgumentsError, parse_arguments
from sim.ros.parameters.yaml_files import ParameterYamlError, read_nodes
from tests.lessons.test_other_places import announce
from tests.safety import hostile
from tests.shell.test_completion import completed
from tests.support.console import WIDE, settle
from tests.support.fake_session import FakeEngines
from tests.support.runs import shared_group_run

Trap = str
"""Python that leaves a mark when it is run."""


class Marks:
    """Where traps leave their marks."""

    def __init__(self, path: Path) -> None:
        self._path = path

    @property
    def trap(self) -> Trap:
        return f"import pathlib\npathlib.Path({str(self._path)!r}).touch()\n"

    @property
    def pickle(self) -> bytes:
        return pickle.dumps(_Touches(str(self._path)))

    @property
    def yaml(self) -> str:
        return f"!!python/object/apply:os.mkdir [{str(self._path)!r}]"

    def none_left(self) -> bool:
        return not self._path.exists()


class _Touches:
    def __init__(self, path: str) -> None:
        self._path = path

    def __reduce__(self) -> tuple[Callable[[str], Path], tuple[str]]:
        return _touch, (self._path,)


def _touch(path: str) -> Path:
    Path(path).touch()
    return Path(path)


@pytest.fixture
def marks(tmp_path_factory: pytest.TempPathFactory) -> Marks:
    return Marks(tmp_path_factory.mktemp("marks") / "mark")


@pytest.fixture(autouse=True)
def nobodys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for kind in ("CONFIG", "DATA", "STATE", "CACHE"):
        monkeypatch.setenv(f"XDG_{kind}_HOME", str(tmp_path / "home" / kind))
    monkeypatch.chdir(tmp_path)


def test_the_traps_do_leave_marks(marks: Marks) -> None:
    exec(marks.trap)
    assert not marks.none_left()


def test_a_pickled_trap_does_leave_a_mark(marks: Marks) -> None:
    pickle.loads(marks.pickle)
    assert not marks.none_left()


# lessons of others


@pytest.fixture
def bad_lesson(tmp_path: Path, marks: Marks, monkeypatch: pytest.MonkeyPatch) -> Path:
    place = hostile.lesson(tmp_path / "theirs", marks.trap)
    monkeypatch.setenv("CBTUI_LESSONS", str(place.parent))
    return place


@pytest.mark.parametrize(
    "words", [["list"], ["start", "bad-lesson"], ["reset", "bad-lesson"], ["run", "no-lesson"], ["keys"]]
)
def test_to_list_or_begin_a_foreign_lesson_runs_nothing_of_it(
    bad_lesson: Path, marks: Marks, words: list[str]
) -> None:
    try:
        cli.main(words)
    except SystemExit:
        assert words == ["run", "no-lesson"]
    assert marks.none_left()


def test_a_description_and_its_texts_are_read_and_nothing_is_run(bad_lesson: Path, marks: Marks) -> None:
    lesson = find("bad-lesson")
    assert lesson.guide
    assert lesson.explanation
    assert marks.none_left()


async def test_the_menu_shows_a_foreign_lesson_and_runs_it_only_when_it_is_opened(
    bad_lesson: Path, marks: Marks, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cbtui.screens.parts.previews.HOVER_DELAY", 0.001)
    engines = FakeEngines(shared_group_run().events, 0)
    app = CbtuiApp(open_session=engines)
    app.animation_level = "none"
    async with app.run_test(size=WIDE) as pilot:
        await pilot.press("end")
        await settle(pilot)
        await pilot.pause(0.1)
        assert "bad-lesson" not in {session.setup.title for session in engines.sessions}
    assert marks.none_left()


def test_a_foreign_lesson_is_not_run_for_its_picture(bad_lesson: Path) -> None:
    with pytest.raises(CannotPreviewError, match="somebody else"):
        PreviewRun(find("bad-lesson"), FakeEngines([], 0)).run()


@pytest.mark.parametrize("value", ["trap_pkg", "trap_pkg.inner", "trap_pkg.inner.deep"])
def test_packages_that_announce_lessons_are_looked_into_and_not_imported(
    tmp_path: Path, marks: Marks, monkeypatch: pytest.MonkeyPatch, value: str
) -> None:
    place = tmp_path.joinpath(*value.split("."))
    hostile.lesson(place, marks.trap)
    for folder in (tmp_path / "trap_pkg", tmp_path / "trap_pkg/inner", tmp_path / "trap_pkg/inner/deep"):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "__init__.py").write_text(marks.trap)
    announce(monkeypatch, tmp_path, value)
    assert lessons()[-1].folder == place / "bad-lesson"
    assert marks.none_left()


@pytest.mark.parametrize("file", ["../../x.py", "/etc/passwd.py", "sub/x.py", "..\\x.py"])
def test_a_lesson_names_no_file_outside_of_its_folder(bad_lesson: Path, file: str) -> None:
    path = bad_lesson / "lesson.toml"
    path.write_text(path.read_text(encoding="utf-8").replace('"node.py"', repr(file)), encoding="utf-8")
    with pytest.raises(BadLesson):
        catalogue.lessons_in(bad_lesson)


# recordings


@pytest.fixture
def recording(tmp_path: Path, marks: Marks) -> Path:
    """A recording whose sources and set-up are traps, with paths that lead out of its folder."""
    theirs = tmp_path / "elsewhere" / "x.py"
    theirs.parent.mkdir()
    theirs.write_text(marks.trap)
    path = tmp_path / "here" / "run.mcap"
    path.parent.mkdir()
    setup = '{"title":"x","programs":[{"path":"../elsewhere/x.py","arguments":[]}],"clock":"virtual"}'
    recorder = RecordingWriter(
        path, RecordingMetadata(title="../../x", programs=("../elsewhere/x.py", str(theirs)), setup=setup)
    )
    for name in (str(theirs), "../../x", "/../x"):
        recorder._attach(name, marks.trap.encode())
    recorder.take(shared_group_run().events)
    recorder.close()
    return path


@pytest.mark.parametrize(
    "words",
    [
        ["info"],
        ["replay"],
        ["compare", "--text", "{}"],
        ["export", "--svg", "out"],
        ["export", "--csv", "out"],
    ],
)
def test_a_recording_is_read_and_nothing_in_it_is_run_or_written_elsewhere(
    recording: Path, marks: Marks, tmp_path: Path, words: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(recording.parent)
    before = set(tmp_path.rglob("*"))
    command, *others = (word.format(recording) for word in words)
    try:
        cli.main([command, str(recording), *others])
    except SystemExit:
        assert command == "replay"
    assert marks.none_left()
    assert set(tmp_path.rglob("*")) - before <= {recording.parent / "out"}


@pytest.mark.slow
async def test_a_recording_in_the_console_is_shown_and_nothing_in_it_is_run(
    recording: Path, marks: Marks
) -> None:
    app = CbtuiApp(start_recording=read(recording))
    app.animation_level = "none"
    async with app.run_test(size=WIDE) as pilot:
        for key in ("space", "3", "6"):
            await pilot.press(key)
            await settle(pilot)
    assert marks.none_left()


@pytest.mark.parametrize("path", ["/etc/passwd", "/proc/self/environ", "a\0b.py", "/dev/zero"])
def test_a_recording_cannot_have_any_file_of_this_machine_shown(tmp_path: Path, path: str) -> None:
    assert "holds no source" in str(of_recording(naming(path, tmp_path)).source)


def naming(program: str, folder: Path) -> Recording:
    """A recording that names a program and does not hold it."""
    RecordingWriter(folder / "run.mcap", RecordingMetadata(title="run")).close()
    opened = read(folder / "run.mcap")
    opened.about = RecordingMetadata(programs=(program,))
    return opened


def test_a_program_that_is_too_long_to_be_one_is_not_read(tmp_path: Path) -> None:
    huge = tmp_path / "huge.py"
    with huge.open("wb") as file:
        file.truncate(1 << 40)  # takes no room
    assert "holds no source" in str(of_recording(naming(str(huge), tmp_path)).source)


# files


def test_files_that_are_pickles_are_refused_and_not_unpacked(tmp_path: Path, marks: Marks) -> None:
    path = tmp_path / "bad"
    path.write_bytes(marks.pickle)
    assert read_file(path).complaints
    with pytest.raises(RecordingError):
        read(path)
    assert Progress(path).troubles()
    path.write_bytes(marks.pickle)
    assert RecentList(path).entries == ()
    path.write_bytes(marks.pickle)
    with pytest.raises(ArgumentsError):
        parse_arguments(["--ros-args", "--params-file", str(path)])
    assert marks.none_left()


def test_yaml_that_names_python_makes_none(marks: Marks) -> None:
    with pytest.raises(YamlError):
        load(marks.yaml)
    with pytest.raises(ParameterYamlError):
        read_nodes(f"/**:\n  ros__parameters:\n    a: {{b: {marks.yaml}, c: [[]]}}\n")
    read_nodes(f"/**:\n  ros__parameters:\n    a: {marks.yaml}\n")
    assert marks.none_left()


async def test_own_files_are_listed_and_looked_at_without_being_run(tmp_path: Path, marks: Marks) -> None:
    program = tmp_path / "trap.py"
    program.write_text(marks.trap)
    recents = RecentList()
    recents.note(entry_for(str(program), 0))
    recents.note(RecentEntry(RecentKind.RECORDING, str(tmp_path / "none.mcap"), 0))
    app = CbtuiApp(open_session=FakeEngines([], 0))
    app.animation_level = "none"
    async with app.run_test(size=WIDE) as pilot:
        await pilot.press("end", "up", "down")
        await settle(pilot)
    assert marks.none_left()


# packages


@pytest.fixture
def workspace(tmp_path: Path, marks: Marks) -> Path:
    root = tmp_path / "src" / "my_pkg"
    setup = (
        "from setuptools import setup\nsetup(name='my_pkg', data_files=[('share/my_pkg/launch', "
        "['launch/a.launch.py'])], entry_points={'console_scripts': ['a = my_pkg.a:main']})\n"
    )
    files = {
        "package.xml": "<package><name>my_pkg</name></package>",
        "setup.py": marks.trap + setup,
        "launch/a.launch.py": marks.trap,
        "my_pkg/__init__.py": marks.trap,
        "my_pkg/a.py": marks.trap,
    }
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return tmp_path / "src"


def test_completion_looks_into_packages_and_runs_none(workspace: Path, marks: Marks) -> None:
    packages = find_packages(workspace)
    assert completed("run my_pkg ", packages) == ["a"]
    assert completed("launch my_pkg ", packages) == ["a.launch.py"]
    assert completed("launch my_pkg a.launch.py ", packages) == []
    assert completed("launch ", packages) == ["my_pkg"]
    packages.close()
    assert marks.none_left()


@pytest.mark.parametrize("name", ["../../evil", "a/b", "/abs", "..", "a b"])
def test_a_package_is_not_called_like_a_path(workspace: Path, name: str) -> None:
    (workspace / "my_pkg" / "package.xml").write_text(f"<package><name>{name}</name></package>")
    found = find_packages(workspace)
    assert found.names == []
    assert any("is no name of a package" in note for note in found.notes)


def test_what_a_package_installs_stays_in_its_share_folder(workspace: Path, tmp_path: Path) -> None:
    (workspace / "my_pkg" / "setup.py").write_text(
        "from setuptools import setup\nsetup(name='my_pkg', data_files=["
        f"('share/my_pkg/../../../../../../{tmp_path}/out', ['package.xml']), "
        "('share/my_pkg', ['package.xml'])])\n"
    )
    packages = find_packages(workspace)
    share = packages.package("my_pkg").share
    assert [path.name for path in share.rglob("*")] == ["package.xml"]
    assert not (tmp_path / "out").exists()
    packages.close()


@pytest.mark.parametrize(
    "statement",
    [
        "a = 'x' * 9\n" + "a = a + a\n" * 60,
        "a = '%999999999d' % 1",
        "a = '%*d' % (999999999, 1)",
        "a = '{:>999999999}'.format(1)",
        "a = '{:>{}}'.format(1, 999999999)",
        "a = [1]\n" + "a = [*a, *a]\n" * 60,
        "from glob import glob\na = glob('/**', recursive=True)",
        "from glob import glob\na = glob('../../**', recursive=True)",
        "a = " + "(" * 5000 + ")" * 5000,
        "a = " + "-" * 5000 + "1",
        "a = " + "-" * 1000 + "1",
    ],
)
def test_a_setup_file_that_wants_much_is_refused(workspace: Path, statement: str) -> None:
    path = workspace / "my_pkg" / "setup.py"
    path.write_text(f"from setuptools import setup\n{statement}\nsetup(name='my_pkg', scripts=[a])\n")
    package = find_packages(workspace).package("my_pkg")
    with pytest.raises(PackageError) as refused:
        _ = package.executables
    assert "\n" not in str(refused.value)


# what is written


def test_a_run_is_not_readable_by_way_of_a_link_in_the_runtime_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from cbtui.engines.control_socket import runtime_folder

    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    folder = runtime_folder()
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    folder.rmdir()
    folder.symlink_to(tmp_path)
    with pytest.raises(OSError, match="is not a folder"):
        runtime_folder()
