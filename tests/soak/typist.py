"""Types at random and waits for nothing, as fast fingers do: ``python -m tests.soak.typist``.

A real console in a terminal gets keys in bursts, while it still opens or leaves what the keys before asked
for. It must neither end by itself nor hang, must be left by ``q``, and leave no process and a whole terminal
behind. The same seed types the same; what a key falls upon is up to the machine. ``--walk`` types that one
walk again, ``--record`` keeps what came of it.
"""

import argparse
import fcntl
import os
import struct
import sys
import termios
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from unittest.mock import patch

from textual._ansi_sequences import ANSI_SEQUENCES_KEYS
from textual.keys import _character_to_key

from cbtui.terminal.ending import FAULT
from tests.soak.beginnings import any_lesson, program, recorded
from tests.soak.interruption import until_interrupted
from tests.soak.results import FILE, record, today
from tests.support.keys import KEYS, LEAVES, OTHERS, SIZES
from tests.support.processes import alive
from tests.terminal.console import TerminalConsole, opened

_BURSTS = 60
"""Bursts of keys in a walk, if the console is not left before."""
_BURST = 6
"""The most keys in a burst."""
_PAUSE = 0.4
"""The most seconds from one burst to the next; a third come without any."""
_OUT = 0.1
"""How many of the keys that would lead out are typed."""
_CLICKS = 0.1
"""The share of what is done that is a click."""
_WAYS_OUT = {"q", "ctrl+q"}
_LAST = 1500
"""How many of the characters that it drew last are told of a console that broke."""
_GRACE = 5.0
"""Seconds in which engines have to be gone when a console has been left."""
_SHELLS = {"ctrl+z"}
"""Keys that a shell is needed for."""


def _typed() -> dict[str, str]:
    """What a terminal sends for each key that has a name."""
    found = {_character_to_key(chr(code)): chr(code) for code in range(32, 127)} | {"ä": "ä"}
    for sequence, keys in ANSI_SEQUENCES_KEYS.items():
        if isinstance(keys, tuple) and len(keys) == 1:
            found.setdefault(str(keys[0].value), sequence)
    return found


_TYPED = _typed()
_KEYS = [key for key in (*KEYS, *OTHERS) if key in _TYPED and key not in _SHELLS]


_BEGINNINGS: list[Callable[[Random], tuple[str, ...]]] = [
    lambda chance: (),
    lambda chance: ("open", any_lesson(chance)),
    lambda chance: ("open", any_lesson(chance), "--threads", str(chance.randint(1, 8))),
    lambda chance: ("open", "split-groups", "--exercise"),
    lambda chance: ("open", "my_node.py"),
    lambda chance: ("replay", "run.mcap"),
    lambda chance: ("compare", "run.mcap", any_lesson(chance), "--to", "5"),
]
"""What a console is opened with."""


@dataclass
class _Walk:
    """What was typed, and what went wrong, if anything."""

    words: tuple[str, ...]
    keys: list[str] = field(default_factory=list)
    trouble: str | None = None


def walk(seed: int, number: int) -> _Walk:
    """Open a console and type into it; the same seed and number type the same."""
    chance = Random(f"{seed}/{number}")
    done = _Walk(chance.choice(_BEGINNINGS)(chance))
    with TemporaryDirectory() as home, _editing_nothing():
        before = Path.cwd()
        os.chdir(home)
        try:
            program(Path(home))
            recorded(chance, Path("run.mcap"))
            with opened(*chance.choice(SIZES[:3]), Path(home), *done.words) as console:
                done.trouble = _type(console, chance, done.keys)
        finally:
            os.chdir(before)
    return done


def _editing_nothing() -> AbstractContextManager[object]:
    return patch.dict(os.environ, {"EDITOR": "true", "VISUAL": "true"})


def _type(console: TerminalConsole, chance: Random, keys: list[str]) -> str | None:
    """Type until the console is left; say what went wrong."""
    started: set[int] = set()
    for _ in range(_BURSTS):
        if console.process.poll() is not None:
            break
        burst = [_chosen(chance) for _ in range(chance.randint(1, _BURST))]
        keys += burst
        _send(console, "".join(_TYPED.get(key, key) for key in burst))
        if chance.random() < 0.03:
            _resize(console, chance)
        console.read_for(max(0.0, chance.uniform(-_PAUSE / 2, _PAUSE)))
        started |= set(console.started())
    for _ in range(LEAVES):
        if console.process.poll() is None:
            _send(console, _TYPED["escape"])
            console.read_for(0.3)  # an escape and a key right behind it would be one key
            _send(console, "q")
            console.read_for(0.3)
    return _trouble(console, started)


def _trouble(console: TerminalConsole, started: set[int]) -> str | None:
    try:
        code = console.ended()
    except AssertionError as error:
        return str(error)
    if code or console.left_on() or "Traceback" in console.said():
        fault = Path("cbtui", FAULT)
        details = fault.read_text(encoding="utf-8") if fault.exists() else console.said()[-_LAST:]
        return f"ended with {code}, left {console.left_on() or 'nothing'} switched on: {details}"
    end = time.monotonic() + _GRACE
    while (left := [each for each in started if alive(each)]) and time.monotonic() < end:
        time.sleep(0.05)
    return f"processes {left} are left" if left else None


def _chosen(chance: Random) -> str:
    """Choose a key, by its name, or a click, as a terminal tells it."""
    while True:
        if chance.random() < _CLICKS:
            place = f"0;{chance.randint(1, 140)};{chance.randint(1, 40)}"
            return f"\x1b[<{place}M\x1b[<{place}m" * chance.randint(1, 2)
        key = chance.choice(_KEYS)
        if key not in _WAYS_OUT or chance.random() < _OUT:
            return key


def _send(console: TerminalConsole, typed: str) -> None:
    if console.process.poll() is None:
        console.press(typed)


def _resize(console: TerminalConsole, chance: Random) -> None:
    columns, rows = chance.choice(SIZES)
    fcntl.ioctl(console.terminal, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))


def main() -> int:
    """Type until the time is over; return 1 if anything broke, 130 if it was interrupted."""
    options = _parse()
    began = time.monotonic()
    walks = keys = broke = 0
    ended = False
    with until_interrupted():
        while time.monotonic() - began < 60 * options.minutes:
            number = walks if options.walk is None else options.walk
            done = walk(options.seed, number)
            walks, keys = walks + 1, keys + len(done.keys)
            if done.trouble is not None:
                broke += 1
                words = " ".join(done.words) or "the menu"
                print(f"walk {number} from {words}, {len(done.keys)} keys: {done.trouble}", file=sys.stderr)
            print(f"{walks} walks, {keys} keys, {broke} broke", file=sys.stderr, flush=True)
            if options.walk is not None:
                break
        ended = True
    print(
        f"{'' if ended else 'interrupted: '}{keys} keys in {walks} walks (seed {options.seed}), {broke} broke"
    )
    if options.record:
        figures = {"keys": keys, "walks": walks, "seconds": round(time.monotonic() - began), "broke": broke}
        record("typist", "walks", {"date": today(), "seed": options.seed, **figures})
    if broke:
        return 1
    return 0 if ended else 130


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.soak.typist", description=__doc__)
    parser.add_argument("--minutes", type=float, default=5.0, help="how long (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="what is typed (%(default)s)")
    parser.add_argument("--walk", type=int, help="type this walk alone")
    parser.add_argument("--record", action="store_true", help=f"put what came of it into {FILE.name}")
    return parser.parse_args()


if __name__ == "__main__":
    raise SystemExit(main())
