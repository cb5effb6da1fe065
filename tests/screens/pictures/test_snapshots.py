from collections.abc import Callable

import pytest
from msgspec import structs
from textual.pilot import Pilot

from cbtui.app import CbtuiApp
from cbtui.screens.parts.cures import CureTrial
from lessons.catalogue import find
from sim.trace.events import AnyEvent
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.daily import first_daily, first_row_daily
from tests.support.fake_session import FakeEngines
from tests.support.runs import dummy_server_run, shared_group_run, split_groups_run

Compare = Callable[..., bool]
LISTED = [
    "single-thread",
    "shared-group",
    "split-groups",
    "exclusive-2-threads",
    "reentrant-2-threads",
    "reentrant-1-thread",
    "call-in-a-callback",
    "three-cures",
    "lock-or-group",
    "stale-data",
    "two-executors",
    "lost-exceptions",
]
SIZES = pytest.mark.parametrize("size", first_daily(WIDE, NARROW), ids=["140x40", "80x24"])


@SIZES
def test_the_menu_looks_as_it_did(
    snap_compare: Compare, size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    # Lessons to come change no picture.
    listed = tuple(structs.replace(find(name), number=place) for place, name in enumerate(LISTED, start=1))
    monkeypatch.setattr("cbtui.app.lessons", lambda: listed)
    app = CbtuiApp(open_session=FakeEngines([], 0))
    assert snap_compare(app, terminal_size=size, press=["down"])


@pytest.mark.slow
@SIZES
@pytest.mark.parametrize(
    ("lesson", "events", "seconds"),
    first_row_daily(
        ("shared-group", shared_group_run().events, 14.25),
        ("split-groups", split_groups_run().events, 9.412),
        ("reentrant-2-threads", dummy_server_run().events, 5.2),
    ),
    ids=["shared-group", "split-groups", "reentrant-2-threads"],
)
def test_a_lesson_at_a_moment_looks_as_it_did(
    snap_compare: Compare, lesson: str, events: list[AnyEvent], seconds: float, size: tuple[int, int]
) -> None:
    app = RecordedConsole(lesson, events, seconds)
    assert snap_compare(app, terminal_size=size, run_before=settle)


@pytest.mark.parametrize("key", first_daily("2", "3", "4", "5"), ids=["code", "factory", "robot", "log"])
def test_a_pane_of_a_narrow_screen_looks_as_it_did(snap_compare: Compare, key: str) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)

    assert snap_compare(app, terminal_size=NARROW, press=[key], run_before=settle)


@pytest.mark.parametrize(
    "key",
    first_daily("question_mark", "t", "d", "p", "G"),
    ids=["help", "threads", "diagnoses", "set-up", "moment"],
)
def test_a_window_over_a_lesson_looks_as_it_did(
    snap_compare: Compare, key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(CureTrial, "cures", lambda *_: ())  # how far a trial is depends on the machine
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)
    assert snap_compare(app, terminal_size=NARROW, press=[key], run_before=settle)


@pytest.mark.slow
def test_a_theme_of_high_contrast_looks_as_it_did(snap_compare: Compare) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)
    app.theme = "high-contrast"
    assert snap_compare(app, terminal_size=WIDE, run_before=settle)


@pytest.mark.slow
def test_a_console_without_colours_looks_as_it_did(
    snap_compare: Compare, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    app = RecordedConsole("split-groups", split_groups_run().events, 9.412)
    assert snap_compare(app, terminal_size=WIDE, run_before=settle)


def test_an_ascii_console_looks_as_it_did(snap_compare: Compare) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25, charset="ascii")
    assert snap_compare(app, terminal_size=WIDE, run_before=settle)


@pytest.mark.parametrize(
    "keys",
    first_daily(
        ("enter", "down", "down"),
        ("space",),
        ("left_square_bracket",) * 4,
        ("less_than_sign",) * 4,
        ("greater_than_sign",) * 4,
        ("z",),
    ),
    ids=["selected", "paused", "looking-back", "zoomed-out", "zoomed-in", "enlarged"],
)
@SIZES
def test_what_keys_make_of_a_lesson_looks_as_it_did(
    snap_compare: Compare, keys: tuple[str, ...], size: tuple[int, int]
) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)
    assert snap_compare(app, terminal_size=size, press=keys, run_before=settle)


@pytest.mark.slow
@SIZES
def test_a_lost_engine_looks_as_it_did(snap_compare: Compare, size: tuple[int, int]) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)

    async def lose(pilot: Pilot[None]) -> None:
        app.engines.latest.end("the engine was killed by signal 9")
        await settle(pilot)

    assert snap_compare(app, terminal_size=size, run_before=lose)


def test_too_small_a_terminal_looks_as_it_did(snap_compare: Compare) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)
    assert snap_compare(app, terminal_size=(70, 20), run_before=settle)
