"""A learner's own file on the lesson screen."""

from pathlib import Path

from cbtui.app import CbtuiApp
from sim.engine.commands import CallService, Pause
from sim.engine.setup import ProgramSetup
from tests.support.console import NARROW, settle
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
