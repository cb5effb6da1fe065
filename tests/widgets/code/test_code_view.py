from pathlib import Path

import pytest
from textual.app import App, ComposeResult
from textual.pilot import Pilot

from cbtui.looks.theme import GLYPHS, Charset
from cbtui.widgets.code import CodeView, Step
from cbtui.widgets.code.marks import marks_at
from cbtui.widgets.code.source_files import SourceFiles
from sim.trace.events import Reason, RunEnded
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns
from tests.support.pictures import lines_of


def numbered(name: str) -> str:
    return "".join(f"# {name} {line}\n" for line in range(1, 61))


@pytest.fixture
def talker(tmp_path: Path) -> Path:
    path = tmp_path / "talker.py"
    path.write_text(numbered("talker"))
    return path


@pytest.fixture
def listener(tmp_path: Path) -> Path:
    path = tmp_path / "listener.py"
    path.write_text(numbered("listener"))
    return path


def two_programs(talker: Path, listener: Path) -> Timeline:
    """The talker's timer (lines 30 to 33) runs from 1 s to 2 s; the listener's (20 to 22) from 3 s on."""
    run = Run()
    here, there = run.thread("talker MainThread"), run.thread("listener MainThread")
    talking = run.timer(run.exclusive(run.node("/t")), "talk", 1.0, file=str(talker), lines=(30, 33))
    group = run.exclusive(run.node("/l"))
    hearing = run.subscription(group, "/chatter", "hear", file=str(listener), lines=(20, 22))
    run.callback(talking, here, 1.0, 1.0)
    run.message(hearing, 3.0)
    run.callback(hearing, there, 3.0)
    run.log("still there", 8.0)
    timeline = Timeline()
    timeline.extend(run.events)
    return timeline


class CodeOnly(App[None]):
    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path = path
        self.picked: list[tuple[int, bool]] = []

    def compose(self) -> ComposeResult:
        yield CodeView(self._path)

    @property
    def view(self) -> CodeView:
        return self.query_one(CodeView)

    def on_code_view_callback_picked(self, message: CodeView.CallbackPicked) -> None:
        self.picked.append((message.entity, message.leaves))


async def show(pilot: Pilot[None], timeline: Timeline, at: float) -> list[str]:
    pilot.app.query_one(CodeView).show(timeline, ns(at))
    await pilot.pause()
    await pilot.pause()
    return lines_of(pilot.app)


async def test_the_view_goes_to_the_file_of_a_callback_that_runs_for_a_while(
    talker: Path, listener: Path
) -> None:
    app = CodeOnly(talker)
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = two_programs(talker, listener)
        assert "# talker 30" in (await show(pilot, timeline, 1.5))[1]
        assert app.view.note == "talker.py"
        assert "# listener 20" in (await show(pilot, timeline, 3.5))[1]
        assert app.view.note == "listener.py"
        assert app.view.place.path == listener


async def test_the_view_stays_while_a_callback_of_its_own_file_runs_as_long(
    talker: Path, listener: Path
) -> None:
    run = Run()
    here, there = run.thread("a"), run.thread("b")
    talking = run.timer(run.exclusive(run.node("/t")), "talk", 1.0, file=str(talker), lines=(30, 33))
    hearing = run.timer(run.exclusive(run.node("/l")), "hear", 1.0, file=str(listener), lines=(20, 22))
    run.callback(talking, here, 1.0)
    run.callback(hearing, there, 2.0)
    run.log("still there", 8.0)
    timeline = Timeline()
    timeline.extend(run.events)
    app = CodeOnly(talker)
    async with app.run_test(size=(60, 10)) as pilot:
        await show(pilot, timeline, 1.5)
        await show(pilot, timeline, 5.0)
        assert app.view.note == "talker.py"


async def test_the_view_goes_to_the_callback_of_each_step_once(talker: Path, listener: Path) -> None:
    app = CodeOnly(talker)
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = two_programs(talker, listener)
        await show(pilot, timeline, 0.5)
        app.view.step = Step(ns(3.0), 0, 2)
        assert "# listener 20" in (await show(pilot, timeline, 3.0))[1]
        app.view.step = Step(ns(3.0), 1, 1)
        assert "# talker 30" in (await show(pilot, timeline, 3.0))[1]
        app.view.scroll_to(y=0, animate=False, immediate=True)
        assert "# talker 1" in (await show(pilot, timeline, 3.0))[0], "who scrolls away stays there"
        app.view.focus()
        await pilot.press("down")
        app.view.step = Step(ns(3.0), 0, 2)
        await show(pilot, timeline, 3.0)
        assert app.view.note == "talker.py", "a picked line stays"


