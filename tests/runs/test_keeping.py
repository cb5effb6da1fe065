"""The last seconds of a run are kept, and written once for each trouble."""

import sys
from itertools import pairwise
from pathlib import Path

import pytest

from cbtui.runs.headless.keeping import Keeper, KeptEvents, run_and_keep
from cbtui.runs.setup.shown_program import watched_setup
from sim.engine.setup import RealRos
from sim.quantities.nanoseconds import SECOND
from sim.recording import read
from sim.trace.events import AnyEvent, CallbackStarted, EntityAppeared, ProcessEnded, TimePassed
from tests.support.builder import Run, ns
from tests.support.runs import shared_group_run

SETUP = watched_setup("node", RealRos(watched="somewhere"))


def batches(run: Run, *, until: float) -> list[list[AnyEvent]]:
    """The events of a run, a batch for each half second."""
    events = run.until(until)
    ends = [ns(0.5 * each) for each in range(int(2 * until) + 2)]
    cut = [[event for event in events if start <= event.t < end] for start, end in pairwise(ends)]
    return [batch for batch in cut if batch]


def test_what_is_older_than_wanted_is_let_go_but_for_what_one_must_know() -> None:
    kept = KeptEvents(2.0)
    run = batches(shared_group_run(), until=9.0)
    for batch in run:
        kept.take(batch)
    assert [event for batch in run[-3:] for event in batch] == kept.events()[-sum(map(len, run[-3:])) :]
    events = kept.events()
    last = events[-1].t
    assert [event for event in events if isinstance(event, EntityAppeared)]
    starts = [event.t for event in events if isinstance(event, CallbackStarted)]
    assert sum(start < last - 3 * SECOND for start in starts) <= 1, "but for those that still ran"


def test_a_callback_that_starves_is_recorded_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("cbtui.runs.live.findings._MIN_INTERVAL", 0.0)
    monkeypatch.setattr("cbtui.runs.live.findings._TIME_SHARE", 1e9)
    keeper = Keeper(SETUP, 60.0)
    for batch in batches(shared_group_run(), until=9.0):
        keeper.take(batch)
    [file] = tmp_path.glob("*.mcap")
    said = capsys.readouterr().err
    assert f"cbtui replay {file.name}" in said
    assert any(isinstance(event, EntityAppeared) for batch in read(file).batches() for event in batch)


def test_a_process_that_dies_is_recorded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Keeper(SETUP, 60.0).take([ProcessEnded(7, 1, "node-12 was killed", 1)])
    assert "node-12 was killed (the last 60 s: cbtui replay node-" in capsys.readouterr().err


def test_a_long_run_takes_no_more_memory_than_what_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    keeper = Keeper(SETUP, 60.0)
    timeline = keeper._timeline
    keeper.take([TimePassed(ns(700.0))])
    assert keeper._timeline is not timeline


@pytest.mark.slow
@pytest.mark.parametrize(("script", "status"), [("pass", 0), ("raise SystemExit(3)", 3)])
def test_a_command_ends_as_it_would_without_being_kept(script: str, status: int, tmp_path: Path) -> None:
    setup = watched_setup("node", RealRos(watched=str(tmp_path)))
    assert run_and_keep([sys.executable, "-c", script], {}, setup, 5.0) == status
