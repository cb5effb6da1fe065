import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import replace
from typing import ClassVar

import pytest
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Vertical
from textual.events import Click, Event, Key, MouseDown, MouseUp
from textual.geometry import Region
from textual.pilot import Pilot
from textual.widget import Widget
from textual.widgets import Input

from cbtui.keys.action import Scope
from cbtui.keys.actions import actions_of
from cbtui.keys.bindings import perform
from cbtui.screens.menu import MenuScreen
from cbtui.screens.windows.setup import SetupScreen
from cbtui.terminal import key_turns
from cbtui.terminal.ending import EndingApp
from cbtui.terminal.pending_keys import MOUNT_TIMEOUT
from cbtui.terminal.textual_internals import SafeCommandPalette, is_being_removed
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.lanes.rows import MemberLane
from cbtui.widgets.lanes.selection import Selection
from cbtui.widgets.log.lines import LogLines
from sim.trace.events import EntityId, EntityKind
from tests.support.console import WIDE, RecordedConsole, settle
from tests.support.daily import first_daily
from tests.support.exercises import until
from tests.support.runs import split_groups_run

_FOURTH = "4"
_LOG = "5"
_AT_MOST = 60.0


class Slow(Widget):
    """A widget whose children come when it is told."""

    def __init__(self, told: asyncio.Event) -> None:
        super().__init__()
        self._told = told

    async def on_mount(self) -> None:
        """Wait, though not so long that a test that fails never ends."""
        with suppress(TimeoutError):
            async with asyncio.timeout(_AT_MOST):
                await self._told.wait()


class Console(EndingApp):
    """One that notes keys."""

    BINDINGS: ClassVar[list[BindingType]] = [("x", "note", ""), ("o", "open", "")]

    def __init__(self) -> None:
        super().__init__()
        self.told = asyncio.Event()
        self.noted = 0

    def compose(self) -> ComposeResult:
        yield Vertical()

    def mount_slowly(self) -> None:
        """Begin to mount a widget."""
        self.query_one(Vertical).mount(Slow(self.told))

    def action_note(self) -> None:
        """Note that the key took effect."""
        self.noted += 1

    async def action_open(self) -> None:
        """Open a line to type into, as slowly as on a busy machine."""
        await asyncio.sleep(3 * key_turns.PATIENCE)
        line = Input()
        await self.query_one(Vertical).mount(line)
        line.focus()


async def test_what_is_typed_behind_a_key_that_opens_a_line_slowly_goes_to_the_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(key_turns, "PATIENCE", 0.3)
    app = Console()
    async with app.run_test() as pilot:
        for key in "ox2":
            app.post_message(Key(key, key))
        await until(pilot, lambda: bool(app.query(Input)) and app.query_one(Input).value == "x2")
        assert not app.noted


async def until_told_to_end(app: Console) -> None:
    """Wait until the app has let itself be told to end."""
    async with asyncio.timeout(_AT_MOST / 2):
        while not app._exit:
            await asyncio.sleep(0.01)


async def test_keys_take_effect_when_the_widgets_that_are_there_are_mounted() -> None:
    app = Console()
    async with app.run_test() as pilot:
        await pilot.press("x")
        assert app.noted == 1
        app.mount_slowly()
        app.post_message(Key("x", "x"))
        await asyncio.sleep(0.1)
        assert app.is_mounting
        assert app.noted == 1
        app.told.set()
        await until(pilot, lambda: app.noted == 2)


async def test_an_app_that_is_told_to_end_ends_when_its_widgets_are_mounted() -> None:
    app = Console()
    async with app.run_test():
        app.mount_slowly()
        app.exit()
        await asyncio.sleep(0.1)
        ended = [app._exit]
        app.told.set()
        await until_told_to_end(app)
    assert ended == [False]


