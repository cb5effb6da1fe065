from collections.abc import Callable

import pytest

from cbtui.app import CbtuiApp
from sim.trace.events import AnyEvent
from tests.support.console import NARROW, WIDE, RecordedConsole, settle
from tests.support.fake_session import FakeEngines
from tests.support.runs import dummy_server_run, shared_group_run, split_groups_run

Compare = Callable[..., bool]
SIZES = pytest.mark.parametrize("size", [NARROW, WIDE], ids=["80x24", "140x40"])


@SIZES
def test_the_menu_looks_as_it_did(snap_compare: Compare, size: tuple[int, int]) -> None:
    app = CbtuiApp(open_session=FakeEngines([], 0))
    assert snap_compare(app, terminal_size=size, press=["down"])


@SIZES
@pytest.mark.parametrize(
    ("lesson", "events", "seconds"),
    [
        ("shared-group", shared_group_run().events, 14.25),
        ("split-groups", split_groups_run().events, 9.412),
        ("reentrant-2-threads", dummy_server_run().events, 5.2),
    ],
    ids=["shared-group", "split-groups", "reentrant-2-threads"],
)
def test_a_lesson_at_a_moment_looks_as_it_did(
    snap_compare: Compare, lesson: str, events: list[AnyEvent], seconds: float, size: tuple[int, int]
) -> None:
    app = RecordedConsole(lesson, events, seconds)
    assert snap_compare(app, terminal_size=size, run_before=settle)


@pytest.mark.parametrize("key", ["2", "3", "4"], ids=["code", "robot", "log"])
def test_a_pane_of_a_narrow_screen_looks_as_it_did(snap_compare: Compare, key: str) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)

    assert snap_compare(app, terminal_size=NARROW, press=[key], run_before=settle)


@pytest.mark.parametrize("key", ["question_mark", "t"], ids=["help", "threads"])
def test_a_window_over_a_lesson_looks_as_it_did(snap_compare: Compare, key: str) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)
    assert snap_compare(app, terminal_size=NARROW, press=[key], run_before=settle)


def test_a_light_theme_looks_as_it_did(snap_compare: Compare) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25)
    app.theme = "textual-light"
    assert snap_compare(app, terminal_size=WIDE, run_before=settle)


def test_a_console_without_colours_looks_as_it_did(
    snap_compare: Compare, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    app = RecordedConsole("split-groups", split_groups_run().events, 9.412)
    assert snap_compare(app, terminal_size=WIDE, run_before=settle)


def test_an_ascii_console_looks_as_it_did(snap_compare: Compare) -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 14.25, charset="ascii")
    assert snap_compare(app, terminal_size=WIDE, run_before=settle)
