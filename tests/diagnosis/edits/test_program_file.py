"""What is asked of a program's file is worked out once for each text of it."""

from pathlib import Path

import pytest

from sim.diagnosis.edits import program_file
from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.source_editor import SourceEditor
from sim.files.untrusted import program_text


def test_a_file_is_read_and_asked_again_only_once_it_has_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file, read, asked = tmp_path / "node.py", list[Path](), list[int]()

    def reading(path: Path) -> str | None:
        read.append(path)
        return program_text(path)

    def line_of(source: SourceEditor, number: int) -> str:
        asked.append(number)
        return source.text.splitlines()[number]

    monkeypatch.setattr(program_file, "program_text", reading)
    ask = asked_of_file(line_of)
    file.write_text("one\ntwo\n")
    assert [ask(str(file), number) for number in (0, 1, 0, 1)] == ["one", "two", "one", "two"]
    assert (len(read), asked) == (1, [0, 1])
    file.write_text("another\n")
    assert ask(str(file), 0) == "another"
    assert (len(read), asked) == (2, [0, 1, 0])


@pytest.mark.parametrize("text", ["not (", None, "a = 1\f\n"])
def test_what_cannot_be_read_counts_as_an_empty_file(tmp_path: Path, text: str | None) -> None:
    file = tmp_path / "node.py"
    if text is not None:
        file.write_text(text)
    assert asked_of_file(lambda source: source.text)(str(file)) == ""
    assert asked_of_file(lambda source: source.text)("null\0character") == ""
