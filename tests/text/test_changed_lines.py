"""What is said of the lines in which two texts differ."""

import pytest

from cbtui.text.changed_lines import changed_lines


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("a\nb\nc\n", "a\nB\nc\n", "line 2 changed"),
        ("a\nb\nc\n", "a\nb\nx\ny\nc\n", "lines 3 to 4 changed"),
        ("a\nb\nc\nd\n", "A\nb\nC\nd\n", "lines 1 to 3 changed"),
        ("a\nb\nc\n", "a\nc\n", "line 2 changed"),
        ("a\na\n", "a\na\na\n", "line 3 changed"),
        ("a\n", "a", ""),
    ],
)
def test_the_lines_that_changed_are_those_of_the_new_text(before: str, after: str, said: str) -> None:
    assert changed_lines(before, after) == said
