"""Where a learner's own interfaces are looked for."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.interfaces import find_definition_folders, workspace
from tests.support.nobody import close, without_home


def write(*files: Path) -> None:
    for file in files:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("")


def test_packages_beside_the_file_are_found(tmp_path: Path) -> None:
    course = tmp_path / "course"
    write(course / "node.py", course / "my_msgs/msg/A.msg", course / "other/srv/B.srv", course / "docs/a.txt")
    assert set(find_definition_folders(course / "node.py")) == {course / "my_msgs", course / "other"}


def test_a_workspace_is_found_from_a_node_in_it(tmp_path: Path) -> None:
    source = tmp_path / "ws" / "src"
    node = source / "my_pkg" / "my_pkg" / "node.py"
    write(node, source / "my_pkg/package.xml", source / "group/my_msgs/action/A.action")
    write(tmp_path / "ws/install/my_msgs/share/my_msgs/msg/A.msg", tmp_path / "ws/build/x/msg/A.msg")
    assert find_definition_folders(node) == [source / "group" / "my_msgs"]


def test_several_packages_side_by_side_are_a_workspace(tmp_path: Path) -> None:
    root = tmp_path / "repo"
    node = root / "my_pkg" / "my_pkg" / "node.py"
    write(node, root / "my_pkg/package.xml", root / "my_msgs/package.xml", root / "my_msgs/msg/A.msg")
    assert find_definition_folders(node) == [root / "my_msgs"]


def test_a_node_inside_its_interface_package_finds_it(tmp_path: Path) -> None:
    package = tmp_path / "ws" / "my_msgs"
    write(package / "scripts" / "node.py", package / "msg/A.msg")
    assert find_definition_folders(package / "scripts" / "node.py") == [package]


def test_the_nearest_package_comes_last(tmp_path: Path) -> None:
    source = tmp_path / "ws" / "src"
    node = source / "my_pkg" / "node.py"
    write(node, source / "my_msgs/msg/A.msg", source / "my_pkg/my_msgs/msg/A.msg")
    assert find_definition_folders(node) == [source / "my_msgs", source / "my_pkg" / "my_msgs"]


def test_hidden_ignored_and_linked_folders_are_left_out(tmp_path: Path) -> None:
    course = tmp_path / "course"
    write(
        course / "node.py", course / ".git/msg/A.msg", course / "old/msg/A.msg", course / "old/COLCON_IGNORE"
    )
    write(tmp_path / "elsewhere" / "deep" / "far" / "msg/A.msg")
    (course / "link").symlink_to(tmp_path / "elsewhere" / "deep" / "far")
    assert find_definition_folders(course / "node.py") == []


def test_a_folder_of_somebody_elses_alone_is_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path / "node.py", tmp_path / "closed/msg/A.msg", tmp_path / "open/msg/A.msg")
    close(tmp_path / "closed", monkeypatch)
    assert find_definition_folders(tmp_path / "node.py") == [tmp_path / "open"]


def test_no_more_folders_are_looked_into_than_allowed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    course = tmp_path / "course"
    write(course / "node.py", *(course / f"p{n}/msg/A.msg" for n in range(9)))
    monkeypatch.setattr(workspace, "MOST_FOLDERS", 5)
    assert len(find_definition_folders(course / "node.py")) == 4


def test_a_home_folder_is_not_searched_from_a_folder_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    write(tmp_path / "course/node.py", tmp_path / "my_msgs/msg/A.msg", tmp_path / "src/x/msg/A.msg")
    assert find_definition_folders(tmp_path / "course" / "node.py") == []


def test_packages_are_found_by_somebody_whose_home_nobody_knows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    without_home(monkeypatch)
    write(tmp_path / "course/node.py", tmp_path / "course/my_msgs/msg/A.msg")
    assert find_definition_folders(tmp_path / "course" / "node.py") == [tmp_path / "course" / "my_msgs"]
