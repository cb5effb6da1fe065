"""Where a person's own things are kept, and who has no home to keep them in."""

from pathlib import Path

import pytest

from lessons.personal import config_folder, state_folder
from lessons.progress import Progress
from tests.support.nobody import without_home


def test_the_folders_are_those_that_programs_keep_such_things_in(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in ("XDG_CONFIG_HOME", "XDG_STATE_HOME"):
        monkeypatch.delenv(name, raising=False)
    assert state_folder() == tmp_path / ".local" / "state" / "cbtui"
    assert config_folder() == tmp_path / ".config" / "cbtui"


def test_who_has_no_home_keeps_nothing_is_told_so_once_and_learns_all_the_same(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    without_home(monkeypatch)
    monkeypatch.chdir(tmp_path)
    assert not state_folder().is_absolute()
    assert not config_folder().is_absolute()
    progress = Progress()
    progress.see("split-groups")
    progress.see("shared-group")
    [trouble] = progress.troubles()
    assert "there is no home folder" in trouble
    assert progress.of("split-groups").seen
    assert list(tmp_path.iterdir()) == []
