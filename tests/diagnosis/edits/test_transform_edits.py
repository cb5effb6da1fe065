"""Edits of programs that look transforms up."""

import pytest

from sim.diagnosis.edits.transforms import ask_for_newest
from tests.diagnosis.edits.edited_source import changed


@pytest.mark.parametrize(
    "asked", ["now, Duration(seconds=1.0)", "self.get_clock().now(), timeout=Duration(seconds=1.0)", "now"]
)
def test_the_newest_transform_is_asked_for_without_a_timeout(asked: str) -> None:
    text = f'import rclpy\n\n\nfound = self.buffer.lookup_transform("map", "base", {asked})  # here\n'
    assert changed(text, ask_for_newest) == [
        "+from rclpy.time import Time",
        f'-found = self.buffer.lookup_transform("map", "base", {asked})  # here',
        '+found = self.buffer.lookup_transform("map", "base", Time())  # here',
    ]
