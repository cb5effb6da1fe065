"""What only a busy machine shows is found with ``--strategy busy``, and told."""

import re
import shlex
from pathlib import Path

import pytest

from cbtui.commands import explore
from tests.commands.exploring_files import AT_THE_OVEN, JUST_IN_TIME
from tests.support.commands import cbtui

pytestmark = pytest.mark.slow


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return where a node goes. The fifty further runs for a simpler order that fails are left out."""
    monkeypatch.setattr(explore, "SHRINKING", 0)
    return tmp_path / "mine.py"


def test_only_a_busy_machine_shows_what_is_done_just_in_time(file: Path) -> None:
    file.write_text(JUST_IN_TIME)
    words = ("explore", str(file), "--schedules", "12", "--for", "0.4")
    assert "none failed" in cbtui(*words, "--strategy", "random").stdout
    explored = cbtui(*words, "--strategy", "busy")
    assert "brew raised AssertionError\n      cold water" in explored.stdout
    command = next(line for line in explored.stdout.splitlines() if "cbtui run" in line)
    assert " --seed busy:" in command
    again = cbtui(*shlex.split(command)[1:])
    assert "AssertionError: cold water" in again.stdout + again.stderr


def test_only_a_busy_machine_stalls_while_a_callback_could_go_on_and_it_is_told(file: Path) -> None:
    file.write_text(AT_THE_OVEN)
    words = ("explore", str(file), "--schedules", "24", "--for", "0.4")
    assert "none failed" in cbtui(*words).stdout
    explored = " ".join(cbtui(*words, "--strategy", "busy").stdout.split())
    assert "bake raised AssertionError raw dough 1. 0." in explored
    assert re.search(r"s the machine is slow: \d+ ms pass before \S+ \(mine.py:\d+, in knead\)", explored)
