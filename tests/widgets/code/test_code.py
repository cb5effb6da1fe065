from pathlib import Path

import msgspec
import pytest
from textual.app import App, ComposeResult

from cbtui.widgets.code import CodeView
from cbtui.widgets.code.highlight import TokenKind, highlight
from cbtui.widgets.code.marks import (
    CallbackActivity,
    CallbackMark,
    StandingThread,
    lines_at,
    marks_at,
    standing_at,
    text_beside,
)
from cbtui.widgets.code.source_files import SourceFiles
from lessons.catalogue import lessons
from lessons.lesson import Lesson
from sim.trace.events import CallbackAt, Doing, OwnThreadAt, ProgramAt, Reason, RunStarted
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns
from tests.support.pictures import lines_of
from tests.widgets.pictures import told

SOURCE = "\n".join(["import rclpy", *(f"# {line}" for line in range(2, 40))]) + "\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "node.py"
    path.write_text(SOURCE)
    return path


def sleeper(file: str = "node.py") -> tuple[Run, Timeline]:
    """A timer (lines 30 to 33) that runs from 1 s on, and a subscription (20 to 22) that waits for it."""
    run = Run()
    thread = run.thread("MainThread")
    group = run.exclusive(run.node("/n"))
    odom = run.subscription(group, "/odom", "odom_callback", file=file, lines=(20, 22))
    timer = run.timer(group, "timer_callback", 1.0, file=file, lines=(30, 33))
    run.message(odom, 0.5)
    run.callback(odom, thread, 0.5, 0.001)
    run.callback(timer, thread, 1.0)
    run.wait(odom, 1.5, None, holder=timer)
    run.log("still there", 8.0)
    timeline = Timeline()
    timeline.extend(run.events)
    return run, timeline


def marked(path: Path, timeline: Timeline, at: float) -> list[CallbackMark]:
    files = SourceFiles(path)
    return marks_at(timeline, ns(at), files).get(files.main, [])


@pytest.mark.parametrize("lesson", lessons(), ids=lambda lesson: lesson.id)
def test_highlighting_changes_no_character(lesson: Lesson) -> None:
    source = lesson.node_path.read_text()
    lines = ["".join(word.text for word in line) for line in highlight(source)]
    assert lines == source.splitlines()


def test_words_get_their_kind() -> None:
    (line,) = highlight("def f(): return 'a'  # b")
    kinds = {word.text: word.kind for word in line}
    assert kinds["def"] == kinds["return"] == TokenKind.KEYWORD
    assert kinds["f"] == TokenKind.NAME
    assert kinds["# b"] == TokenKind.COMMENT
    assert kinds["'"] == kinds["a"] == TokenKind.STRING


def test_a_running_callback_is_marked_with_its_thread(path: Path) -> None:
    _, timer = marked(path, sleeper()[1], 6.0)
    assert (timer.doing, timer.first_line, timer.last_line) == (CallbackActivity.RUNS, 30, 33)
    assert timer.texts[0] == "▶ MainThread 5.0 s"
    assert timer.letter == "A"


@pytest.mark.parametrize(
    ("doing", "told"), [(Doing.SLEEPS, "▶ sleeps, here for 3.5 s"), (Doing.COMPUTES, "▶ computes, 3.5 s")]
)
def test_a_line_tells_how_long_a_callback_has_been_there_not_how_long_one_sleep_lasts(
    path: Path, doing: Doing, told: str
) -> None:
    run, timeline = sleeper(str(path))
    thread, timer = next(iter(timeline.threads)), list(timeline.entities)[-1]
    at = CallbackAt(ns(1.0), timer, thread, doing, "", ((str(path), "timer_callback", 31),))
    timeline = Timeline()
    timeline.extend(sorted([*run.events, at], key=lambda event: event.t))
    files = SourceFiles(path)
    assert lines_at(timeline, ns(4.5), files)[files.main][31].texts[0] == told