@pytest.mark.parametrize(("reason", "sign"), GLYPHS[Charset.BRAILLE].hatch.items())
async def test_the_margin_beside_a_waiting_callback_has_the_sign_of_the_reason(
    talker: Path, reason: Reason, sign: str
) -> None:
    run = Run()
    group = run.exclusive(run.node("/t"))
    talking = run.timer(group, "talk", 1.0, file=str(talker), lines=(3, 6))
    other = run.timer(group, "other", 1.0)
    run.callback(other, run.thread("a"), 0.5)
    run.wait(talking, 1.0, None, reason, other)
    run.log("still there", 8.0)
    timeline = Timeline()
    timeline.extend(run.events)
    async with CodeOnly(talker).run_test(size=(60, 10)) as pilot:
        lines = await show(pilot, timeline, 4.0)
        assert f" {sign} waits " in lines[2]
        assert [line[5] for line in lines[3:6]] == [sign] * 3


async def test_the_view_leaves_a_person_where_a_line_was_picked(talker: Path, listener: Path) -> None:
    app = CodeOnly(talker)
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = two_programs(talker, listener)
        await show(pilot, timeline, 1.5)
        app.view.focus()
        await pilot.press("down")
        await show(pilot, timeline, 3.5)
        assert app.view.note == "talker.py"
        await pilot.press("escape")
        await show(pilot, timeline, 2.5)
        await show(pilot, timeline, 3.6)
        assert app.view.note == "listener.py"


async def test_a_callback_that_is_asked_for_is_shown_in_its_file_and_picked(
    talker: Path, listener: Path
) -> None:
    app = CodeOnly(talker)
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = two_programs(talker, listener)
        await show(pilot, timeline, 0.5)
        app.view.show_callback(timeline.entities[2])
        await pilot.pause()
        await pilot.pause()
        assert "# listener 20" in lines_of(app)[1]
        assert app.view.place == (listener, 20)


async def test_enter_on_a_line_of_a_callback_tells_which_one(talker: Path, listener: Path) -> None:
    app = CodeOnly(talker)
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = two_programs(talker, listener)
        await show(pilot, timeline, 0.5)
        app.view.focus()
        await pilot.press("down", "enter")
        assert app.view.place.line == 29
        assert app.picked == []
        await pilot.press(*["down"] * 4, "enter")
        assert app.picked == [(1, True)]
        await pilot.press("down", "enter")
        assert app.picked == [(1, True)]


async def test_a_click_on_a_line_of_a_callback_tells_which_one(talker: Path, listener: Path) -> None:
    app = CodeOnly(talker)
    async with app.run_test(size=(60, 10)) as pilot:
        await show(pilot, two_programs(talker, listener), 0.5)
        await pilot.click(CodeView, offset=(20, 0))
        assert app.picked == []
        await pilot.click(CodeView, offset=(20, 3))
        assert app.picked == [(1, False)]
        assert app.view.place == (talker, 32)


async def test_the_picked_line_comes_into_view(talker: Path, listener: Path) -> None:
    app = CodeOnly(talker)
    async with app.run_test(size=(60, 10)) as pilot:
        await show(pilot, two_programs(talker, listener), 0.5)
        app.view.focus()
        await pilot.press(*["down"] * 12)
        await pilot.pause()
        assert app.view.place.line == 40
        assert "# talker 40" in lines_of(app)[-1]
        await pilot.press(*["up"] * 15)
        await pilot.pause()
        assert "# talker 25" in lines_of(app)[0]


async def test_what_is_copied_is_the_callback_at_the_line(talker: Path, listener: Path) -> None:
    app = CodeOnly(talker)
    async with app.run_test(size=(60, 10)) as pilot:
        await show(pilot, two_programs(talker, listener), 0.5)
        app.view.focus()
        await pilot.press("y")
        assert app.clipboard == ""
        await pilot.press("down", "down", "y")
        assert app.clipboard == "\n".join(f"# talker {line}" for line in range(30, 34))


async def test_a_file_that_changed_on_disk_says_so_until_it_is_read_anew(talker: Path) -> None:
    app = CodeOnly(talker)
    async with app.run_test(size=(60, 10)) as pilot:
        talker.write_text("# new\n")
        assert app.view.note == "talker.py"
        app.view.check_disk()
        assert app.view.note == "talker.py · changed on disk"
        app.view.over = True
        assert app.view.note == "talker.py · changed; r runs it again"
        assert "# talker 1" in lines_of(app)[0]
        app.view.read_anew({})
        await pilot.pause()
        assert app.view.note == "talker.py"
        assert "# new" in lines_of(app)[0]


