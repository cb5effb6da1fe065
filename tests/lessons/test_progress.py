"""How far a learner has come: kept across consoles, and lost to nothing that happens to its file."""

import os
import threading
from pathlib import Path

import pytest

from lessons.progress import LessonProgress, Progress, usual_path


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "state" / "progress.jsonl"


def test_every_step_is_there_in_the_next_console(path: Path) -> None:
    progress = Progress(path)
    progress.answer("split-groups", 0, 1)
    progress.answer("split-groups", 1, 2)
    progress.see("split-groups")
    progress.take_hint("split-groups", 2)
    progress.look_at_solution("split-groups")
    progress.passes("split-groups")
    progress.see("single-thread")
    again = Progress(path)
    assert again.of("split-groups") == LessonProgress(
        lesson="split-groups", answers=(1, 2), seen=True, hints=2, solution=True, passed=True
    )
    assert again.of("single-thread") == LessonProgress(lesson="single-thread", seen=True)
    assert again.of("shared-group") == LessonProgress(lesson="shared-group")
    assert progress.troubles() == again.troubles() == []


def test_an_answer_once_given_stays(path: Path) -> None:
    progress = Progress(path)
    progress.answer("split-groups", 0, 1)
    progress.answer("split-groups", 0, 2)
    progress.answer("split-groups", 5, 2)
    assert progress.of("split-groups").answers == (1,)


def test_an_earlier_hint_takes_no_later_one_back(path: Path) -> None:
    progress = Progress(path)
    progress.take_hint("split-groups", 3)
    progress.take_hint("split-groups", 1)
    assert progress.of("split-groups").hints == 3


def test_the_file_is_plain_text_with_a_line_for_each_lesson(path: Path) -> None:
    progress = Progress(path)
    progress.see("b")
    progress.see("a")
    assert path.read_text() == "".join(
        f'{{"lesson":"{name}","answers":[],"seen":true,"explained":false,"hints":0,"solution":false,"passed":false}}\n'
        for name in "ba"
    )


def test_a_lesson_that_is_reset_begins_anew_and_the_others_stay(path: Path) -> None:
    progress = Progress(path)
    progress.see("a")
    progress.see("b")
    assert progress.reset("a")
    assert not progress.reset("a")
    again = Progress(path)
    assert (again.of("a").seen, again.of("b").seen) == (False, True)


def test_consoles_at_once_do_not_lose_each_others_steps(path: Path) -> None:
    first, second = Progress(path), Progress(path)
    first.see("a")
    second.see("b")
    first.take_hint("b", 1)
    second.reset("a")
    first.take_hint("c", 1)
    last = Progress(path)
    assert (last.of("a").seen, last.of("b").seen, last.of("b").hints, last.of("c").hints) == (
        False,
        True,
        1,
        1,
    )
    second.refresh()
    assert second.of("c").hints == 1


def test_consoles_that_write_at_the_same_moment_do_not_lose_each_others_steps(path: Path) -> None:
    def work(console: int) -> None:
        progress = Progress(path)
        for step in range(10):
            progress.see(f"lesson-{console}-{step}")

    threads = [threading.Thread(target=work, args=(console,)) for console in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    progress = Progress(path)
    assert all(progress.of(f"lesson-{console}-{step}").seen for console in range(4) for step in range(10))


@pytest.mark.parametrize(
    "broken", ["not JSON", "[1, 2]", '{"lesson": 3}', '{"lesson": "a", "seen": tru', "\x00", "[" * 5000]
)
def test_a_broken_file_is_set_aside_and_what_is_readable_goes_on(path: Path, broken: str) -> None:
    Progress(path).see("b")
    path.write_text(path.read_text() + broken)
    before = path.read_text()
    progress = Progress(path)
    assert progress.of("b").seen
    (trouble,) = progress.troubles()
    assert trouble == (
        f"{path}:2 is no progress; the file was kept as progress.jsonl.broken-1, "
        "and the lessons go on with what could be read"
    )
    assert (path.parent / "progress.jsonl.broken-1").read_text() == before
    assert Progress(path).of("b").seen


def test_a_second_broken_file_does_not_replace_the_first(path: Path) -> None:
    path.parent.mkdir()
    for number in (1, 2):
        path.write_text(f"broken {number}")
        Progress(path)
    for number in (1, 2):
        assert (path.parent / f"progress.jsonl.broken-{number}").read_text() == f"broken {number}"


def test_bytes_that_are_no_text_are_set_aside(path: Path) -> None:
    path.parent.mkdir()
    path.write_bytes(b"\xff\xfe\n")
    assert len(Progress(path).troubles()) == 1


def test_progress_that_cannot_be_written_goes_on_in_memory_and_says_so_once(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    progress = Progress(tmp_path / "file" / "progress.jsonl")
    progress.see("a")
    progress.see("b")
    assert progress.of("a").seen
    assert progress.of("b").seen
    (trouble,) = progress.troubles()
    assert "Not a directory" in trouble
    assert progress.troubles() == []


def test_a_file_that_cannot_be_read_is_left_alone(path: Path) -> None:
    path.mkdir(parents=True)
    progress = Progress(path)
    progress.see("a")
    assert progress.of("a").seen
    (trouble,) = progress.troubles()
    assert trouble == f"{path} cannot be read: Is a directory; progress is not kept"


def test_a_crash_while_writing_leaves_the_file_as_it_was(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    progress = Progress(path)
    progress.see("a")
    before = path.read_text()

    def crash(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", crash)
    progress.see("b")
    assert path.read_text() == before
    assert {each.name for each in path.parent.iterdir()} == {"progress.jsonl", "progress.jsonl.lock"}
    assert progress.troubles() == [f"progress is not kept: {path}: No space left on device"]


def test_a_lock_that_somebody_holds_keeps_nobody_waiting_for_ever(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fcntl

    monkeypatch.setattr("lessons.state_file._LOCK_TIMEOUT", 0.05)
    progress = Progress(path)
    progress.see("a")
    with (path.parent / "progress.jsonl.lock").open("wb") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        progress.see("b")
    assert Progress(path).of("b").seen


def test_it_is_kept_where_the_state_of_programs_is(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert usual_path() == tmp_path / "cbtui" / "progress.jsonl"