def test_a_line_that_waits_for_a_lock_tells_its_name_and_where_it_was_taken(path: Path) -> None:
    run, timeline = sleeper(str(path))
    thread, timer = next(iter(timeline.threads)), list(timeline.entities)[-1]
    frames = ((str(path), "timer_callback", 31),)
    at = CallbackAt(ns(1.0), timer, thread, Doing.WAITS, "Lock.acquire", frames, lock="self.arm")
    timeline = Timeline()
    taken = msgspec.structs.replace(at, taken_at=(str(path), 12))
    timeline.extend(sorted([*run.events, taken], key=lambda event: event.t))
    files = SourceFiles(path)
    texts = lines_at(timeline, ns(4.5), files)[files.main][31].texts
    assert texts == (
        "▶ waits for self.arm, taken at line 12, 3.5 s",
        "▶ waits for self.arm, 3.5 s",
        "▶ 3.5 s",
        "▶",
    )


@pytest.mark.parametrize(
    ("loop", "looped"), [("for second in range(9)", True), ("while True", True), ("if True", False)]
)
def test_a_sleep_inside_a_loop_is_not_told_as_one(tmp_path: Path, loop: str, looped: bool) -> None:
    path = tmp_path / "node.py"
    path.write_text(f"import time\n{loop}:\n    time.sleep(1)\n")
    timeline = sleeper(str(path))[1]
    thread, timer = next(iter(timeline.threads)), list(timeline.entities)[-1]
    line = ((str(path), "timer_callback", 3),)
    timeline.extend(
        CallbackAt(ns(at), timer, thread, doing, "", line)
        for at, doing in ((1.0, Doing.SLEEPS), (2.0, Doing.COMPUTES), (2.1, Doing.SLEEPS))
    )
    files = SourceFiles(path)
    told = "in a loop, called 3.5 s ago" if looped else ", here for 2.4 s"
    assert lines_at(timeline, ns(4.5), files)[files.main][3].texts[0].endswith(told)


@pytest.mark.parametrize(("sampled", "told"), [(1.0, "▶ sleeps, here for 3.5 s"), (4.42, "▶ sleeps")])
def test_on_the_real_clock_a_line_that_was_sampled_just_now_gets_no_time(
    path: Path, sampled: float, told: str
) -> None:
    run, timeline = sleeper(str(path))
    thread, timer = next(iter(timeline.threads)), list(timeline.entities)[-1]
    line = ((str(path), "timer_callback", 31),)
    at = CallbackAt(ns(sampled), timer, thread, Doing.SLEEPS, "", line)
    events = [event for event in run.events if not isinstance(event, RunStarted)]
    timeline = Timeline()
    timeline.extend([RunStarted(0, "run", "real", 0), *sorted([*events, at], key=lambda event: event.t)])
    files = SourceFiles(path)
    assert lines_at(timeline, ns(4.5), files)[files.main][31].texts[0] == told


def test_the_line_at_which_a_program_waits_where_nothing_spins_is_marked(path: Path) -> None:
    run = Run()
    run.thread("MainThread")
    hangs = ProgramAt(ns(2.0), Doing.CALLS_ROS, "Rate.sleep", ((str(path), "main", 38),))
    timeline = Timeline()
    timeline.extend([*run.events, hangs])
    files = SourceFiles(path)
    assert lines_at(timeline, ns(1.0), files) == {}
    marked = lines_at(timeline, ns(4.5), files)[files.main][38]
    assert (marked.texts[0], marked.number) == ("▶ in Rate.sleep(), 2.5 s", -1)


def test_the_line_at_which_a_thread_of_the_program_s_own_waits_is_marked_until_it_goes_on(path: Path) -> None:
    run = Run()
    frames = ((str(path), "work", 37), (str(path), "wait", 38))
    waits = OwnThreadAt(ns(2.0), 0, "worker", Doing.WAITS, "Event.wait", frames)
    timeline = Timeline()
    timeline.extend([*run.events, waits, OwnThreadAt(ns(4.0), 0, "worker", Doing.COMPUTES, "", ())])
    files = SourceFiles(path)
    lines = lines_at(timeline, ns(3.0), files)[files.main]
    assert lines[38].texts == ("▶ worker waits in Event.wait()", "▶ worker", "▶")
    assert lines[37].texts == ()
    assert lines_at(timeline, ns(1.0), files) == lines_at(timeline, ns(4.0), files) == {}


