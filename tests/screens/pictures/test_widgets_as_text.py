"""How single widgets look on a console's screen, as plain text in ``tests/widgets/goldens``.

``pytest --accept-pictures`` keeps them as they are drawn now.
"""

from collections.abc import Iterable
from pathlib import Path

import pytest
from textual.pilot import Pilot
from textual.widget import Widget

from cbtui.app import CbtuiApp
from cbtui.widgets.checks import ChecksView
from cbtui.widgets.code import CodeView
from cbtui.widgets.description_pane import DescriptionPane
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.factory import FactoryView
from cbtui.widgets.guide import Guide
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogView
from cbtui.widgets.miniature import Miniature
from cbtui.widgets.robot import RobotView
from cbtui.widgets.shell import Prompt, ShellView
from cbtui.widgets.status_line import StatusLine
from cbtui.widgets.tabs import Tabs
from lessons.catalogue import lessons
from sim.trace.events import AnyEvent, LineCompleted, LineEnded, LineGiven, LineSaid
from tests.screens.lesson.test_teaching import Console
from tests.screens.pictures.test_real_lessons import events_of
from tests.support.builder import ns
from tests.support.console import NARROW, WIDE, RecordedConsole, predict, settle
from tests.support.exercises import Engines, ExerciseConsole, is_judged, until
from tests.support.fake_session import FakeEngines
from tests.support.goldens import WIDGETS, hold
from tests.support.pictures import picture_of
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events
"""In which all wait for the timer while the robot turns."""

LONG = (80, 54)
"""High enough for the whole of a guide."""

PANES: dict[str, tuple[str, type[Widget]]] = {
    "3": ("factory", FactoryView),
    "4": ("robot", RobotView),
    "5": ("log", LogView),
}
"""Panes that show the moment, by their keys."""
LINES: dict[str, type[Widget]] = {
    "status-line": StatusLine,
    "lanes": Lanes,
    "tabs": Tabs,
    "diagnosis-line": DiagnosisLine,
    "keys": KeyBar,
}
WINDOWS = {"g": "group", "x": "export"}
"""Windows that open over a lesson, by their keys."""

SAID: list[AnyEvent] = [
    LineGiven(ns(3.0), 1, "ros2 topic list"),
    LineSaid(ns(3.0), 1, "/odom", False),
    LineSaid(ns(3.0), 1, "/scan", False),
    LineEnded(ns(3.0), 1, 0),
    LineGiven(ns(4.0), 2, "ros2 topic type /nothing"),
    LineSaid(ns(4.0), 2, "Unknown topic '/nothing'", True),
    LineEnded(ns(4.0), 2, 1),
]


async def press(pilot: Pilot[None], *keys: str) -> None:
    for key in keys:
        await pilot.press(key)
        await settle(pilot)


def pictures_of(app: CbtuiApp, widgets: Iterable[tuple[str, type[Widget]]]) -> dict[str, str]:
    return {f"{name}.txt": picture_of(app, app.screen.query_one(widget)) for name, widget in widgets}


@pytest.mark.slow
async def test_a_run_in_which_everybody_waits(pytestconfig: pytest.Config) -> None:
    app = RecordedConsole("shared-group", EVENTS, 14.25)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        pictures = pictures_of(app, LINES.items())
        await press(pilot, "enter", "down", "down")
        pictures |= pictures_of(app, [("lanes-selected", Lanes), ("keys-on-lanes", KeyBar)])
        for key, window in WINDOWS.items():
            await press(pilot, key)
            pictures[f"window-{window}.txt"] = picture_of(app, app.screen.query_one(".window"))
            await press(pilot, "escape")
        await press(pilot, "escape", "z")
        for key, pane in PANES.items():
            await press(pilot, key)
            pictures |= pictures_of(app, [pane])
        await pilot.resize_terminal(*LONG)
        await press(pilot, "1")
        pictures |= pictures_of(app, [("guide", Guide)])
        await pilot.resize_terminal(*WIDE)
        await press(pilot, "z", "enter")
        pictures |= pictures_of(app, [("lanes-selected-wide", Lanes)])
    hold(pictures, WIDGETS, pytestconfig)


async def test_a_prompt_with_completions(pytestconfig: pytest.Config) -> None:
    events = sorted([*EVENTS, *SAID], key=lambda event: event.t)
    app = RecordedConsole("shared-group", events, 5.0)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await press(pilot, "colon")
        app.screen.query_one(Prompt).insert_text_at_cursor("ros2 topic ")
        await press(pilot, "tab")
        app.engines.latest._deliver([LineCompleted(ns(5.0), 3, 11, ("echo", "hz", "info", "list", "pub"))])
        await settle(pilot)
        pictures = pictures_of(app, [("shell", ShellView), ("keys-of-the-prompt", KeyBar)])
    hold(pictures, WIDGETS, pytestconfig)


async def test_the_question_before_a_run(pytestconfig: pytest.Config) -> None:
    app = Console()
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await press(pilot, "2")
        picture = picture_of(app, app.screen.query_one(".window"))
    hold({"window-prediction.txt": picture}, WIDGETS, pytestconfig)


async def test_what_the_menu_tells_of_a_lesson(
    pytestconfig: pytest.Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cbtui.screens.parts.previews.HOVER_DELAY", 0.001)
    engines = FakeEngines(EVENTS, ns(20))
    app = CbtuiApp(open_session=engines)
    app.animation_level = "none"
    predict(app, lessons()[1].id)
    async with app.run_test(size=WIDE) as pilot:
        await press(pilot, "home", "down")
        await until(pilot, lambda: bool(engines.sessions))
        engines.latest.end()
        await until(pilot, lambda: app.screen.query_one(Miniature).subject is not None)
        await settle(pilot)
        pictures = pictures_of(app, [("menu-about", DescriptionPane), ("menu-miniature", Miniature)])
    hold(pictures, WIDGETS, pytestconfig)


@pytest.mark.slow
async def test_a_callback_that_stands_in_a_call(pytestconfig: pytest.Config) -> None:
    events = events_of("call-in-a-callback")
    assert events
    app = RecordedConsole("call-in-a-callback", events, 4.2)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        pictures = pictures_of(app, [("lanes-of-a-client", Lanes), ("factory-of-a-client", FactoryView)])
        await pilot.resize_terminal(*NARROW)
        await press(pilot, "2", "z")
        pictures |= pictures_of(app, [("code", CodeView)])
    hold(pictures, WIDGETS, pytestconfig)


async def test_the_checks_of_an_exercise(
    pytestconfig: pytest.Config, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    engines = Engines(EVENTS)
    app = ExerciseConsole(engines)
    async with app.run_test(size=(80, 40)) as pilot:
        await settle(pilot)
        engines.finish()
        await until(pilot, lambda: is_judged(app.exercise))
        await settle(pilot)
        pictures = pictures_of(app, [("checks", ChecksView)])
    hold(pictures, WIDGETS, pytestconfig)
