"""``cbtui doctor``: one line for each thing, and for each fault what to do."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from cbtui import __main__, cli
from cbtui.doctor import engines, extras
from cbtui.doctor.engines import engine
from cbtui.doctor.examination import Examination, Sign, fault, note, well
from cbtui.doctor.extras import browser, editor, grading, ros
from cbtui.doctor.files import configuration, folders, lessons_found, progress
from cbtui.doctor.packages import dependencies, physics, python, system
from cbtui.doctor.probes import ProbeProcess, ProbeResult
from cbtui.doctor.requirements import requirements
from cbtui.doctor.terminal import TerminalFacts, screen
from cbtui.text.installing import install_command
from tests.support.nobody import without_home


@pytest.fixture(autouse=True)
def nobodys_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for kind in ("CONFIG", "STATE"):
        monkeypatch.setenv(f"XDG_{kind}_HOME", str(tmp_path / kind.lower()))


def _doctor(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "cbtui", "doctor", *arguments]
    return subprocess.run(
        command, capture_output=True, text=True, check=False, env={**os.environ, **environment}
    )


@pytest.mark.slow
def test_a_machine_that_has_everything_is_well_and_nothing_is_changed_on_it(tmp_path: Path) -> None:
    done = _doctor(LC_ALL="C.UTF-8")
    assert done.returncode == 0, done.stdout
    assert done.stderr == ""
    assert not [line for line in done.stdout.splitlines() if line.startswith("✗")]
    subjects = [line[2:15].strip() for line in done.stdout.splitlines()]
    assert {"Python", "packages", "physics", "engine", "lessons", "terminal", "config"} < {*subjects}
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_where_pybullet_crashes_the_doctor_lives_and_ends_with_1(tmp_path: Path) -> None:
    (tmp_path / "pybullet.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n")
    done = _doctor("--charset", "ascii", PYTHONPATH=str(tmp_path))
    assert done.returncode == 1
    [line] = [line for line in done.stdout.splitlines() if line.startswith("x")]
    assert "PyBullet" in line
    assert "crashed with SIGSEGV" in line
    assert "pip install" in line
    assert done.stdout.isascii()
    assert done.stdout.endswith("1 thing cbtui needs is not well.\n")


def test_the_exit_code_is_1_only_if_something_is_at_fault(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    verdicts = [well("a", "is"), note("b", "is less", "do this")]
    monkeypatch.setattr("cbtui.doctor.examinations", lambda *_: iter(verdicts))
    assert cli.main(["doctor"]) == 0
    verdicts.append(fault("c", "is not", "do that"))
    assert cli.main(["doctor"]) == 1
    out = capsys.readouterr().out
    assert "b            is less: do this" in out


def installed(folder: Path, *names: str) -> None:
    for name in names:
        about = folder / f"{name.replace('-', '_')}-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")


class _Ended(ProbeProcess):
    """A probe that has ended with a certain outcome."""

    def __init__(self, outcome: ProbeResult) -> None:
        self._outcome = outcome

    def outcome(self) -> ProbeResult:
        return self._outcome


def test_a_package_that_cannot_be_imported_is_named_with_why_and_so_is_one_that_crashes() -> None:
    said = "begin yaml\nbad yaml: ImportError: no libyaml\nbegin numpy\n"
    found = list(dependencies(_Ended(ProbeResult(said, "", -11, "it crashed with SIGSEGV"))))
    assert [each.subject for each in found] == ["numpy", "pyyaml"]
    assert all(each.sign is Sign.FAULT for each in found)
    assert "it crashed with SIGSEGV" in found[0].what
    assert "ImportError: no libyaml" in found[1].what


def test_a_package_that_is_missing_or_too_old_is_told_with_the_command_that_mends_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    needed = (Requirement("rich>=99"), Requirement("no-such-thing>=1"))
    monkeypatch.setattr("cbtui.doctor.packages.requirements", lambda: needed)
    old, missing = dependencies(_Ended(ProbeResult("", "", 0, "")))
    assert "cbtui needs >=99" in old.what
    assert "is not installed" in missing.what
    assert "-m pip install 'no-such-thing>=1'" in missing.remedy


def test_what_cbtui_says_that_it_needs_is_looked_at() -> None:
    assert {"textual", "msgspec", "numpy"} < {each.name for each in requirements()}
    assert "ruff" not in {each.name for each in requirements()}


@pytest.mark.parametrize(
    ("outcome", "installed", "sign", "said"),
    [
        (ProbeResult("", "", 0, ""), True, Sign.WELL, "PyBullet moves the robot"),
        (ProbeResult("", "", 0, ""), False, Sign.NOTE, "the numpy model moves the robot"),
        (ProbeResult("", "broken\n", 1, ""), True, Sign.FAULT, "builds no world (broken)"),
    ],
)
def test_the_physics_that_moves_the_robot_is_told(
    outcome: ProbeResult, installed: bool, sign: Sign, said: str
) -> None:
    found = physics(_Ended(outcome), installed=installed)
    assert found.sign is sign
    assert said in found.what


def test_two_packages_of_one_module_are_told_though_the_robot_moves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed(tmp_path, "pybullet", "pybullet-arm64")
    monkeypatch.syspath_prepend(tmp_path)
    found = physics(_Ended(ProbeResult("", "", 0, "")), installed=True)
    assert found.sign is Sign.NOTE
    assert found.what == "pybullet and pybullet-arm64 are both installed, and have overwritten each other"
    assert found.remedy.startswith("uninstall both, then ")


def test_where_there_is_no_pip_as_in_an_environment_of_uvs_uv_is_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert install_command("rich>=13") == f"{sys.executable} -m pip install 'rich>=13'"
    monkeypatch.setattr("cbtui.text.installing.find_spec", lambda _: None)
    assert install_command("rich>=13") == f"uv pip install --python {sys.executable} 'rich>=13'"


@pytest.mark.parametrize(
    ("platform", "release", "sign", "said"),
    [
        ("linux", "6.8.0-45-generic", Sign.WELL, "Linux 6.8.0-45-generic"),
        ("linux", "5.15.153.1-microsoft-standard-WSL2", Sign.WELL, "in WSL"),
        ("darwin", "24.1.0", Sign.NOTE, "untested"),
        ("win32", "10", Sign.FAULT, "no run starts"),
    ],
)
def test_the_system_is_told_and_whether_runs_are_known_to_work_there(
    platform: str, release: str, sign: Sign, said: str
) -> None:
    found = system(platform, release)
    assert found.sign is sign
    assert said in found.what


def test_on_windows_every_command_ends_with_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "win32")
    with pytest.raises(SystemExit, match="use WSL"):
        __main__.command()


def test_an_old_python_is_at_fault() -> None:
    assert python((3, 10, 4)).sign is Sign.FAULT
    assert python((3, 13, 0)).sign is Sign.WELL


def test_an_engine_that_cannot_be_started_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    class Broken:
        def __init__(self, *_: object) -> None: ...

        def start(self) -> None:
            raise FileNotFoundError(2, "No usable temporary directory")

        def stop(self) -> None: ...

    monkeypatch.setattr(engines, "ProcessSession", Broken)
    assert engine().sign is Sign.FAULT
    assert "No usable temporary directory" in engine().what


def test_an_engine_that_is_lost_is_a_fault_with_what_became_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    class Lost:
        def __init__(self, _setup: object, _deliver: object, ended: object) -> None:
            self._ended = ended

        def start(self) -> None:
            assert callable(self._ended)
            self._ended("the engine was killed by signal 9")

        def stop(self) -> None: ...

    monkeypatch.setattr(engines, "ProcessSession", Lost)
    assert engine().what == "does not run (the engine was killed by signal 9)"


def _of(verdicts: Iterator[Examination], subject: str) -> Examination:
    return next(each for each in verdicts if each.subject == subject)


_BIG = os.terminal_size((120, 40))


@pytest.mark.parametrize(
    ("environment", "subject", "sign", "said"),
    [
        ({"TERM": "dumb"}, "terminal", Sign.FAULT, "cannot place its cursor"),
        ({}, "terminal", Sign.NOTE, "TERM is not set"),
        ({"TERM": "xterm"}, "terminal", Sign.WELL, "xterm, 120 columns and 40 rows"),
        ({"TERM": "xterm"}, "colours", Sign.NOTE, "16"),
        ({"TERM": "xterm-256color"}, "colours", Sign.WELL, "256"),
        ({"TERM": "xterm", "COLORTERM": "truecolor"}, "colours", Sign.WELL, "16 million"),
        ({"TERM": "xterm", "NO_COLOR": "1"}, "colours", Sign.WELL, "greys alone, as NO_COLOR asks"),
        ({"TMUX": "/tmp/x", "SSH_TTY": "/dev/pts/1"}, "between", Sign.WELL, "ssh and tmux"),
        ({"TMUX": "/tmp/x"}, "clipboard", Sign.NOTE, "tmux keeps what is copied"),
        ({}, "clipboard", Sign.WELL, "OSC 52"),
    ],
)
def test_the_terminal_is_known_by_its_environment(
    environment: dict[str, str], subject: str, sign: Sign, said: str
) -> None:
    found = _of(screen(TerminalFacts(environment, "braille", _BIG)), subject)
    assert found.sign is sign
    assert said in found.what


def test_a_terminal_that_cannot_show_the_console_is_given_no_advice_on_colours() -> None:
    found = list(screen(TerminalFacts({"TERM": "dumb"}, "braille", _BIG)))
    assert "colours" not in {each.subject for each in found}


def test_a_terminal_that_is_too_small_or_none_is_noted() -> None:
    small = TerminalFacts({"TERM": "xterm"}, "ascii", os.terminal_size((60, 20)))
    assert "80 columns and 24 rows" in _of(screen(small), "terminal").remedy
    assert "no terminal" in _of(screen(small._replace(size=None)), "terminal").what
    assert _of(screen(small), "signs").sign is Sign.NOTE
    assert "⣿" in _of(screen(small._replace(charset="braille")), "signs").what


def test_a_folder_that_cannot_be_written_to_is_noted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    in_the_way = tmp_path / "file"
    in_the_way.write_text("")
    monkeypatch.setenv("XDG_STATE_HOME", str(in_the_way))
    assert _of(folders(lambda: tmp_path), "state folder").sign is Sign.NOTE
    assert _of(folders(lambda: in_the_way), "this folder").sign is Sign.NOTE
    assert _of(folders(lambda: tmp_path), "this folder").sign is Sign.WELL

    def nowhere() -> Path:
        raise FileNotFoundError(2, "No such file")

    assert "not there any more" in _of(folders(nowhere), "this folder").what


def test_who_has_no_home_is_told_what_it_would_be_good_for(monkeypatch: pytest.MonkeyPatch) -> None:
    without_home(monkeypatch)
    assert "XDG_STATE_HOME" in _of(folders(Path.cwd), "state folder").remedy
    assert [each.what for each in configuration(None)] == ["there is no home folder"]
    assert progress().what == "none yet"


def test_no_folder_for_temporary_files_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> str:
        raise FileNotFoundError(2, "No usable temporary directory")

    monkeypatch.setattr("cbtui.doctor.files.tempfile.gettempdir", refuse)
    assert _of(folders(Path.cwd), "temp folder").sign is Sign.FAULT


def test_what_is_wrong_in_the_configuration_is_told_with_its_line(tmp_path: Path) -> None:
    assert [each.sign for each in configuration(None)] == [Sign.WELL]
    mine = tmp_path / "config" / "cbtui" / "config.toml"
    mine.parent.mkdir(parents=True)
    mine.write_text('[display]\ntheme = "drak"\n[keys]\nnonsense = "x"\n')
    first, second = configuration(None)
    assert "config.toml:2: there is no theme 'drak'; did you mean 'dark'?" in first.what
    assert "config.toml:4: there is no action nonsense" in second.what
    assert [each.sign for each in configuration(tmp_path / "none.toml")] == [Sign.NOTE]


def test_a_broken_file_of_progress_is_told_and_left_as_it_is(tmp_path: Path) -> None:
    assert progress().what == "none yet"
    mine = tmp_path / "state" / "cbtui" / "progress.jsonl"
    mine.parent.mkdir(parents=True)
    mine.write_text('{"lesson":"single-thread"}\nnonsense\n')
    assert "progress.jsonl:2 is no progress" in progress().what
    assert [path.name for path in mine.parent.iterdir()] == ["progress.jsonl"]


def test_a_lesson_of_somebody_elses_that_is_at_fault_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    [found] = lessons_found()
    assert found.sign is Sign.WELL
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "lesson.toml").write_text("id = 3\n")
    monkeypatch.setenv("CBTUI_LESSONS", str(tmp_path))
    [found, others] = lessons_found()
    assert found.sign is Sign.FAULT
    assert str(tmp_path / "mine" / "lesson.toml") in found.what
    assert "CBTUI_LESSONS" in found.remedy
    assert others.sign is Sign.WELL


@pytest.mark.parametrize(
    ("environment", "said"),
    [
        ({}, "none is named"),
        ({"EDITOR": "no-such-editor -w"}, "no-such-editor is not there"),
        ({"EDITOR": "'vi"}, "the quotes of 'vi do not match"),
        ({"VISUAL": "sh -c", "EDITOR": "nothing"}, "sh -c"),
    ],
)
def test_an_editor_has_to_be_named_and_there(environment: dict[str, str], said: str) -> None:
    assert said in editor({**environment, "PATH": os.environ["PATH"]}).what


def test_a_port_that_is_taken_is_noted() -> None:
    import socket

    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        assert browser(other.getsockname()[1]).sign is Sign.NOTE


def test_whether_submissions_can_be_confined_is_tried(tmp_path: Path) -> None:
    assert "install bubblewrap" in grading(None).remedy
    assert grading(str(tmp_path / "none")).sign is Sign.NOTE
    refusing = tmp_path / "bwrap"
    refusing.write_text("#!/bin/sh\necho 'bwrap: No permissions to create a new namespace' >&2\nexit 1\n")
    refusing.chmod(0o700)
    assert "does not work here (bwrap: No permissions" in grading(str(refusing)).what
    refusing.write_text("#!/bin/sh\n")
    assert grading(str(refusing)).sign is Sign.WELL


def test_the_wheels_of_ros_are_offered_only_where_they_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extras, "find_spec", lambda _: None)
    monkeypatch.setattr(extras, "distributions", lambda: [])
    monkeypatch.setattr(extras, "requirements", lambda extra="": (extra,))
    assert "cbtui[ros]" in next(ros({})).what
    monkeypatch.setattr(extras, "requirements", lambda extra="": ())
    assert "no wheels of it fit this Python: --on ros2 takes --python EXE" in next(ros({})).what


def test_doctor_says_which_real_ros_there_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as without:
        without.setattr(extras, "find_spec", lambda _: None)
        assert "jazzy" in next(ros({"ROS_DISTRO": "jazzy"})).what
    (tmp_path / "rclpy").mkdir()
    (tmp_path / "rclpy" / "__init__.py").write_text("raise RuntimeError('this is the real one')\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "rclpy", raising=False)  # other tests may have imported a real one
    [found] = ros({"ROS_DISTRO": "jazzy"})
    assert found.sign is Sign.WELL
    assert str(tmp_path / "rclpy") in found.what
    assert "cbtui robot has no /tf" in found.what


def test_wheels_of_two_distributions_in_one_python_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed(tmp_path, "ros-jazzy-rclpy", "ros-kilted-rclpy")
    monkeypatch.setattr("sys.path", [str(tmp_path)])
    [found] = ros({})
    assert "the wheels of jazzy and kilted are in one Python" in found.what
