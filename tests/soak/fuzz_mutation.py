"""Makes bad inputs of good ones: bytes turned over, pieces lost, doubled, moved and put in."""

from collections.abc import Callable, Sequence
from random import Random
from typing import TypeAlias

Edit: TypeAlias = Callable[[bytes, Random, Sequence[bytes]], bytes]

_LONGEST = 20_000
"""Bytes of an input, about: what doubles itself must come to an end."""
_MOST_EDITS = 6
_STRAY = (
    *(b"", b"\0", b"\x1b[2J", b"\x1b]52;c;YQ==\x07", b"\xc2\x9b31m", b"\xe2\x80\xae", b"\xe2\x80\x8b", b"\t"),
    *(
        b"\xed\xa0\x80",
        b"\xff",
        b"\xf0\x9f\x98\x80",
        "界".encode(),
        b"\xef\xbb\xbf",
        b"\r\n",
        b"\n",
        b"\xc2\x85",
    ),
    *(b"-1", b"0", b"1e999", b"nan", b"9" * 30, b"9" * 5000, b"0x" + b"f" * 40, b"-", b"--", b"../../x"),
    *(
        b"[" * 300,
        b"{" * 300,
        b"(" * 300,
        b"[" * 5000,
        b'"',
        b"'",
        b"\\",
        b"#",
        b"=",
        b":",
        b"*",
        b"%s",
        b"{}",
    ),
)
"""What programs stumble over, whatever they read."""
_NUMBERS = (0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF, 0x7FFFFFFFFFFFFFFF, (1 << 64) - 1)


def mutated(samples: Sequence[bytes], words: Sequence[bytes], chance: Random) -> bytes:
    """One of the samples, or nothing, with a few edits; ``words`` are what means something in such inputs."""
    data = chance.choice(samples) if samples and chance.random() < 0.97 else b""
    for _ in range(chance.randint(1, _MOST_EDITS)):
        edit = chance.choice(_EDITS)
        data = edit(data, chance, words if edit is _put_in_word else samples)[:_LONGEST]
    return data


def _turn_over(data: bytes, chance: Random, _: Sequence[bytes]) -> bytes:
    if not data:
        return data
    place = chance.randrange(len(data))
    return data[:place] + bytes([data[place] ^ (1 << chance.randrange(8))]) + data[place + 1 :]


def _set(data: bytes, chance: Random, _: Sequence[bytes]) -> bytes:
    if not data:
        return data
    place = chance.randrange(len(data))
    return data[:place] + bytes([chance.randrange(256)]) + data[place + 1 :]


def _set_number(data: bytes, chance: Random, _: Sequence[bytes]) -> bytes:
    place, width = chance.randrange(len(data) + 1), chance.choice((1, 2, 4, 8))
    number = chance.choice(_NUMBERS) & ((1 << 8 * width) - 1)
    order = "little" if chance.random() < 0.7 else "big"
    return (
        data[:place]
        + number.to_bytes(width, "little" if order == "little" else "big")
        + data[place + width :]
    )


def _cut(data: bytes, chance: Random, _: Sequence[bytes]) -> bytes:
    return data[: chance.randrange(len(data) + 1)]


def _lose(data: bytes, chance: Random, _: Sequence[bytes]) -> bytes:
    start, end = _piece(data, chance)
    return data[:start] + data[end:]


def _double(data: bytes, chance: Random, _: Sequence[bytes]) -> bytes:
    start, end = _piece(data, chance)
    return data[:end] + data[start:end] * chance.choice((1, 1, 2, 50)) + data[end:]


def _move(data: bytes, chance: Random, _: Sequence[bytes]) -> bytes:
    start, end = _piece(data, chance)
    rest = data[:start] + data[end:]
    place = chance.randrange(len(rest) + 1)
    return rest[:place] + data[start:end] + rest[place:]


def _splice(data: bytes, chance: Random, samples: Sequence[bytes]) -> bytes:
    other = chance.choice(samples) if samples else b""
    start, end = _piece(other, chance)
    place = chance.randrange(len(data) + 1)
    return data[:place] + other[start:end] + data[place:]


def _put_in(data: bytes, chance: Random, _: Sequence[bytes]) -> bytes:
    place = chance.randrange(len(data) + 1)
    return data[:place] + chance.choice(_STRAY) + data[place:]


def _put_in_word(data: bytes, chance: Random, words: Sequence[bytes]) -> bytes:
    if not words:
        return _put_in(data, chance, words)
    start, end = (
        _piece(data, chance) if chance.random() < 0.3 else (place := chance.randrange(len(data) + 1), place)
    )
    return data[:start] + chance.choice(words) + data[end:]


def _piece(data: bytes, chance: Random) -> tuple[int, int]:
    start = chance.randrange(len(data) + 1)
    return start, min(len(data), start + int(chance.expovariate(1 / 12)) + 1)


_EDITS: tuple[Edit, ...] = (
    *(_turn_over, _set, _set_number, _cut, _lose, _lose, _double, _move, _splice, _splice),
    *(_put_in, _put_in, _put_in_word, _put_in_word, _put_in_word, _put_in_word),
)
