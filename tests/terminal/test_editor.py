from pathlib import Path

import pytest

from cbtui.terminal.editor import EditorError, command_for


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "node.py"
    path.write_text("")
    return path


@pytest.mark.parametrize(
    ("editor", "command"),
    [
        ("nano", ["nano", "+7", "{file}"]),
        ("/usr/bin/vim -n", ["/usr/bin/vim", "-n", "+7", "{file}"]),
        ("'/opt/my editor/vi'", ["/opt/my editor/vi", "+7", "{file}"]),
        ("/opt/own-editor --new", ["/opt/own-editor", "--new", "{file}"]),
        ("code --wait", ["code", "--wait", "--goto", "{file}:7"]),
        ("vim.basic", ["vim.basic", "+7", "{file}"]),
        ("hx", ["hx", "{file}:7"]),
    ],
)
def test_an_editor_is_told_the_line_in_its_own_way(path: Path, editor: str, command: list[str]) -> None:
    expected = [word.format(file=path) for word in command]
    assert command_for({"EDITOR": editor}, path, 7) == expected


def test_visual_is_preferred_to_editor(path: Path) -> None:
    assert command_for({"EDITOR": "ed", "VISUAL": "vi"}, path, 1)[0] == "vi"
    assert command_for({"EDITOR": "ed", "VISUAL": " "}, path, 1)[0] == "ed"


@pytest.mark.parametrize(
    ("environment", "part"),
    [
        ({}, "no editor is named; leave, type export EDITOR=nano or another, and start again"),
        ({"EDITOR": "  "}, "no editor is named"),
        ({"EDITOR": "vi '"}, "whose quotes do not match"),
    ],
)
def test_without_an_editor_there_is_one_sentence(path: Path, environment: dict[str, str], part: str) -> None:
    with pytest.raises(EditorError, match=part):
        command_for(environment, path, 1)


def test_a_file_that_is_not_here_is_told_of(tmp_path: Path) -> None:
    with pytest.raises(EditorError, match="is not on this machine"):
        command_for({"EDITOR": "vi"}, tmp_path / "gone.py", 1)
