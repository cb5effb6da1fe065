import os
from pathlib import Path

import pytest

from cbtui.runs.setup.recent import FILES_KEPT, RecentEntry, RecentKind, RecentList, time_ago

LESSON = RecentEntry(RecentKind.LESSON, "shared-group", 100)
PROGRAM = RecentEntry(RecentKind.PROGRAM, "/home/me/my_node.py", 200, ("-x", "ü\n"), "virtual")
RECORDING = RecentEntry(RecentKind.RECORDING, "/home/me/run.mcap", 300)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "state" / "recent.jsonl"


def noted(path: Path, *entries: RecentEntry) -> RecentList:
    recents = RecentList(path)
    for entry in entries:
        recents.note(entry)
    return recents


def test_the_next_console_knows_what_was_opened_newest_first(path: Path) -> None:
    noted(path, LESSON, PROGRAM, RECORDING)
    later = RecentList(path)
    assert later.entries == (RECORDING, PROGRAM, LESSON)
    assert later.files == [RECORDING, PROGRAM]
    assert later.lessons == {"shared-group": 100}
    assert later.troubles() == []


def test_what_is_opened_again_comes_first_and_once(path: Path) -> None:
    again = RecentEntry(RecentKind.LESSON, "shared-group", 900)
    assert noted(path, LESSON, PROGRAM, again).entries == (again, PROGRAM)


def test_so_many_files_are_kept_and_every_lesson(path: Path) -> None:
    files = [RecentEntry(RecentKind.PROGRAM, f"/{number}.py", number) for number in range(FILES_KEPT + 3)]
    recents = noted(path, LESSON, *files)
    assert recents.files == files[:2:-1]
    assert recents.lessons == {"shared-group": 100}


def test_what_is_forgotten_does_not_come_back(path: Path) -> None:
    noted(path, PROGRAM, RECORDING).forget(PROGRAM)
    assert RecentList(path).entries == (RECORDING,)


def test_what_another_console_noted_meanwhile_stays(path: Path) -> None:
    one, other = RecentList(path), RecentList(path)
    assert one.entries == other.entries == ()
    one.note(PROGRAM)
    other.note(RECORDING)
    assert RecentList(path).entries == (RECORDING, PROGRAM)


def test_a_name_that_is_no_text_is_remembered_too(path: Path) -> None:
    odd = RecentEntry(RecentKind.PROGRAM, os.fsdecode(b"/tmp/\xff.py"), 1)
    noted(path, odd)
    assert RecentList(path).entries == (odd,)


@pytest.mark.parametrize(
    "line",
    [
        b"not JSON",
        b"\xff\xfe",
        b"{}",
        b'{"kind": "letter", "what": "a", "at": 1}',
        b'{"kind": "lesson", "what": "a", "at": "yesterday"}',
        b'{"kind": "program", "what": "/a.py", "at": 1, "clock": "sun"}',
        b"[" * 100_000,
        b"",
    ],
    ids=lambda line: repr(line[:30]),
)
def test_a_broken_file_is_set_aside_and_told_of_and_the_rest_goes_on(path: Path, line: bytes) -> None:
    noted(path, LESSON, RECORDING)
    broken = path.read_bytes() + line + b"\n"
    path.write_bytes(broken)
    path.with_name("recent.jsonl.broken-1").write_text("an older one")
    recents = RecentList(path)
    assert recents.entries == (RECORDING, LESSON)
    (sentence,) = recents.troubles()
    assert f"{path}:3 is no entry" in sentence
    assert "recent.jsonl.broken-2" in sentence
    assert path.with_name("recent.jsonl.broken-2").read_bytes() == broken
    assert RecentList(path).entries == (RECORDING, LESSON)


def test_a_file_that_cannot_be_read_is_left_alone_and_told_of_once(path: Path) -> None:
    path.mkdir(parents=True)
    recents = noted(path, LESSON, PROGRAM)
    assert recents.entries == (PROGRAM, LESSON)
    (sentence,) = recents.troubles()
    assert sentence.startswith(f"{path} cannot be read")
    assert recents.troubles() == []
    assert list(path.iterdir()) == []


def test_a_home_that_cannot_be_written_is_told_of_once_and_this_console_remembers(tmp_path: Path) -> None:
    (tmp_path / "state").write_text("a file where a folder should be")
    recents = noted(tmp_path / "state" / "recent.jsonl", LESSON, PROGRAM)
    assert recents.entries == (PROGRAM, LESSON)
    assert len(recents.troubles()) == 1


def test_a_crash_in_the_middle_of_writing_leaves_the_file_as_it_was(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    noted(path, LESSON)

    def crash(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", crash)
    recents = noted(path, PROGRAM)
    assert "No space left on device" in recents.troubles()[0]
    assert RecentList(path).entries == (LESSON,)
    assert {each.name for each in path.parent.iterdir()} == {path.name, f"{path.name}.lock"}


def test_without_a_home_nothing_is_written_to_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    recents = noted(Path("~/recent.jsonl"), LESSON)
    assert "there is no home folder" in recents.troubles()[0]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("passed", "words"),
    [
        (-5, "just now"),
        (59, "just now"),
        (60, "1 min ago"),
        (3599, "59 min ago"),
        (7200, "2 h ago"),
        (86400, "1 day ago"),
        (6 * 86400, "6 days ago"),
        (7 * 86400, "1 week ago"),
        (30 * 86400, "4 weeks ago"),
        (400 * 86400, "over a year ago"),
    ],
)
def test_how_long_ago_is_said_in_words(passed: int, words: str) -> None:
    assert time_ago(1_000_000_000, 1_000_000_000 + passed) == words