def test_a_callback_that_awaits_is_marked_with_its_line_until_it_goes_on(path: Path) -> None:
    run = Run()
    thread, group = run.thread("MainThread"), run.exclusive(run.node("/n"))
    file = str(path)
    ask = run.timer(group, "ask", 1.0, file=file, lines=(30, 33))
    run.timer(group, "other", 1.0, file=file, lines=(20, 22))
    run.start(ask, thread, 1.0)
    run.suspend(ask, thread, 1.5, ((file, "ask", 31), (file, "inner", 38)))
    run.wait(ask, 2.0, 4.0, Reason.GROUP_HELD, ask)
    run.resume(ask, thread, 4.0)
    run.end(ask, thread, 4.5)
    timeline, files = told(run), SourceFiles(path)
    (_, mark) = marked(path, timeline, 3.0)
    assert (mark.doing, mark.texts[0]) == (CallbackActivity.AWAITS, "▶ awaits 1.5 s")
    lines = lines_at(timeline, ns(3.0), files)[files.main]
    assert (lines[38].texts[0], lines[31].texts) == ("▶ awaits, 1.5 s", ())
    assert lines_at(timeline, ns(1.2), files) == lines_at(timeline, ns(4.2), files) == {}
    assert marked(path, timeline, 4.2)[1].doing is CallbackActivity.RUNS


def test_a_waiting_callback_is_marked_with_the_reason(path: Path) -> None:
    odom, _ = marked(path, sleeper()[1], 6.0)
    assert odom.doing is CallbackActivity.WAITS
    assert odom.texts[0] == "╱ waits 4.5 s: group A held by timer_callback"


def test_a_short_callback_stays_marked_for_a_moment(path: Path) -> None:
    assert marked(path, sleeper()[1], 0.6)[0].texts == ("· MainThread",)
    assert marked(path, sleeper()[1], 0.9)[0].doing is CallbackActivity.IDLE


def test_callbacks_of_other_files_are_not_marked(path: Path) -> None:
    assert marked(path, sleeper("/elsewhere/node.py")[1], 6.0) == []


def test_a_file_is_known_behind_a_link(tmp_path: Path, path: Path) -> None:
    link = tmp_path / "link.py"
    link.symlink_to(path)
    assert len(marked(link, sleeper(str(path))[1], 6.0)) == 2


def several_calls(file: str, line: int = 36) -> Timeline:
    """Two calls of one callback (lines 30 to 33): on Pool-0_0 since 2 s, on Pool-0_1 since 1 s.

    Each came to a helper's ``line`` half a second later.
    """
    run = Run()
    threads = run.thread("Pool-0_0"), run.thread("Pool-0_1")
    work = run.subscription(run.reentrant(run.node("/n")), "/work", "work", file=file, lines=(30, 33))
    for thread, at in zip(threads, (2.0, 1.0), strict=True):
        run.message(work, at)
        run.callback(work, thread, at)
        frames = ((file, "work", 31), (file, "helper", line))
        run.add(CallbackAt(ns(at + 0.5), work, thread, Doing.SLEEPS, "", frames))
    run.log("still there", 8.0)
    timeline = Timeline()
    timeline.extend(sorted(run.events, key=lambda event: event.t))
    return timeline


def test_of_several_calls_of_a_callback_each_is_told_with_its_own_time_or_the_longest(path: Path) -> None:
    timeline = several_calls(str(path))
    (mark,) = marked(path, timeline, 3.0)
    assert mark.texts == ("▶ Pool-0_1 2.0 s, Pool-0_0 1.0 s", "▶ 2 calls, longest 2.0 s", "▶ 2.0 s")
    files = SourceFiles(path)
    lines = lines_at(timeline, ns(3.0), files)[files.main]
    first = "sleeps, here for 1.5 s"
    assert lines[36].texts[:2] == (f"▶ 2 threads, the first {first}", f"▶ {first}")
    assert lines_at(timeline, ns(2.4), files)[files.main][36].texts[0] == "▶ sleeps, here for 900 ms"
    assert lines[31].texts == ()


def test_a_wait_for_a_lock_is_as_long_as_the_thread_is_at_its_line_whoever_has_the_lock(path: Path) -> None:
    run = Run()
    threads = [run.thread(f"Pool-0_{number}") for number in range(3)]
    count = run.subscription(run.reentrant(run.node("/n")), "/boxes", "count", file=str(path), lines=(30, 33))
    frames = ((str(path), "count", 31),)
    for number, thread in enumerate(threads, start=1):
        run.callback(count, thread, number / 10)
    for at, holder in ((1.0, threads[1]), (2.0, threads[2])):
        run.add(CallbackAt(ns(at), count, threads[0], Doing.WAITS, "Lock.acquire", frames, holder=holder))
    run.log("still there", 8.0)
    files = SourceFiles(path)
    lines = lines_at(told(run), ns(3.0), files)[files.main]
    assert lines[31].texts[0] == "▶ waits for a lock, 2.0 s"


