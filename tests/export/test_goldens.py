"""The text formats of the small run are, byte for byte, what a person looked at and found right."""

import pytest

from tests.export.goldens import FOLDER, NAMES, made


@pytest.mark.parametrize("name", NAMES)
def test_a_file_is_as_it_was_found_right(name: str) -> None:
    assert made(name).encode() == (FOLDER / name).read_bytes()
