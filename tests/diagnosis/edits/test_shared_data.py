"""Whether one method of a node uses what another one sets."""

from pathlib import Path
from textwrap import dedent

import pytest

from sim.diagnosis.edits.shared_data import guards_what_it_changes, uses_what_is_set

LOOK_AND_KEEP = """\
def look(self): return self.x
            def keep(self, message): self.x = message"""


def used(tmp_path: Path, hear: str, tick: str, more: str = "", base: str = "Node") -> bool | None:
    """Whether ``tick`` uses what ``hear`` sets; ``more`` stands in their class."""
    text = dedent(
        f"""\
        SEEN = []
        class Own({base}):
            def hear(self, message):
                {hear}

            def tick(self):
                {tick}

            {more}
        """
    )
    file = tmp_path / "node.py"
    file.write_text(text)
    return uses_what_is_set(str(file), 3, 6)


@pytest.mark.parametrize(
    "hear",
    [
        "self.x = message.data",
        "self.x += 1",
        "self.x.append(message)",
        "self.x[0] = message",
        "self.x.y.z = message",
        "del self.x[0]",
        "self.keep(message)",
    ],
)
def test_an_attribute_that_is_set_and_used_is_shared(tmp_path: Path, hear: str) -> None:
    assert used(tmp_path, hear, "print(self.x)", "def keep(self, message): self.x = message") is True
    assert used(tmp_path, hear, "self.look()", LOOK_AND_KEEP)


@pytest.mark.parametrize(
    "hear",
    [
        "time.sleep(1)",
        "self.y = message",
        "print(self.x)",
        "self.x.publish(message)",
        "self.get_logger().info('')",
        "self.keep()",
    ],
)
def test_what_is_only_used_by_both_is_not_shared(tmp_path: Path, hear: str) -> None:
    tick = "self.x.publish(1), self.get_logger().info('')"
    assert used(tmp_path, hear, tick, "def keep(self): self.get_logger().info('')") is False


def test_a_list_of_the_module_is_shared(tmp_path: Path) -> None:
    assert used(tmp_path, "SEEN.append(1)", "print(SEEN)") is True
    assert used(tmp_path, "SEEN.append(1)", "pass") is False


@pytest.mark.parametrize(
    ("hear", "base"),
    [("keep(self)", "Node"), ("global x; x = 1", "Node"), ("pass", "Robot"), ("not (", "Node")],
)
def test_what_the_source_does_not_tell_is_not_known(tmp_path: Path, hear: str, base: str) -> None:
    assert used(tmp_path, hear, "pass", base=base) is None
    assert uses_what_is_set(str(tmp_path / "gone.py"), 1, 2) is None


@pytest.mark.parametrize(
    ("job", "is_guarded"),
    [
        ("with self.lock: self.x += 1", True),
        ("with self.lock: self.keep(1)", False),
        ("self.x += 1", False),
        ("if self.x: pass", False),
        ("self.tell(self.x)", False),
        ("with self.lock: print(self.x); self.x = 1", True),
        ("print(self.x); self.guarded()", False),
        ("self.guarded()", True),
        ("with self.file: self.x += 1", False),
    ],
)
def test_what_is_changed_is_guarded_where_each_use_of_it_is_inside_a_lock(
    tmp_path: Path, job: str, *, is_guarded: bool
) -> None:
    file = tmp_path / "node.py"
    file.write_text(
        dedent(
            f"""\
            class Own(Node):
                def __init__(self):
                    self.lock = Lock()

                def job(self):
                    {job}

                def guarded(self):
                    with self.lock:
                        self.x += 1

                def keep(self, x):
                    self.x = x
            """
        )
    )
    assert guards_what_it_changes(str(file), 5) is is_guarded