class CodeOnly(App[None]):
    def __init__(self, path: Path) -> None:
        super().__init__()
        self._path = path

    def compose(self) -> ComposeResult:
        yield CodeView(self._path)

    @property
    def view(self) -> CodeView:
        return self.query_one(CodeView)


async def test_the_view_goes_to_a_callback_that_runs_for_a_while(path: Path) -> None:
    app = CodeOnly(path)
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = sleeper()[1]
        app.view.show(timeline, ns(0.6))
        await pilot.pause()
        assert lines_of(app)[1].startswith("  20 A # 20")
        app.view.show(timeline, ns(1.1))
        await pilot.pause()
        assert lines_of(app)[1].startswith("  20 A # 20")
        app.view.show(timeline, ns(1.4))
        await pilot.pause()
        assert lines_of(app)[1].startswith("  30 A # 30")
        assert lines_of(app)[1].rstrip().endswith("▶ MainThread 400 ms")


async def test_the_view_does_not_come_back_while_the_same_callback_runs(path: Path) -> None:
    app = CodeOnly(path)
    async with app.run_test(size=(60, 10)) as pilot:
        timeline = sleeper()[1]
        app.view.show(timeline, ns(2.0))
        await pilot.pause()
        app.view.scroll_to(y=0, animate=False, immediate=True)
        app.view.show(timeline, ns(3.0))
        await pilot.pause()
        assert lines_of(app)[0].startswith("   1   import rclpy")


async def test_a_narrow_view_says_it_in_fewer_words(path: Path) -> None:
    app = CodeOnly(path)
    async with app.run_test(size=(40, 10)) as pilot:
        app.view.show(sleeper()[1], ns(1.9))
        await pilot.pause()
        app.view.scroll_to(y=18, animate=False, immediate=True)
        await pilot.pause()
        assert lines_of(app)[1].rstrip().endswith("waits 400 ms")


def test_code_gives_way_to_no_mark_that_goes_at_once() -> None:
    assert text_beside(("· Pool-0_0",), 5) == ""
    assert text_beside(("▶ computes", "▶"), 5) == " ▶ "


@pytest.mark.parametrize(
    ("room", "shown"), [(5, " ▶ 1, 2 "), (13, " ▶ 1, 2 "), (40, " ▶ 1 Pool-0_0, 2 Pool-0_1 ")]
)
def test_a_thread_to_choose_keeps_its_number_where_its_name_has_no_room(
    path: Path, room: int, shown: str
) -> None:
    options = [StandingThread(f"Pool-0_{each}", str(path), 9) for each in (0, 1)]
    [lines] = standing_at(options, SourceFiles(path)).values()
    assert text_beside(lines[9].texts, room) == shown


async def test_a_line_that_is_too_long_for_the_mark_of_a_thread_moves_to_the_left(path: Path) -> None:
    call = "reply = self.gripper.call(request)"
    path.write_text("\n".join(" " * 8 + call if line == 36 else "" for line in range(40)))
    app = CodeOnly(path)
    async with app.run_test(size=(51, 42)) as pilot:
        app.view.show(several_calls(str(path), 37), ns(3.0))
        await pilot.pause()
        assert lines_of(app)[36] == f"  37 ▶ {call}  ▶ 1.5 s "


@pytest.mark.parametrize(("columns", "beside"), [(30, " ▶ 1.5 s "), (39, "… ▶ 1.5 s "), (53, "… ▶ 1.5 s ")])
async def test_long_code_gives_way_to_how_long_a_thread_has_been_at_its_line(
    path: Path, columns: int, beside: str
) -> None:
    path.write_text("\n".join("x" * columns if line == 36 else "" for line in range(40)))
    app = CodeOnly(path)
    async with app.run_test(size=(50, 42)) as pilot:
        app.view.show(several_calls(str(path), 37), ns(3.0))
        await pilot.pause()
        line = lines_of(app)[36]
        assert line == f"  37 ▶ {'x' * columns}"[: 50 - len(beside)].ljust(50 - len(beside)) + beside
