"""The summary of a run as JSON, from a run and from its recording."""

import json
from pathlib import Path

import pytest

from tests.support.commands import cbtui

WORDS = ("run", "call-in-a-callback", "--for", "5", "--no-robot")


def test_a_run_and_its_recording_tell_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    ran = cbtui(*WORDS, "--json", "run.json", "--record", "run.mcap")
    assert "Diagnosis" in ran.stdout
    told = json.loads(Path("run.json").read_text())
    assert told["seconds"] == 5.0
    assert {each["callback"]: each["calls"] for each in told["callbacks"]}["pick"] == 1
    deadlock = told["findings"][0]
    assert "deadlock" in deadlock["what"]
    assert Path(deadlock["file"]).name == "node.py"
    assert deadlock["line"] > 0
    assert json.loads(cbtui("info", "run.mcap", "--json").stdout) == told


@pytest.mark.parametrize(("lesson", "code"), [("call-in-a-callback", 1), ("split-groups", 0)])
def test_a_run_ends_with_failure_for_a_problem_only_if_asked(lesson: str, code: int) -> None:
    run = ("run", lesson, "--for", "5", "--no-robot")
    assert (cbtui(*run).returncode, cbtui(*run, "--fail-on", "problem").returncode) == (0, code)


def test_a_summary_that_cannot_be_written_is_refused_before_the_run(tmp_path: Path) -> None:
    ran = cbtui("run", "missed-ticks", "--for", "1", "--json", str(tmp_path / "none" / "run.json"))
    assert (ran.returncode, ran.stdout) == (2, "")
    assert "run.json cannot be written: there is no folder " in ran.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_a_summary_on_a_full_disk_is_complained_of() -> None:
    ran = cbtui("run", "missed-ticks", "--for", "1", "--json", "/dev/full")
    assert ran.returncode == 1
    assert "cannot write the summary to" in ran.stderr
    assert ran.stdout.startswith("missed-ticks, 1.0 s")
