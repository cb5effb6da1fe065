"""What has outlived a full collection is not looked at by the next, until a screen is left."""

import gc
from collections.abc import Callable, Iterator

import pytest
from textual._styles_cache import StylesCache

from cbtui.screens.menu import MenuScreen
from cbtui.terminal.garbage_collector import collect_closed_screens, collect_now, survivors_frozen
from cbtui.terminal.pending_keys import IDLE, PendingKeysApp
from tests.support.console import WIDE, RecordedConsole, settle
from tests.support.runs import shared_group_run


class Knot:
    """Something that only a collection can remove, and that counts what is left of its kind."""

    left = 0

    def __init__(self) -> None:
        self.me = self
        Knot.left += 1

    def __del__(self) -> None:
        Knot.left -= 1


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    frozen = gc.get_freeze_count()
    gc.disable()  # which would collect at a moment that hangs on what ran before
    gc.unfreeze()
    gc.collect()
    Knot.left = 0
    yield
    gc.enable()
    gc.unfreeze()
    if frozen:
        gc.freeze()


@pytest.mark.slow
def test_a_collection_takes_what_is_new_and_sets_the_rest_aside() -> None:
    with survivors_frozen():
        kept = Knot()
        Knot()
        collect_now()
        assert Knot.left == 1
        del kept
        collect_now()
        assert Knot.left == 1  # set aside, and so not seen to be garbage
        collect_closed_screens()
        assert Knot.left == 0


@pytest.mark.slow
def test_nothing_is_collected_early_or_set_aside_without_being_asked() -> None:
    frozen = gc.get_freeze_count()  # Python 3.12 sets some aside by itself
    Knot()
    collect_now()
    assert Knot.left == 1
    gc.collect()
    assert Knot.left == 0
    assert gc.get_freeze_count() == frozen


def test_what_others_set_aside_is_left_alone() -> None:
    gc.freeze()
    collect_closed_screens()
    assert gc.get_freeze_count() > 0


def test_afterwards_all_is_as_before() -> None:
    with survivors_frozen():
        gc.collect()
        assert gc.get_freeze_count() > 0
    assert gc.get_freeze_count() == 0


async def test_what_would_hold_up_a_key_waits_until_nobody_types(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    done: list[float] = []
    told: list[tuple[float, list[float]]] = []
    timers: list[tuple[float, Callable[[], object]]] = []
    monkeypatch.setattr("cbtui.terminal.pending_keys.monotonic", lambda: now[0])
    app = PendingKeysApp()
    async with app.run_test() as pilot:
        monkeypatch.setattr(app, "set_timer", lambda delay, call: timers.append((delay, call)))
        await pilot.press("x")
        app.when_idle(lambda: done.append(now[0]))
        now[0] += IDLE - 0.5
        await pilot.press("y")
        now[0] += 0.5
        for _ in range(2):
            delay, call = timers.pop()
            told.append((delay, [*done]))
            call()
            now[0] += IDLE - 0.5
    assert told == [(IDLE, []), (IDLE - 0.5, [])]
    assert done == [100.0 + IDLE + IDLE - 0.5]


@pytest.mark.parametrize(("idle", "collected"), [(60.0, 0), (0.0, 1)])
async def test_what_a_lesson_leaves_is_collected_once_nobody_types(
    monkeypatch: pytest.MonkeyPatch, idle: float, collected: int
) -> None:
    done: list[str] = []
    monkeypatch.setattr("cbtui.terminal.pending_keys.IDLE", idle)
    monkeypatch.setattr("cbtui.terminal.ending.collect_closed_screens", lambda: done.append("collected"))
    app = RecordedConsole("shared-group", shared_group_run().events, 2.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        await pilot.press("q")
        await settle(pilot)
        assert isinstance(app.screen, MenuScreen)
        assert len(done) == collected


@pytest.mark.slow
async def test_a_screen_that_was_left_is_not_kept_for_its_colours() -> None:
    app = RecordedConsole("shared-group", shared_group_run().events, 2.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        shown = StylesCache.get_inner_outer.cache_info().currsize
        await pilot.press("q")
        await pilot.pause()
        assert isinstance(app.screen, MenuScreen)
        assert 0 < StylesCache.get_inner_outer.cache_info().currsize < shown