def test_a_callback_that_stands_still_in_a_call_says_in_which(talker: Path) -> None:
    run = Run()
    thread = run.thread("MainThread")
    group = run.exclusive(run.node("/n"))
    timer = run.timer(group, "tick", 1.0, file=str(talker), lines=(30, 33))
    run.callback(timer, thread, 1.0)
    run.blocked(1, "/motor_power", thread, timer, 1.5)
    run.log("still there", 8.0)
    timeline = Timeline()
    timeline.extend(run.events)
    files = SourceFiles(talker)
    (mark,) = marks_at(timeline, ns(3.0), files)[files.main]
    assert mark.texts[0] == "▶ 2.0 s: blocked in the call of /motor_power"
    (mark,) = marks_at(timeline, ns(1.2), files)[files.main]
    assert mark.texts[0] == "▶ MainThread 200 ms"


async def test_what_ended_a_program_is_told_at_its_line(talker: Path) -> None:
    timeline = Timeline()
    run = Run()
    run.log("on its way", 0.5)
    place = (str(talker), 40)
    ended = RunEnded(
        ns(2.0), "talker.py:40: '(' was never closed", True, place=place, problem="'(' was never closed"
    )
    timeline.extend([*run.events, ended])
    app = CodeOnly(talker)
    async with app.run_test(size=(70, 12)) as pilot:
        assert not any("never closed" in line for line in await show(pilot, timeline, 1.0))
        shown = await show(pilot, timeline, 2.0)
        line = next(line for line in shown if "never closed" in line)
        assert line.split() == ["40", "✗", "#", "talker", "40", "✗", "'('", "was", "never", "closed"]
        assert app.view.picked == 40
        await pilot.press("escape")
        await show(pilot, timeline, 2.0)
        assert app.view.picked is None


async def test_after_a_fault_is_corrected_the_view_goes_to_a_callback_as_at_first(talker: Path) -> None:
    place = (str(talker), 2)
    ended = Timeline()
    ended.extend([RunEnded(ns(0.1), "syntax", True, place=place, problem="'(' was never closed")])
    app = CodeOnly(talker)
    async with app.run_test(size=(70, 12)) as pilot:
        await show(pilot, ended, 1.0)
        talker.write_text(numbered("corrected"))
        app.view.read_anew({})
        shown = await show(pilot, two_programs(talker, talker), 0.5)
        assert app.view.picked is None
        assert any(line.startswith("  20 B") for line in shown)


async def test_code_that_is_too_wide_is_scrolled_sideways(tmp_path: Path) -> None:
    path = tmp_path / "wide.py"
    path.write_text("# " + "".join(f"{number:>5}" for number in range(30)) + "\n")
    app = CodeOnly(path)
    async with app.run_test(size=(40, 6)) as pilot:
        await show(pilot, Timeline(), 0.0)
        app.view.focus()
        assert not app.view.check_action("sideways_left", ())
        before = lines_of(app)[0]
        assert before[-1] == "…"
        await pilot.press("shift+right", "shift+right")
        await pilot.pause()
        assert lines_of(app)[0][:7] == before[:7]
        assert lines_of(app)[0] != before
        await pilot.press(*["shift+right"] * 20)
        await pilot.pause()
        assert lines_of(app)[0].endswith("   29")
        await pilot.press(*["shift+left"] * 22)
        await pilot.pause()
        assert lines_of(app)[0] == before


async def test_the_keys_that_pan_the_lanes_do_not_shift_code_that_is_too_wide(tmp_path: Path) -> None:
    path = tmp_path / "wide.py"
    path.write_text("# " + "".join(f"{number:>5}" for number in range(30)) + "\n")
    app = CodeOnly(path)
    async with app.run_test(size=(40, 6)) as pilot:
        await show(pilot, Timeline(), 0.0)
        app.view.focus()
        before = lines_of(app)[0]
        await pilot.press("right")
        await pilot.pause()
        assert lines_of(app)[0] == before


async def test_the_text_of_a_fault_stands_beside_its_line_and_not_on_it(tmp_path: Path) -> None:
    path = tmp_path / "echo.py"
    path.write_text("class Echo:\n    def on_a_word_that_is_said(self):\n        pass\n")
    timeline = Timeline()
    problem = "the program raised RuntimeError: a callback should be callable with one argument or two"
    timeline.extend([*Run().until(0), RunEnded(1, problem, True, place=(str(path), 2), problem=problem)])
    app = CodeOnly(path)
    async with app.run_test(size=(70, 6)) as pilot:
        app.view.show(timeline, 1)
        await pilot.pause()
        line = lines_of(app)[1]
        assert "def on_a_word_that_is_said(self):  ✗ the program raised" in line
        assert line.rstrip().endswith("…")
