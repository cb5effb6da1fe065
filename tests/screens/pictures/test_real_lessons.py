"""How each lesson looks at a moment of its own run, by a real engine on virtual time.

The pictures, text with colours, are in ``goldens`` beside this file; ``--accept-pictures`` draws them anew.
"""

from collections.abc import Mapping, Sequence
from functools import partial

import msgspec
import pytest

from cbtui.runs.setup.lesson_setup import setup_to_judge
from lessons.catalogue import find, lessons
from sim.trace.events import AnyEvent
from tests.support.ansi import ansi_of
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_slow
from tests.support.engine_runs import run_to_end
from tests.support.goldens import SCREENS, hold

MOMENTS = {
    # The robot turns for ten seconds, and what it hears meanwhile waits, or does not.
    "single-thread": 12.48,
    "shared-group": 12.48,
    "split-groups": 12.48,
    "how-many-threads": 12.48,
    # A slow call is served, and others wait behind it.
    "exclusive-2-threads": 12.2,
    "reentrant-2-threads": 12.2,
    "reentrant-1-thread": 5.2,
    "no-groups-at-all": 12.2,
    # Nobody will ever go on.
    "call-in-a-callback": 4.2,
    "one-worker-too-few": 6.2,
    "service-in-a-service": 6.2,
    "rate-sleep-in-a-callback": 9.2,
    "spin-inside-a-callback": 9.2,
    # Something waits, and will be served.
    "three-cures": 15.7,
    "await-keeps-its-group": 5.2,
    "lock-or-group": 15.8,
    "missed-ticks": 7.8,
    "nodes-in-one-executor": 5.2,
    "two-executors": 5.2,
    "one-queue-for-all": 4.2,
    "lookup-in-a-callback": 5.6,
    "cancel-never-served": 4.2,
    "sim-time-in-a-callback": 5.6,
    "executor-per-group": 3.6,
    # Two at once, old pictures, nothing heard, a program that died.
    "overlapping-timer": 6.2,
    "stale-data": 5.6,
    "qos-never-matches": 11.2,
    "synchroniser-never-fires": 6.2,
    "lost-exceptions": 10.0,
    # A parameter, a time, an entity and a context that are not what they were.
    "parameter-sets-itself": 3.2,
    "clock-set-back": 12.2,
    "destroyed-while-spinning": 3.2,
    "after-ctrl-c": 4.6,
}
"""Seconds: when a lesson shows what it is about; others are drawn in the middle of their run."""

# No two runs on the real clock are alike.
PICTURED = [lesson.id for lesson in lessons() if lesson.setup.clock == "virtual"]

SIZES = (NARROW, WIDE)
MORE_SIZES = (NARROW, (100, 30), WIDE)
IN_EVERY_LOOK = ("shared-group", "call-in-a-callback", "lost-exceptions")
"""Callbacks that wait and messages that are lost, a deadlock, a program that died: all that has a colour."""


def events_of(lesson: str) -> Sequence[AnyEvent]:
    """What happens in the lesson's own run, up to its moment."""
    setup = setup_to_judge(find(lesson))
    return run_to_end(msgspec.structs.replace(setup, until=ns(moment_of(lesson) + 0.1))).events


def moment_of(lesson: str) -> float:
    """When a lesson is drawn, in seconds."""
    return MOMENTS.get(lesson, find(lesson).run.seconds / 2)


async def drawn(
    app: RecordedConsole, looks: Mapping[str, str], sizes: Sequence[tuple[int, int]] = MORE_SIZES
) -> dict[str, str]:
    """Return the pictures of a console in every size and in the theme of each look, by name."""
    pictures = {}
    async with app.run_test(size=sizes[0]) as pilot:
        for columns, rows in sizes:
            await pilot.resize_terminal(columns, rows)
            for look, app.theme in looks.items():
                await settle(pilot)
                pictures[f"{columns}x{rows}-{look}"] = ansi_of(app)
    return pictures


def console_on(lesson: str) -> partial[RecordedConsole]:
    """What makes a console with the lesson at its moment."""
    return partial(RecordedConsole, lesson, events_of(lesson), moment_of(lesson))


def files(lesson: str, pictures: Mapping[str, str]) -> dict[str, str]:
    """Pictures of a lesson by the name of their file."""
    return {f"{lesson}/{name}.ansi": picture for name, picture in pictures.items()}


@pytest.mark.slow
@pytest.mark.parametrize("lesson", PICTURED)
async def test_a_lesson_looks_as_it_did(lesson: str, pytestconfig: pytest.Config) -> None:
    hold(files(lesson, await drawn(console_on(lesson)(), {"dark": "dark"}, SIZES)), SCREENS, pytestconfig)


@pytest.mark.parametrize("lesson", first_slow(*IN_EVERY_LOOK))
async def test_a_lesson_looks_as_it_did_in_light_in_ascii_and_without_colours(
    lesson: str, monkeypatch: pytest.MonkeyPatch, pytestconfig: pytest.Config
) -> None:
    recorded = console_on(lesson)
    pictures = await drawn(recorded(), {"light": "light"})
    pictures |= await drawn(recorded(charset="ascii"), {"ascii": "dark"})
    monkeypatch.setenv("NO_COLOR", "1")
    pictures |= await drawn(recorded(), {"no-colour": "dark"})
    hold(files(lesson, pictures), SCREENS, pytestconfig)


@pytest.mark.bulk
async def test_a_console_that_grew_and_changed_its_theme_looks_as_one_that_begins_so() -> None:
    recorded = partial(RecordedConsole, "no-groups-at-all", events_of("no-groups-at-all"), 12.2)
    grown = await drawn(recorded(), {"dark": "dark", "light": "light"})
    for columns, rows in MORE_SIZES:
        for look in ("dark", "light"):
            app = recorded(theme=look)
            async with app.run_test(size=(columns, rows)) as pilot:
                await settle(pilot)
                await settle(pilot)
                assert ansi_of(app).splitlines() == grown[f"{columns}x{rows}-{look}"].splitlines()


def test_moments_and_pictures_are_kept_of_lessons_that_are_drawn() -> None:
    assert {*MOMENTS} <= {*PICTURED}
    assert {folder.name for folder in SCREENS.iterdir()} <= {*PICTURED}
