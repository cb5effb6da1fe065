"""Which lines of a program touch data that threads may share."""

import pytest

from sim.engine.exploration.shared_data import shared_data

SOURCE = """
class Mine:
    def __init__(self):
        self.n = 0
        self.name = "mine"

    def tick(self):
        n = self.n
        self.n = n + 1
        self.log(self.name)
        self.items.append(n)
        self.table["a"] = 1
        del self.table["a"]
        message = Twist()
        message.linear.x = 1.0
        heappush(self.heap, n)
        mine = []
        mine.append(n)

def count():
    global total
    total += 1
    return lambda: seen.add(total)
"""


def test_lines_that_read_and_write_attributes_and_globals_are_found() -> None:
    found = shared_data(SOURCE)
    by_text = {SOURCE.splitlines()[line - 1].strip(): names for line, names in found.lines.items()}
    assert by_text["n = self.n"] == {".n": False}
    assert by_text["self.n = n + 1"] == {".n": True}
    assert by_text["self.items.append(n)"][".items"]
    assert by_text['self.table["a"] = 1'] == by_text['del self.table["a"]'] == {".table": True}
    assert by_text["heappush(self.heap, n)"][".heap"]
    assert by_text["total += 1"]["total"]
    assert by_text["return lambda: seen.add(total)"]["seen"]


def test_what_only_init_writes_a_local_name_and_an_object_of_the_functions_own_do_not_change() -> None:
    assert shared_data(SOURCE).written == {".n", ".items", ".table", ".heap", "total", "seen"}


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("self.n += message.data", ".n"),
        ("self.n = self.n + float(message)", ".n"),
        ("self.table[0] += abs(x)", ".table"),
        ("self.stats.n += len(x)", ".n"),
        ("self.n += 1", None),  # CPython cannot leave it
        ("self.n = self.n + self.step", None),
        ("self.n = message.data + self.n", None),  # read after the call
        ("self.n = float(message)", None),
    ],
)
def test_a_line_that_calls_between_reading_and_writing_is_split(line: str, name: str | None) -> None:
    found = shared_data(f"def tick(self, message, x):\n    {line}\n")
    assert found.split == ({} if name is None else {2: name})


@pytest.mark.parametrize("source", ["", "def f(:\n", "x = 1\0"])
def test_a_source_without_functions_or_sense_has_none(source: str) -> None:
    assert not shared_data(source).lines
