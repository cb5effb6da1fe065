"""A chain of messages on screen: the one at the moment, its path on the lanes, and what took its time."""

from pathlib import Path
from typing import Any, cast

from textual.screen import Screen

from cbtui.app import CbtuiApp
from cbtui.runs.live.live_run import ShownRun
from cbtui.screens.parts.chains import ChainPath
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.runs import RunController
from cbtui.screens.windows.chain import ChainScreen
from cbtui.widgets.lanes import Lanes
from sim.recording import RecordingMetadata, read
from sim.trace.timeline import Timeline
from tests.recording.files import write
from tests.screens.parts.hosts import FakeHost
from tests.support.builder import ns
from tests.support.console import NARROW, settle
from tests.support.exercises import until
from tests.support.pictures import text_of
from tests.trace.test_chains import Line


def line() -> Line:
    """A quick run of the chain, and a slow one, which waits for its group."""
    run = Line()
    run.node("/sensor", sense="")
    run.node("/base", clean="/raw", steer="/good", slow="")
    run.send(900, "/odom", 900)  # which the program does not use
    for start, wait in ((1000, 0), (2000, 300)):
        run.starts(start, "sense")
        run.send(start, "/raw", start, "sense")
        run.ends(start, "sense")
        if wait:
            run.waits(start, start + wait, "clean", "slow")
        run.starts(start + wait, "clean", start)
        run.send(start + wait + 100, "/good", start + 1, "clean")
        run.ends(start + wait + 100, "clean")
        run.starts(start + wait + 100, "steer", start + 1)
        run.send(start + wait + 120, "/drive", start + 2, "steer")
        run.ends(start + wait + 120, "steer")
    return run


class Runs:
    """A run that stands."""

    paused = True

    def __init__(self, timeline: Timeline) -> None:
        self.timeline = timeline
        self.run = self


def path_of(host: FakeHost, timeline: Timeline) -> tuple[ChainPath, TimeNavigation]:
    navigation = TimeNavigation(lambda: [timeline], lambda: timeline.end, host.redraw)
    runs = cast("RunController[ShownRun]", Runs(timeline))
    return ChainPath(host, runs, navigation), navigation


def test_the_run_of_the_chain_at_the_moment_is_told_with_its_dearest_step() -> None:
    host, timeline = FakeHost(answers=[("/raw", "/drive")]), line().timeline()
    path, navigation = path_of(host, timeline)
    assert path.offers("chain", ())
    assert (path.here, path.sentence) == (None, "")
    path.action_chain()
    assert path.sentence == (
        "/raw to /drive took 420 ms, 300 ms of it: clean waits, group B held by slow; "
        "the slowest 420 ms at 2.000 s"
    )
    navigation.seek(ns(1.5))
    assert path.sentence == (
        "/raw to /drive took 120 ms, 100 ms of it: clean runs; the slowest 420 ms at 2.000 s"
    )
    assert path.here is not None
    assert {timeline.entities[step.entity].spoken_name for step in path.here.steps} == {"clean", "steer"}
    navigation.seek(ns(0.5))
    assert path.sentence == ""


def test_nothing_is_followed_once_no_names_are_given() -> None:
    host, timeline = FakeHost(answers=[("/raw", "/drive"), None, ()]), line().timeline()
    path, _ = path_of(host, timeline)
    path.action_chain()
    path.action_chain()  # closed
    assert path.names == ("/raw", "/drive")
    path.action_chain()
    assert path.sentence == ""


async def test_a_chain_is_asked_for_and_its_path_marked_until_nothing_is_wanted(tmp_path: Path) -> None:
    file = tmp_path / "run.mcap"
    write(file, line().events, RecordingMetadata(title="x", clock="virtual"))
    app = CbtuiApp(start_recording=read(file))
    app.animation_level = "none"
    async with app.run_test(size=NARROW) as pilot:
        await until(pilot, lambda: bool(shown(app).query_one(Lanes).timeline.names_sent))
        await pilot.press("k")
        await until(pilot, lambda: isinstance(app.screen, ChainScreen))
        assert "Here are /raw, /good, /drive." in text_of(app)
        await pilot.press(*"raw:nowhere", "enter")
        await pilot.pause()
        assert "nothing was sent on /nowhere" in text_of(app)
        await pilot.press(*["backspace"] * len("nowhere"), *"drive", "enter")
        await until(pilot, lambda: bool(shown(app).query_one(Lanes).path))
        await settle(pilot)
        assert "/raw to /drive took 420 ms, 300 ms of it" in " ".join(text_of(app).split())
        await pilot.press("k", *["backspace"] * len("/raw:/drive"), "enter")
        await until(pilot, lambda: not shown(app).query_one(Lanes).path)


def shown(app: CbtuiApp) -> Screen[Any]:
    """The screen below any window."""
    return app.screen_stack[1]
