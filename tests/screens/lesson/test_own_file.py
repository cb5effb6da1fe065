"""A learner's own file on the lesson screen."""

from pathlib import Path

from cbtui.app import CbtuiApp
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import of_processes
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.parts.own_file import FileRead
from cbtui.widgets.key_bar import KeyBar
from sim.engine.commands import CallService, Pause
from sim.engine.setup import ProgramSetup, RealRos
from sim.probes.on_path.cbtui_probe import PROTOCOL
from sim.real.wire import Hello
from sim.trace.events import Reason, RunEnded, TimePassed
from tests.support.builder import Run
from tests.support.console import NARROW, TALL, WIDE, settle
from tests.support.exercises import until
from tests.support.fake_session import FakeEngines
from tests.support.pictures import text_of
from tests.support.runs import dummy_server_run, ns


async def test_a_file_is_run_with_its_arguments_and_shown_like_a_lesson(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("print('mine')\n")
    engines = FakeEngines(dummy_server_run().events, ns(5.2))
    app = CbtuiApp(start_file=(file, ["-x", "1"], "real"), open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        setup = engines.latest.setup
        assert (setup.programs, setup.clock) == ((ProgramSetup(str(file), ("-x", "1")),), "real")
        picture = text_of(app)
        assert picture.splitlines()[0].startswith(" my_node.py")
        assert " real " in picture.splitlines()[0]
        assert "Your own file, on real time." in picture
        await pilot.press("2")
        await settle(pilot)
        assert "print('mine')" in text_of(app)


async def test_in_a_file_s_calls_the_first_service_it_offers_and_real_time_can_be_paused(
    tmp_path: Path,
) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    engines = FakeEngines(dummy_server_run().events, ns(2.0))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.press("s", "space", "n")
        await settle(pilot)
        assert engines.latest.commands == [CallService(None, True), Pause()]


async def test_without_a_set_bool_service_s_says_what_calls_another_one(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    run = Run()
    run.service(run.exclusive(run.node("/n")), "/reset", "reset", interface_type="std_srvs/srv/Trigger")
    engines = FakeEngines(run.events, ns(2.0))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        assert "s service" not in text_of(app)
        await pilot.press("S")
        await settle(pilot)
        [told] = [note.message for note in app._notifications]
        assert told.startswith("There is no SetBool service to call; : takes ros2 service call")
        assert engines.latest.commands == []


async def test_on_watched_processes_a_key_that_does_nothing_says_why_and_is_not_in_the_footer(
    tmp_path: Path,
) -> None:
    hello = Hello(0, PROTOCOL, 17, "3.12.3", "jazzy", ["python3", str(tmp_path / "node.py")], 0)
    program = of_processes(RealRos(watched=str(tmp_path)), [hello])
    app = CbtuiApp(start_program=program, open_session=FakeEngines(dummy_server_run().events, ns(2.0)))
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        for key, label, sentence in (
            ("t", "threads", "These processes are only watched: they can be neither changed nor run again"),
            ("g", "group", "These processes are only watched"),
            ("p", "set-up", "These processes are only watched"),
            ("r", "run again", "These processes are only watched"),
            ("c", "camera", "There is no robot here whose map or camera could be shown."),
            ("n", "next", "No lesson follows here: q leads to the menu with all of them."),
            ("a", "explain", "Only lessons are explained; d lists what went wrong here."),
        ):
            app.clear_notifications()
            assert label not in {action.label for action in app.screen.query_one(KeyBar).offered}
            await pilot.press(key)
            await settle(pilot)
            [told] = [note.message for note in app._notifications]
            assert told.startswith(sentence), key


async def test_the_guide_tells_what_was_found_and_what_to_try(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    app = CbtuiApp(
        start_file=(file, [], "real"), open_session=FakeEngines(dummy_server_run().events, ns(5.2))
    )
    async with app.run_test(size=TALL) as pilot:
        await settle(pilot)
        await settle(pilot)
        told = " ".join(text_of(app).split())
        assert "What was found" in told
        assert "timer_callback every 1" in told
        assert "C compares both runs" in told


async def test_the_guide_follows_how_long_something_waits(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    run = Run()
    timer = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.wait(timer, 1.0, reason=Reason.NOBODY_SPINS)
    passed = [TimePassed(ns(end)) for end in (3.5, 4.5)]
    engines = FakeEngines([*run.events, *passed], ns(3.5))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=TALL) as pilot:
        await settle(pilot)
        await until(pilot, lambda: "has been ready for 2.5 s" in text_of(app))
        engines.latest.play(ns(4.5))
        await until(pilot, lambda: "has been ready for 3.5 s" in text_of(app))


async def test_a_file_is_run_again_when_it_is_saved_and_only_then(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("before = 1\n")
    engines = FakeEngines(dummy_server_run().events, ns(5.2))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        app.screen.post_message(FileRead(b"before = 1\n"))
        app.screen.post_message(FileRead(None))
        await settle(pilot)
        assert len(engines.sessions) == 1
        file.write_text("after = 2\n")
        await until(pilot, lambda: len(engines.sessions) == 2)
        await pilot.press("2")
        await until(pilot, lambda: "after = 2" in text_of(app))
        assert engines.sessions[0].stopped
        await pilot.press("C")
        names = ("my_node.py, before line 1 changed", "my_node.py, after line 1 changed")
        await until(pilot, lambda: all(name in text_of(app) for name in names))


async def test_a_file_that_is_saved_keeps_the_changes_to_its_run_and_says_which(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("before = 1\n")
    engines = FakeEngines(dummy_server_run().events, ns(5.2))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        assert isinstance(app.screen, LessonScreen)
        app.screen.restarts.changes = Changes(threads=2)
        app.screen.post_message(FileRead(b"after = 2\n"))
        await until(pilot, lambda: len(engines.sessions) == 2)
        told = [each.message for each in app._notifications]
        assert "my_node.py was saved: it runs again, still changed: 2 threads." in told


async def test_it_is_run_again_when_a_module_with_its_callbacks_is_saved(tmp_path: Path) -> None:
    file, module = tmp_path / "my_node.py", tmp_path / "callbacks.py"
    file.write_text("import callbacks\n")
    module.write_text("def tick():\n    before = 1\n")
    run = Run()
    timer = run.timer(run.exclusive(run.node("/n")), "tick", 1.0, file=str(module), lines=(1, 2))
    run.callback(timer, run.thread("MainThread"), 1.0, 0.1)
    engines = FakeEngines(run.events, ns(5.0))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await pilot.pause(1.5)
        assert len(engines.sessions) == 1
        module.write_text("def tick():\n    after = 2\n")
        await until(pilot, lambda: len(engines.sessions) == 2)
        await pilot.press("2")
        await settle(pilot)
        await pilot.pause(1.5)
        assert len(engines.sessions) == 2
        assert "after = 2" in text_of(app)


async def test_without_a_robot_r_runs_again_and_the_code_has_the_room(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    engines = FakeEngines(dummy_server_run().events, ns(5.2))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=WIDE) as pilot:
        await settle(pilot)
        code, robot = app.screen.query_one("#code"), app.screen.query_one("#robot")
        shown = [(bool(robot.display), code.size.width)]
        await pilot.press("4")
        await settle(pilot)
        shown.append((bool(robot.display), code.size.width))
        assert not robot.display
        assert shown[0] == shown[1]
        assert [each.message for each in app._notifications] == ["There is no robot in this run."]
        await pilot.press("r")
        await settle(pilot)
        assert len(engines.sessions) == 2


async def test_without_a_robot_there_is_no_tab_of_it(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    engines = FakeEngines(dummy_server_run().events, ns(5.2))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        assert "3 Factory  5 Log" in text_of(app)
        await pilot.press("3", "tab")
        await settle(pilot)
        assert "3 Factory [5 Log]" in text_of(app)
        await pilot.press("4")
        await settle(pilot)
        assert "3 Factory [5 Log]" in text_of(app)


async def test_why_nobody_can_choose_the_thread_is_told(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("")
    for clock, told in (("real", "needs virtual time"), ("virtual", "Pause the run with ␣ first")):
        app = CbtuiApp(
            start_file=(file, [], clock), open_session=FakeEngines(dummy_server_run().events, ns(5.2))
        )
        async with app.run_test(size=NARROW) as pilot:
            await settle(pilot)
            await pilot.press("W")
            await settle(pilot)
            assert any(told in note.message for note in app._notifications)


async def test_a_program_that_cannot_begin_is_shown_at_its_line(tmp_path: Path) -> None:
    file = tmp_path / "my_node.py"
    file.write_text("import rclpy\nprint((\n")
    ended = RunEnded(
        1, "my_node.py:2: '(' was never closed", True, place=(str(file), 2), problem="'(' was never closed"
    )
    engines = FakeEngines([*Run().until(0), ended], ns(1))
    app = CbtuiApp(start_file=(file, [], "real"), open_session=engines)
    async with app.run_test(size=NARROW) as pilot:
        await settle(pilot)
        await settle(pilot)
        assert "[2 Code]" in text_of(app)
        assert "    2 ✗ print((" in text_of(app)
        await pilot.press("1")
        await settle(pilot)
        assert "It made no node: my_node.py:2" in text_of(app)
