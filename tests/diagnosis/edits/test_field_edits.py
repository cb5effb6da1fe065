"""Edits of the values that a program gives to the fields of a message."""

import pytest

from sim.diagnosis.edits.fields import write_float
from tests.diagnosis.edits.edited_source import MARK, edited


@pytest.mark.parametrize(
    ("given", "float_given"),
    [
        ("t.linear.x = 1", "t.linear.x = 1.0"),
        ("t.linear.x = -2", "t.linear.x = -2.0"),
        ("t.linear.x = self.speed", "t.linear.x = float(self.speed)"),
        ("t.linear = Vector3(x=1, y=0.0)", "t.linear = Vector3(x=1.0, y=0.0)"),
        ("t.linear.y = 1", None),
        ("move(1)", None),
    ],
)
def test_a_float_is_written_for_a_field(given: str, float_given: str | None) -> None:
    text = f"def tick():\n    {given}  {MARK}\n"
    expected = None if float_given is None else text.replace(given, float_given)
    assert edited(text, write_float, "x") == expected
