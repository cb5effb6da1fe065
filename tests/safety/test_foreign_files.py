"""Files that others made, of any kind, size and depth: refused in a sentence, and in little memory."""

import os
import tracemalloc
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from cbtui.keys.config import read_file
from lessons.lesson import BadLesson, read_lesson
from lessons.progress import faulty_line
from sim.engine.programs.source import NothingToRunError, read_source
from sim.files import plain_toml, untrusted
from sim.launch.errors import LaunchError
from sim.launch.loading import load_description
from sim.packages.cmake_file import read_cmake
from sim.packages.errors import PackageError
from sim.packages.manifest import read_name
from sim.packages.setup_file import read_setup
from sim.ros.parameters.parameter import parameter_dict_from_yaml_file
from sim.ros.parameters.yaml_files import ParameterYamlError
from sim.ros.parameters.yaml_files import read_file as read_parameters

LITTLE = 50_000_000
"""Bytes of memory."""


def pipe(path: Path) -> None:
    os.mkfifo(path)


def endless(path: Path) -> None:
    path.symlink_to("/dev/zero")


def huge(path: Path) -> None:
    """Make a file of 1 TB that takes no room on the disk."""
    with path.open("wb") as file:
        file.truncate(10**12)


def configuration(path: Path) -> None:
    (complaint,) = read_file(path).complaints
    raise ValueError(complaint)


READERS: dict[str, tuple[Callable[[Path], Any], type[Exception]]] = {
    "config.toml": (configuration, ValueError),
    "lesson.toml": (lambda path: read_lesson(path.parent), BadLesson),
    "progress.jsonl": (faulty_line, OSError),
    "package.xml": (lambda path: read_name(path.parent), PackageError),
    "CMakeLists.txt": (lambda path: read_cmake(path.parent), PackageError),
    "params.yaml": (lambda path: read_parameters(str(path)), ParameterYamlError),
    "others.yaml": (lambda path: parameter_dict_from_yaml_file(str(path)), OSError),
    "node.py": (read_source, NothingToRunError),
}


@pytest.fixture
def little_memory() -> Iterator[None]:
    tracemalloc.start()
    yield
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < LITTLE


@pytest.mark.usefixtures("little_memory")
@pytest.mark.parametrize("make", [pipe, endless, huge])
@pytest.mark.parametrize("name", READERS)
def test_what_is_no_small_regular_file_is_refused_in_a_sentence(
    tmp_path: Path, name: str, make: Callable[[Path], None]
) -> None:
    read, error = READERS[name]
    make(tmp_path / name)
    with pytest.raises(error, match=r"pipe or a device|more than [\d,]+ bytes") as raised:
        read(tmp_path / name)
    assert len(str(raised.value).splitlines()) == 1


@pytest.mark.parametrize("make", [pipe, endless])
def test_a_setup_file_or_a_definition_that_is_no_file_is_none(
    tmp_path: Path, make: Callable[[Path], None]
) -> None:
    make(tmp_path / "setup.py")
    assert not read_setup(tmp_path).entry_points


@pytest.mark.parametrize("name", ["setup.py", "setup.cfg"])
def test_a_huge_setup_file_is_refused(tmp_path: Path, name: str) -> None:
    huge(tmp_path / name)
    with pytest.raises(PackageError, match="more than 1,000,000 bytes"):
        read_setup(tmp_path)


@pytest.mark.parametrize("make", [pipe, huge])
def test_a_launch_file_that_is_no_small_file_is_refused(tmp_path: Path, make: Callable[[Path], None]) -> None:
    make(tmp_path / "robot.launch.py")
    with pytest.raises(LaunchError, match=r"pipe or a device|more than [\d,]+ bytes"):
        load_description(tmp_path / "robot.launch.py")


def test_the_null_device_is_an_empty_file() -> None:
    assert read_file(Path(os.devnull)).complaints == []


def test_a_file_of_the_most_that_is_read_is_read(tmp_path: Path) -> None:
    path = tmp_path / "text"
    path.write_bytes(b"a\r\n" + b"b" * 97)
    assert untrusted.read_text(path, 100) == "a\n" + "b" * 97
    with pytest.raises(OSError, match="more than 99 bytes"):
        untrusted.read_text(path, 99)


DEEP = {
    "a dotted key": "a." * 50_000 + "a = 1",
    "a quoted key": '"a" . ' * 15_000 + "'a' = 1",
    "a table": "[" + "a." * 50_000 + "a]",
    "arrays": "a = " + "[" * 50_000,
    "tables in each other": "a = " + "{a.a.a.a.a.a = " * 100 + "1" + "}" * 100,
    "tables of tables": "".join(f"[{'a.' * depth}a]\n" for depth in range(1, 33)) + "a.a = 1",
}


@pytest.mark.usefixtures("little_memory")
@pytest.mark.parametrize("what", DEEP)
def test_deep_toml_is_refused_with_its_line(tmp_path: Path, what: str) -> None:
    path = tmp_path / "config.toml"
    path.write_text(DEEP[what])
    (complaint,) = read_file(path).complaints
    assert "more than 32 parts" in complaint or "nested too deeply" in complaint
    assert len(complaint) < 200


@pytest.mark.slow
@pytest.mark.usefixtures("little_memory")
@pytest.mark.parametrize("filling", [" ", "[", '"a"', "a ", "a.", "# "])
def test_long_texts_in_toml_take_no_more_than_their_length(tmp_path: Path, filling: str) -> None:
    text = filling * (30 if filling == "a." else 100_000)
    path = tmp_path / "config.toml"
    path.write_text(f"other = '''\n{text}\n'''\n[display]\ntheme = 1\n")
    assert read_file(path).complaints[-1].startswith("config.toml:5:")


def test_what_a_usual_file_holds_is_read() -> None:
    assert plain_toml.load('[a.b]\nc.d = [{e = "f.g"}]') == {"a": {"b": {"c": {"d": [{"e": "f.g"}]}}}}
