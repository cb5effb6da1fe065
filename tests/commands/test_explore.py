"""``cbtui explore``: other orders of a program's threads, what came of them, and their seeds."""

import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from cbtui import cli
from cbtui.commands import explore as command
from cbtui.runs.judged import exploring
from cbtui.runs.judged.exploration_text import ReplayCommand, Shrunk, exploration_text
from cbtui.runs.judged.exploring import Exploration, ScheduleFailure, ScheduleResult
from cbtui.runs.judged.shards import Shard
from lessons.catalogue import find
from sim.engine.setup import RunSetup
from tests.commands.exploring_files import (
    IN_ONE_GROUP,
    LOCK_ORDER,
    LOOPS,
    LOST_UPDATE,
)
from tests.support.processes import descendants, wait_until_gone


def cbtui(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "cbtui", *words], capture_output=True, text=True, check=False
    )


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "mine.py"


def test_a_callback_that_is_not_there_cannot_be_put_into_another_group(file: Path) -> None:
    file.write_text(IN_ONE_GROUP)
    explored = cbtui("explore", str(file), "--schedules", "2", "--for", "1", "--group", "nobody=own")
    assert explored.returncode == 2
    assert "note: no callback is named nobody; there " in explored.stdout


def test_an_order_that_fails_is_found_and_the_simplest_that_does_is_told_and_run_again(file: Path) -> None:
    file.write_text(LOST_UPDATE)
    explored = cbtui("explore", str(file), "--schedules", "8", "--for", "2")
    assert explored.returncode == 1
    assert re.fullmatch(r"(\d+ .*schedules, \d+ failed\n)*", explored.stderr), "progress and nothing else"
    assert re.match(r"mine.py: 8 schedules, 2 outcomes, \d+ schedules? failed\n", explored.stdout)
    assert "✓" in explored.stdout
    _, _, simplest = explored.stdout.partition("The simplest order found, run to prove it: seed moves:1=1\n")
    told = " ".join(simplest.split())
    assert told.startswith("mine.py:15: the program raised AssertionError: 1 1. 0.000 s Thread-1 (add) ")
    assert "conflict: n: mine.py:8 reads it, then" in told
    command = next(line for line in explored.stdout.splitlines() if "cbtui run" in line)
    assert command.endswith(" --seed moves:1=1")
    again = cbtui(*shlex.split(command)[1:])
    assert "AssertionError: 1" in again.stdout + again.stderr


@pytest.mark.slow
def test_locks_that_are_taken_in_two_orders_are_found(file: Path) -> None:
    file.write_text(LOCK_ORDER)
    explored = cbtui("explore", str(file), "--schedules", "12", "--seed", "1", "--for", "0.5")
    assert explored.returncode == 1
    assert "    deadlock\n" in explored.stdout
    assert "in forth" in explored.stdout
    assert "in back" in explored.stdout


@pytest.mark.slow
def test_a_callback_that_never_leaves_its_loop_has_failed_and_is_told_in_words(file: Path) -> None:
    file.write_text(LOOPS)
    explored = cbtui("explore", str(file), "--schedules", "2", "--for", "5")
    assert explored.returncode == 1
    assert "✗ all of them, such as seed 1\n    a callback does not leave its loop\n" in explored.stdout
    assert "    diagnosis: wait has been in the loop of line 29 for 4." in explored.stdout


@pytest.mark.slow
def test_a_program_in_order_has_one_outcome_and_ends_with_0(file: Path) -> None:
    file.write_text(IN_ONE_GROUP)
    explored = cbtui("explore", str(file), "--schedules", "4", "--for", "0.3")
    assert explored.stdout.startswith("mine.py: 4 schedules, 1 outcome, none failed\n\n✓ all of them")
    assert explored.returncode == 0


