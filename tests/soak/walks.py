"""Walks through the console: from a place to begin with, one step at random after another, and out."""

import asyncio
import multiprocessing
import os
import threading
import time
from collections import Counter
from collections.abc import Awaitable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

from textual.pilot import Pilot, WaitForScreenTimeout

from cbtui.app import CbtuiApp
from tests.soak.beginnings import BEGUN, WITH_ENGINE, WITHOUT_ENGINE
from tests.support.builder import ns
from tests.support.fake_session import FakeEngines
from tests.support.keys import KEYS, OTHERS, SIZES, Place, Step, Text, leave, take

LONGEST = 150
"""Steps of a walk, if the console is not left before."""
ENGINES = 0.2
"""The share of walks that run real engines."""
_TEXTS = (
    *("ros2 node list", "ros2 topic echo /odom", "ros2 service call /motor_power std_srvs/srv/SetBool"),
    *("odom", "[", "3.5", "-1", "999999", "shared", "./my_node.py", "/no/such/place", "ros2 nonsense"),
)
_WAYS_OUT = {"q", "ctrl+q"}
_OUT = 0.15
"""How many of the steps that would lead out are taken: a walk that ends at once sees nothing."""
_PATIENCE = 15.0
"""Real seconds after which a console that does not answer is said to hang."""
_GRACE = 5.0
"""Real seconds in which engines have to be gone when a console has been left."""


@dataclass
class Walk:
    """What was done on a walk, where it led, and what went wrong, if anything."""

    name: str
    steps: list[Step] = field(default_factory=list)
    reached: Counter[str] = field(default_factory=Counter)
    in_vain: int = 0
    """How often it was waited in vain for a step, though the console answered then."""
    trouble: str | None = None


def walk(seed: int, number: int, most: int = LONGEST) -> Walk:
    """Go for a walk of at most so many steps; the same seed and number choose the same steps."""
    chance = Random(f"{seed}/{number}")
    engines = chance.random() < ENGINES
    name, begin = chance.choice(list((WITH_ENGINE if engines else WITHOUT_ENGINE).items()))
    done = Walk(name)
    troubles: list[str] = []
    with TemporaryDirectory() as home, _nobodys(Path(home)), _listened_to(troubles):
        try:
            asyncio.run(_go(begin(chance, Path(home)), chance, done, min(most, chance.randint(10, LONGEST))))
        except Exception as error:  # noqa: BLE001 - whatever it is, it is what is looked for
            last = f"at step {len(done.steps)}, {done.steps[-1:]}"
            troubles.insert(0, f"{type(error).__name__}: {error} {last}")
        troubles += _left_behind()
    done.trouble = "; ".join(troubles) or None
    return done


async def _go(app: CbtuiApp, chance: Random, done: Walk, most: int) -> None:
    app.animation_level = "none"
    async with app.run_test(size=chance.choice(SIZES[:3]), notifications=True) as pilot:
        await pilot.pause()
        while len(done.steps) < most and app._exit is False:
            done.steps.append(_chosen(chance))
            await _in_time(take(pilot, done.steps[-1]), pilot, done)
            done.reached[type(app.screen).__name__] += 1
            _play_on(app, BEGUN + len(done.steps) / 5)
        _perhaps_lose_an_engine(app, chance)
        await _in_time(leave(pilot), pilot, done)
        assert app._exit, f"q does not lead out of {type(app.screen).__name__}"
    sessions = getattr(app._open_session, "sessions", [])
    assert all(session.stopped for session in sessions if session.started), "a session was not stopped"


async def _in_time(step: Awaitable[None], pilot: Pilot[None], done: Walk) -> None:
    """Wait for a step; asked once more, a console has to answer in time.

    Textual's pilot waits for all widgets that there are, in vain for one that is removed before it answers.
    """
    try:
        async with asyncio.timeout(_PATIENCE):
            await step
    except (TimeoutError, WaitForScreenTimeout):
        done.in_vain += 1
        async with asyncio.timeout(_PATIENCE):
            await pilot.pause()


def _chosen(chance: Random) -> Step:
    """Choose a step; those that lead out are rarer."""
    while True:
        match chance.random():
            case share if share < 0.73:
                step: Step = chance.choice(KEYS)
            case share if share < 0.78:
                step = "escape"  # out of a window: there is more to see without
            case share if share < 0.84:
                step = chance.choice(OTHERS)
            case share if share < 0.88:
                step = Text(chance.choice(_TEXTS))
            case share if share < 0.91:
                step = chance.choice(SIZES)
            case _:
                step = Place(chance.randrange(140), chance.randrange(40))
        if step not in _WAYS_OUT or chance.random() < _OUT:
            return step


def _play_on(app: CbtuiApp, seconds: float) -> None:
    """Let the run that is open go on, where no engine does that."""
    if isinstance(app._open_session, FakeEngines) and app._open_session.sessions:
        app._open_session.latest.play(ns(seconds))


def _perhaps_lose_an_engine(app: CbtuiApp, chance: Random) -> None:
    if chance.random() < 0.5:
        return
    if isinstance(app._open_session, FakeEngines) and app._open_session.sessions:
        app._open_session.latest.end("it was killed")
    else:
        for process in multiprocessing.active_children():
            process.kill()


def _left_behind() -> Iterator[str]:
    """Say which engines and readers there still are."""
    end = time.monotonic() + _GRACE
    while time.monotonic() < end and (multiprocessing.active_children() or _readers()):
        time.sleep(0.05)
    for process in multiprocessing.active_children():
        yield f"{process.name} is left"
        process.kill()
    yield from (f"thread {name} is left" for name in _readers())


def _readers() -> list[str]:
    return [thread.name for thread in threading.enumerate() if thread.name == "trace-reader"]


@contextmanager
def _nobodys(home: Path) -> Iterator[None]:
    """Let recordings, pictures and what is remembered land where nobody looks; no editor is opened."""
    folders = {f"XDG_{kind}_HOME": str(home / kind.lower()) for kind in ("CONFIG", "DATA", "STATE", "CACHE")}
    before = Path.cwd()
    with patch.dict(os.environ, {**folders, "HOME": str(home), "EDITOR": "true", "VISUAL": "true"}):
        os.chdir(home)
        try:
            yield
        finally:
            os.chdir(before)


@contextmanager
def _listened_to(troubles: list[str]) -> Iterator[None]:
    """Take down what threads of the console's die of: nobody else would hear it."""

    def note(death: Any) -> None:
        troubles.append(f"thread {death.thread.name}: {death.exc_type.__name__}: {death.exc_value}")

    with patch.object(threading, "excepthook", note):
        yield