async def test_a_widget_that_is_never_mounted_keeps_nobody_from_leaving(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("cbtui.terminal.ending.MOUNT_TIMEOUT", MOUNT_TIMEOUT / 100)
    app = Console()
    async with app.run_test():
        app.mount_slowly()
        app.exit()
        await until_told_to_end(app)
        app.told.set()


async def test_a_click_that_comes_when_the_last_screen_is_closed_is_nobodys() -> None:
    app = Console()
    async with app.run_test():
        with pytest.MonkeyPatch.context() as patch:
            patch.setitem(app._screen_stacks, app.current_mode, [])
            await app.on_event(MouseDown(None, 1, 1, 0, 0, 1, False, False, False))
        assert app.is_running


async def test_what_a_closed_screen_left_and_could_not_end_is_a_fault() -> None:
    async def fail() -> None:
        raise OSError("as planned")

    app = Console()
    with pytest.raises(OSError, match="as planned"):
        async with app.run_test():
            app.end_later(fail())


async def test_keys_right_behind_the_one_that_opens_a_lesson_are_the_lessons() -> None:
    app = RecordedConsole("exclusive-2-threads", split_groups_run().events, 4.0)
    async with app.run_test(size=WIDE) as pilot:
        await pilot.press("q")
        for key in (_FOURTH, _LOG):
            app.post_message(Key(key, None))
        await until(pilot, lambda: bool(app.screen.query(LogLines)))
        await until(pilot, lambda: app.screen.query_one(LogLines).has_focus)


async def search_themes(app: RecordedConsole, pilot: Pilot[None]) -> None:
    app.search_themes()
    await pilot.pause()


@pytest.mark.slow
@pytest.mark.parametrize(
    "open_window",
    first_daily(
        *(lambda _, pilot, key=key: pilot.press(key) for key in ("question_mark", "ctrl+p", "d", "t")),
        search_themes,
    ),
)
async def test_a_window_that_is_left_twice_at_once_does_not_take_the_lesson_with_it(
    open_window: Callable[[RecordedConsole, Pilot[None]], Awaitable[None]],
) -> None:
    app = RecordedConsole("split-groups", split_groups_run().events, 4.0)
    async with app.run_test(size=WIDE) as pilot:
        lesson = app.screen
        await open_window(app, pilot)
        opened = app.screen
        assert opened is not lesson
        opened.dismiss(None)
        opened.dismiss(None)
        await pilot.pause()
        assert app.screen is lesson


@pytest.mark.slow
async def test_two_quick_clicks_on_the_key_that_leaves_a_lesson_leave_the_lesson_alone() -> None:
    app = RecordedConsole("split-groups", split_groups_run().events, 4.0)
    async with app.run_test(size=WIDE) as pilot:
        bar = app.screen.query_one(KeyBar)
        row = "".join(run.text for run in bar.rows(bar.size)[0])
        place = row.index("menu")
        down, up = (kind(bar, place, 0, 0, 0, 1, False, False, False) for kind in (MouseDown, MouseUp))
        click = Click.from_event(bar, up)
        for event in (down, up, click, click):
            bar.post_message(event)
        await until(pilot, lambda: isinstance(app.screen, MenuScreen))
        await pilot.pause()
        assert isinstance(app.screen, MenuScreen)
    assert app.return_code is None


@pytest.mark.slow
async def test_an_action_of_a_widget_that_has_the_keys_no_more_is_not_done() -> None:
    app = RecordedConsole("split-groups", split_groups_run().events, 4.0)
    async with app.run_test(size=WIDE):
        app.screen.set_focus(None)
        for action in actions_of(Scope.LOG):
            if action.scope is Scope.LOG:
                await perform(app, action)


@pytest.mark.slow
async def test_a_palette_that_was_closed_looks_for_nothing_more() -> None:
    app = RecordedConsole("split-groups", split_groups_run().events, 4.0)
    async with app.run_test(size=WIDE) as pilot:
        await pilot.press("ctrl+p")
        palette = app.screen
        assert isinstance(palette, SafeCommandPalette)
        palette.dismiss(None)
        looking = palette._gather_commands("pause")
        await pilot.pause()
    assert looking is None


@pytest.mark.slow
async def test_keys_of_a_screen_that_goes_away_are_painted_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    app = RecordedConsole("split-groups", split_groups_run().events, 4.0)
    async with app.run_test(size=WIDE) as pilot:
        lesson = app.screen
        bar = lesson.query_one(KeyBar)
        lesson.dismiss(None)
        await until(pilot, lambda: is_being_removed(bar))
        monkeypatch.setattr(bar, "rows", lambda _: pytest.fail("the lanes, which it asks, may have gone"))
        bar.changed()
        bar._exchange_repaint_regions()  # as a screen does whose picture comes after
        assert app.screen is not lesson


async def test_a_click_on_what_was_just_removed_is_nobodys(monkeypatch: pytest.MonkeyPatch) -> None:
    app = Console()
    async with app.run_test() as pilot:
        forwarded: list[Event] = []
        monkeypatch.setattr(app.screen, "_forward_event", forwarded.append)
        gone = Widget()
        for under in (app.screen, gone):
            monkeypatch.setattr(app, "get_widget_at", lambda *_, under=under: (under, Region()))
            app.post_message(MouseDown(None, 1, 1, 0, 0, 1, False, False, False))
            await pilot.pause()
        assert len(forwarded) == 1


@pytest.mark.slow
async def test_the_group_of_a_callback_that_a_new_run_has_yet_to_make_is_asked_for_among_all() -> None:
    app = RecordedConsole("split-groups", split_groups_run().events, 4.0)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        lanes = app.screen.query_one(Lanes)
        entity = next(each for each in lanes.timeline.entities.values() if each.kind is EntityKind.TIMER)
        group = lanes.timeline.groups[entity.group]
        lanes.selection = Selection(MemberLane(replace(entity, id=EntityId(999)), group))
        await pilot.press("g")
        assert isinstance(app.screen, SetupScreen)
