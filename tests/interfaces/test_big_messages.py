"""Messages of millions of bytes, as pictures are: no pass over each byte of what is bytes already."""

import time
from array import array
from typing import Any

import numpy as np
import pytest

from sim.interfaces import from_cdr, message, to_cdr

Image = message("sensor_msgs", "Image")
Signed = message("std_msgs", "Int8MultiArray")
SIZE = 6_000_000
PICTURE = bytes(range(256)) * (SIZE // 256)


@pytest.mark.parametrize(
    "data",
    [PICTURE, bytearray(PICTURE), memoryview(PICTURE), array("B", PICTURE), np.frombuffer(PICTURE, "u1")],
    ids=lambda data: type(data).__name__,
)
def test_a_picture_is_assigned_encoded_and_decoded_in_one_piece(data: Any) -> None:
    began = time.process_time()
    picture = Image(data=data)
    packed = to_cdr(picture)
    assert time.process_time() - began < 0.15
    assert type(picture.data) is array
    assert picture.data.tobytes() == PICTURE
    assert from_cdr(Image, packed) == picture


def test_bytes_are_numbers_of_other_types_as_far_as_they_fit() -> None:
    assert Signed(data=b"\x01\x7f").data == array("b", [1, 127])
    with pytest.raises(AssertionError):
        Signed(data=b"\x80")
    assert Image(data=memoryview(array("H", [1, 255]))).data == array("B", [1, 255])
    with pytest.raises(AssertionError):
        Image(data=memoryview(array("H", [256])))