@pytest.mark.bulk
def test_a_changed_set_up_is_what_is_explored_and_shown_again(file: Path) -> None:
    file.write_text(IN_ONE_GROUP)
    words = ("--group", "ann=reentrant", "--group", "/seats:bob=reentrant", "--group", "eve=own")
    explored = cbtui("explore", str(file), "--schedules", "12", "--for", "0.3", *words)
    assert explored.returncode == 1
    assert "taken twice" in explored.stdout
    assert "    note: no callback is named eve; there are ann, bob\n" in explored.stdout
    again = shlex.join(["cbtui", "run", str(file), "--for", "0.3", *words])
    assert f"\n  {again} --seed " in explored.stdout


@pytest.mark.slow
def test_a_solution_passes_its_checks_in_every_order() -> None:
    solution = find("overlapping-timer").node_path.with_name("solution.py")
    explored = cbtui("explore", str(solution), "--check", "overlapping-timer", "--schedules", "2")
    assert "2 schedules, 1 outcome, none failed" in explored.stdout
    assert f"cbtui check overlapping-timer {solution} --seed 1" in explored.stdout
    assert explored.returncode == 0


@pytest.mark.bulk
def test_checks_that_fail_are_named_with_what_was_seen() -> None:
    explored = cbtui("explore", "overlapping-timer", "--schedules", "2")
    assert "check failed: every call of inspect is counted\n      expected " in explored.stdout
    assert explored.returncode == 1


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["nowhere.py"], "there is no file nowhere.py"),
        (["no-lesson"], "no-lesson"),
        (["shared-group", "--check", "shared-group"], "leave out --check"),
        (["shared-group", "--for", "3"], "describes; leave out --for\n"),
        (["shared-group", "--threads", "2", "--group", "a=own"], "leave out --threads, --group\n"),
        (["mine.py", "--check", "split-groups", "--at", "1", "ros2 node list"], "leave out --at\n"),
        (["mine.py", "--at", "11", "ros2 node list"], "a line at 11 s comes when the run of 10 s is over"),
        (["mine.py", "--call", "11"], "when the run of 10 s is over"),
        (["mine.py", "--schedules", "0"], "give 1 or more"),
        (["mine.py", "--seed", "x"], "'x' is not a whole number"),
        (["mine.py", "--check", "lock-or-group"], "has no exercise"),
    ],
)
def test_what_cannot_be_explored_is_refused_in_a_line(
    words: list[str],
    sentence: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text(IN_ONE_GROUP)
    with pytest.raises(SystemExit) as caught:
        cli.main(["explore", *words])
    assert caught.value.code == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert sentence in said


@pytest.mark.parametrize("name", ["pos:x", "nobody:3", "moves:a", "moves:1=-1", "ask:", "pos:"])
def test_a_schedule_that_does_not_exist_is_refused(
    name: str, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file.write_text(IN_ONE_GROUP)
    with pytest.raises(SystemExit):
        cli.main(["run", str(file), "--seed", name])
    assert "--seed" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["run", "open"])
def test_the_real_clock_takes_no_seed(command: str, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file.write_text(IN_ONE_GROUP)
    with pytest.raises(SystemExit) as caught:
        cli.main([command, str(file), "--seed", "3", "--clock", "real"])
    assert caught.value.code == 2
    assert "leave out --seed 3" in capsys.readouterr().err


def test_ctrl_c_ends_it_and_every_process(file: Path) -> None:
    file.write_text("while True:\n    pass\n")
    explore = subprocess.Popen(
        [sys.executable, "-m", "cbtui", "explore", str(file)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    give_up = time.monotonic() + 60
    while len(children := descendants(explore.pid)) < 3:  # what tracks resources, what forks, an engine
        assert time.monotonic() < give_up
        time.sleep(0.05)
    os.killpg(explore.pid, signal.SIGINT)  # as a terminal does
    said, complained = explore.communicate(timeout=60)
    assert (explore.returncode, said) == (130, b"")
    assert complained == b"cbtui: interrupted: 0 of 100 schedules were tried\n"
    wait_until_gone(children)


@pytest.mark.slow
def test_who_has_read_enough_of_it_is_no_trouble(file: Path) -> None:
    file.write_text(IN_ONE_GROUP)
    words = ["explore", str(file), "--schedules", "1", "--for", "0.1"]
    line = shlex.join([sys.executable, "-m", "cbtui", *words])
    done = subprocess.run(
        ["/bin/sh", "-c", f"({line}; echo ended with $? >&2) | true"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr == "ended with 141\n"


DEADLOCK = ScheduleResult((ScheduleFailure("deadlock", "a waits for b"),), ("no-free-worker",))
WELL = ScheduleResult()


def test_outcomes_that_failed_come_first_each_with_its_first_seed() -> None:
    later = ScheduleResult((ScheduleFailure("deadlock", "b waits for a"),), ("no-free-worker",))
    text = exploration_text(
        "mine.py", {5: WELL, 6: DEADLOCK, 7: later}, [ReplayCommand(("cbtui", "run", "mine.py"), ("-x",))]
    )
    assert text == (
        "mine.py: 3 schedules, 2 outcomes, 2 schedules failed\n"
        "\n"
        "✗ 2 schedules, such as seed 6\n"
        "    deadlock\n"
        "      a waits for b\n"
        "    diagnosis: no-free-worker\n"
        "\n"
        "✓ 1 schedule, such as seed 5\n"
        "    no problem\n"
        "\n"
        "To see one again:\n"
        "  cbtui run mine.py --seed 6 -- -x\n"
    )


def test_it_is_told_how_many_schedules_were_tried_in_vain_for_a_simpler_order() -> None:
    text = exploration_text(
        "mine.py", {6: DEADLOCK}, [ReplayCommand(("cbtui", "run", "mine.py"))], shrunk=Shrunk(50, "", None)
    )
    assert "\nNo simpler order that fails was found in 50 further schedules.\n" in text
    assert text.endswith("  cbtui run mine.py --seed 6\n")


class _Results(Exploration):
    """An exploration whose runs are over already."""

    def results(self, seeds: Any, processes: int | None = None) -> Any:
        yield from {2: DEADLOCK, 1: WELL}.items()


FINISHED = _Results(RunSetup(title="mine", programs=()), "mine.py", None, 1.0)


def test_a_terminal_is_told_how_far_it_has_come(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    found: dict[int, ScheduleResult] = {}
    assert not command._interrupted(FINISHED.results(range(1, 3)), found, "of 2 ")
    assert found == {1: WELL, 2: DEADLOCK}
    shown = [line.removeprefix("\033[K") for line in capsys.readouterr().err.split("\r")]
    assert shown == ["", "1 of 2 schedules, 1 failed", "2 of 2 schedules, 1 failed", ""]


def test_every_order_within_a_bound_is_run_and_the_simplest_that_fails_is_told(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # Two threads that read and write: AABB, BBAA; ABBA, BAAB, of which one stop is enough to lose an update.
    file.write_text(LOST_UPDATE)
    assert cli.main(["explore", str(file), "--preemptions", "0"]) == 0
    assert "without preemptions: 2 schedules, all run\n" in capsys.readouterr().out
    assert cli.main(["explore", str(file), "--preemptions", "1"]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "mine.py: with at most 1 preemption: 4 schedules, all run" in said
    assert "such as seed moves:1=1" in said
    assert "1. 0.000 s Thread-1 (add) (mine.py:9, in add) stops; Thread-2 (add) goes on" in said
    assert "conflict: n: mine.py:8 reads it, then mine.py:9 writes it, then mine.py:9 writes it" in said
    assert "cbtui run " in said
    assert "--seed moves:1=1" in said
    assert cli.main(["explore", str(file), "--preemptions", "1", "--schedules", "3"]) == 1
    assert "with at most 1 preemption: stopped after 3 schedules" in capsys.readouterr().out


def test_moves_are_played_again(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file.write_text(LOST_UPDATE)
    assert cli.main(["run", str(file), "--for", "2", "--seed", "moves:1=1"]) == 1
    assert "AssertionError: 1" in "".join(capsys.readouterr())
    assert cli.main(["run", str(file), "--for", "2", "--seed", "moves:"]) == 0
    assert not capsys.readouterr().err


@pytest.mark.parametrize(
    ("seed", "why"),
    [
        ("moves:1=9", "moves:1=9 was not played: choice 1 was among 2 threads, counted from 0"),
        ("moves:0=0,99=1", "moves:99=1 was not played: there were 2 choices, counted from 0"),
    ],
)
def test_moves_that_a_run_does_not_come_to_are_told(
    seed: str, why: str, file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file.write_text(LOST_UPDATE)
    assert cli.main(["run", str(file), "--for", "2", "--seed", seed]) == 0
    assert capsys.readouterr().err == f"cbtui: {why}\n"


class _Interrupted(_Results):
    """One that is interrupted after its first run."""

    def results(self, seeds, processes=None):  # type: ignore[no-untyped-def]
        yield 2, DEADLOCK
        raise KeyboardInterrupt


def test_what_was_tried_until_ctrl_c_is_told(
    file: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file.write_text(IN_ONE_GROUP)
    monkeypatch.setattr(exploring, "Exploration", _Interrupted)
    assert cli.main(["explore", str(file), "--schedules", "9"]) == 130
    said = capsys.readouterr()
    assert said.err == "cbtui: interrupted: 1 of 9 schedules were tried\n"
    assert said.out.startswith("mine.py: 1 schedule, 1 outcome, 1 schedule failed\n")


def test_two_shards_and_their_merge_tell_what_one_exploration_does(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file.write_text(LOST_UPDATE)
    words = ["explore", str(file), "--schedules", "2", "--seed", "4", "--for", "2"]
    parts = [str(tmp_path / name) for name in ("one.json", "two.json")]
    for number, part in enumerate(parts, start=1):
        cli.main([*words, "--shard", f"{number}/2", "--save", part])
        assert "mine.py: 1 schedule," in capsys.readouterr().out
    code = cli.main(words)
    whole = capsys.readouterr().out
    assert "The simplest order found, run to prove it: seed moves:1=1\n" in whole
    assert cli.main(["explore", "--merge", *parts]) == code
    assert capsys.readouterr().out == whole
    assert cli.main(["explore", "--merge", parts[0]]) == 1
    assert "1 of 2 schedules are in none of these files" in capsys.readouterr().err


def test_a_search_is_cut_in_two_and_only_both_parts_prove_it(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file.write_text(LOST_UPDATE)
    words = ["explore", str(file), "--preemptions", "1"]
    parts = [str(tmp_path / name) for name in ("one.json", "two.json")]
    for number, part in enumerate(parts, start=1):
        cli.main([*words, "--shard", f"{number}/2", "--save", part])
        assert f"mine.py: part {number} of 2: " in capsys.readouterr().out
    assert cli.main(words) == 1
    whole = capsys.readouterr().out
    assert cli.main(["explore", "--merge", *parts]) == 1
    merged = capsys.readouterr()
    assert "with at most 1 preemption: 4 schedules, all run" in merged.out
    assert merged.out == whole
    assert merged.err == ""
    assert cli.main(["explore", "--merge", parts[0]]) == 1
    merged = capsys.readouterr()
    assert "stopped after" in merged.out
    assert merged.err == "cbtui: part 2 of 2, run to its end, is in none of these files\n"


def test_files_that_do_not_belong_together_are_not_merged(
    file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one, other = tmp_path / "one.json", tmp_path / "other.json"
    for path, schedules in ((one, 2), (other, 3)):
        Shard(
            program="mine.py", replays=(), first=1, schedules=schedules, strategy="pos", results={}
        ).write_to(path)
    for merge, sentence in (
        ([one, other], "belongs to another exploration than"),
        ([one, tmp_path / "none.json"], "cannot be read: No such file or directory"),
        ([file.with_suffix(".txt")], "is not part of an exploration"),
    ):
        file.with_suffix(".txt").write_text("{}")
        with pytest.raises(SystemExit):
            cli.main(["explore", "--merge", *map(str, merge)])
        assert sentence in capsys.readouterr().err


@pytest.mark.parametrize("words", ["0/2", "3/2", "2", "a/b"])
def test_a_part_that_does_not_exist_is_refused(words: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        cli.main(["explore", "mine.py", "--shard", words])
    assert "--shard" in capsys.readouterr().err
