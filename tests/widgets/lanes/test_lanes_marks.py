"""What lanes mark: calls that stand still, lost messages, groups, keys, the cursor and what is selected."""

import pytest
from msgspec.structs import replace
from rich.cells import cell_len

from cbtui.looks.theme import Charset
from cbtui.text.cells import CellRow
from cbtui.widgets.diagnosis import call_note
from cbtui.widgets.lanes import LanePainter, Selection
from cbtui.widgets.lanes.rows import GroupLane, MemberLane, ThreadLane, all_lanes
from cbtui.widgets.lanes.scale import TimeScale
from cbtui.widgets.lanes.selection import bars_in
from cbtui.widgets.lanes.service_calls import LatestCalls, draw_calls
from sim.trace.events import CallbackAt, Doing, MessageDropped, ProgramAt, RunStarted
from sim.trace.figures.chains import ChainStep, StepKind
from sim.trace.model import Call, Window
from sim.trace.timeline import Timeline
from tests.support.runs import (
    Run,
    ns,
)
from tests.widgets.factory.test_factory_pictures import factory
from tests.widgets.lanes.test_lanes_painter import small_run
from tests.widgets.pictures import drawn, last, plain, shared_group, told


def blocked_run() -> Run:
    """A callback that stands still in a call of /x from 2 to 8 s of the 9 s that it runs."""
    run, thread, a, _ = small_run()
    call = run.call("/x", 2.0, 8.0, entity=a)
    run.blocked(call, "/x", thread, a, 2.0, 8.0)
    run.callback(a, thread, 0.2, 9.0)
    run.stop(10.0)
    return run


def test_a_thread_that_stands_still_in_a_call_is_hatched_and_says_in_which() -> None:
    assert plain(LanePainter().paint(told(blocked_run()), *last(10, 10.0), 80, 8).rows).splitlines()[
        0
    ] == drawn("|MainThread  │ A a_callback ░░ blocked in call /x ░░░░██████    │  90% busy      |")


def test_calls_inside_the_call_of_a_bar_are_marked_on_it() -> None:
    run, thread, a, timer = small_run()
    run.start(timer, thread, 1.0)
    run.callback(a, thread, 4.0, 0.01)
    run.callback(a, thread, 6.0, 0.3)
    run.end(timer, thread, 9.0)
    run.stop(10.0)
    rows = plain(LanePainter().paint(told(run), *last(10, 10.0), 80, 8).rows).splitlines()
    assert rows[0].startswith("MainThread  │     A tick_callback █████████▪▪█████████████ ")


def test_before_a_recording_that_begins_late_a_service_may_have_been_called() -> None:
    events = small_run()[0].events
    late = [replace(each, known_from=1) if isinstance(each, RunStarted) else each for each in events]
    for run, told_first in ((events, "not called"), (late, "none recorded")):
        timeline = Timeline()
        timeline.extend(run)
        assert LatestCalls(timeline).summary("/x", ns(5.0)) == told_first


def test_of_several_calls_without_a_reply_the_lane_and_the_line_at_the_bottom_tell_the_oldest() -> None:
    run, *_ = small_run()
    run.call("/x", 1.0, 1.5)
    run.call("/x", 2.0)
    run.call("/x", 4.0)
    run.stop(6.0)
    timeline = told(run)
    assert LatestCalls(timeline).summary("/x", ns(5.0)) == "no reply 3.0 s"
    assert call_note(timeline, ns(5.0))[0] == "no reply for 3.0 s: /x and 1 more"


def test_a_call_that_waits_for_a_lock_looks_unlike_one_that_sleeps() -> None:
    run = Run()
    node = run.node("/n")
    entities = [run.timer(run.exclusive(node), name, 1.0) for name in ("keeps", "wants")]
    threads = [run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(2)]
    for entity, thread in zip(entities, threads, strict=True):
        run.callback(entity, thread, 1.0, 8.0)
    frames = (("node.py", "count", 12),)
    sleeps = CallbackAt(ns(1.0), entities[0], threads[0], Doing.SLEEPS, "time.sleep", frames)
    waits = CallbackAt(ns(1.0), entities[1], threads[1], Doing.WAITS, "Lock.acquire", frames)
    timeline = Timeline()
    timeline.extend(sorted([*run.until(10.0), sleeps, waits], key=lambda event: event.t))
    keeps, wants, *_ = plain(LanePainter().paint(timeline, *last(10, 10.0), 80, 8).rows).splitlines()
    assert "░" not in keeps
    assert "A keeps" in keeps
    assert "B wants ░░ waits for a lock ░" in wants


@pytest.mark.parametrize(
    ("doing", "call", "told_so"),
    [
        (Doing.WAITS, "Event.wait", "waits in Event.wait()"),
        (Doing.WAITS, "Queue.get", "waits in Queue.get()"),
        (Doing.WAITS, "Semaphore.acquire", "waits in Semaphore.acquire()"),
        (Doing.CALLS_ROS, "Rate.sleep", "in Rate.sleep()"),
        (Doing.READS, "input", "waits for the keyboard"),
    ],
)
def test_every_wait_inside_a_call_looks_unlike_work_at_every_size(
    doing: Doing, call: str, told_so: str
) -> None:
    run, thread, a, _ = small_run()
    run.start(a, thread, 1.0)
    run.add(CallbackAt(ns(1.0), a, thread, doing, call, (("node.py", "a_callback", 12),)))
    run.stop(10.0)
    for width in (80, 140, 200):
        lane = plain(LanePainter().paint(told(run), *last(10, 10.0), width, 6).rows).splitlines()[0]
        assert f"░ {told_so} ░".removeprefix("░ waits " if width == 80 else "") in lane
        assert "█" not in lane
    seat = " ".join(factory(told(run), 9.0, 140, 20).split())
    assert f"1 worker {told_so}" in seat
    assert f"{told_so}┃" in seat.replace(" ┃", "┃")


def test_a_program_that_waits_where_nothing_spins_is_on_its_main_threads_lane_until_a_callback_runs() -> None:
    run, thread, a, _ = small_run()
    run.callback(a, thread, 6.0, 1.0)
    hangs = ProgramAt(ns(1.0), Doing.CALLS_ROS, "Rate.sleep", (("node.py", "main", 28),))
    timeline = Timeline()
    timeline.extend(sorted([*run.until(10.0), hangs], key=lambda event: event.t))
    picture = plain(LanePainter().paint(timeline, *last(10, 10.0), 80, 8).rows).splitlines()
    assert picture[0] == drawn(
        "|MainThread  │     ░░ in Rate.sleep() :28 ░░A ███               │  10% busy      |"
    )
    (wait,) = timeline.program_waits_on(thread, Window(0, ns(10)))
    assert (wait.start, wait.end, wait.entity, wait.line) == (ns(1.0), ns(6.0), 0, 28)
    assert not timeline.program_waits_on(thread, Window(ns(6.0), ns(10)))
    timeline.extend([ProgramAt(ns(10), Doing.COMPUTES, "", (("node.py", "main", 29),))])
    assert not timeline.program_waits_on(thread, Window(ns(10), ns(11)))


def test_a_bars_name_is_kept_where_its_thread_stands_still_at_once() -> None:
    run, thread, a, _ = small_run()
    run.callback(a, thread, 0.2)
    run.blocked(run.call("/x", 0.2, entity=a), "/x", thread, a, 0.2)
    text = plain(LanePainter(Charset.ASCII).paint(told(run, 10.0), Window(0, ns(10)), ns(10), 80, 8).rows)
    assert "A a" in text.splitlines()[0]
    assert "%% blocked in call /x %%" in text.splitlines()[0]


def test_the_cursor_stands_at_the_end_of_a_run_that_is_over_and_not_at_now() -> None:
    run, thread, a, _ = small_run()
    run.callback(a, thread, 1.0, 1.0)
    going_on, over = told(run, until=10.0), Timeline()
    run.stop(10.0)
    over.extend(run.events)
    for timeline, name in ((going_on, "now"), (over, "end")):
        axis = plain(LanePainter().paint(timeline, *last(10, 10.0), 80, 8).rows).splitlines()[-1]
        assert f" {name}▲" in axis
        earlier = plain(LanePainter().paint(timeline, Window(0, ns(5)), ns(10), 80, 8).rows).splitlines()[-1]
        assert f"{name}▸" in earlier
    assert "cursor▲" in plain(LanePainter().paint(over, Window(0, ns(10)), ns(5), 80, 8).rows)


def test_lost_messages_are_crosses_on_the_lane_of_their_queue() -> None:
    run, _, a, _ = small_run()
    for at in (1.0, 1.5, 5.0, 5.1):
        run.add(MessageDropped(ns(at), a, 10, 1))
    run.stop(10.0)
    assert plain(LanePainter().paint(told(run), *last(10, 10.0), 80, 8).rows).splitlines()[2] == drawn(
        "|  a         │     × ×                 ×                        │ 10/10! lost 4  |"
    )


def test_a_narrow_lane_tells_thousands_of_lost_messages() -> None:
    run, _, a, _ = small_run()
    for each in range(1074):
        run.add(MessageDropped(ns(5.0) + each, a, 10, 1))
    run.stop(10.0)
    narrow, wide = (
        plain(LanePainter().paint(told(run), *last(10, 10.0), width, 8).rows) for width in (80, 140)
    )
    assert " 10/10! lost 1k" in narrow
    assert " queue 10/10! lost 1074" in wide


def neighbours() -> Timeline:
    """Two groups whose callbacks follow each other at once on one thread."""
    run = Run()
    thread, node = run.thread("MainThread"), run.node("/n")
    one, other = (run.timer(run.exclusive(node), f"{name}_callback", 9.0) for name in ("one", "other"))
    run.callback(one, thread, 0.0, 4.8)
    run.callback(other, thread, 4.8, 10.0)
    return told(run, until=10.0)


@pytest.mark.parametrize(
    ("charset", "bars"),
    [
        (Charset.BRAILLE, "│A one_callback ████████▉B other_callback ·········│"),
        (Charset.BLOCK, "│A one_callback ████████▉B other_callback ·········│"),
        (Charset.ASCII, "|A one_callback #########B other_callback +++++++++|"),
    ],
)
def test_what_a_bars_label_leaves_has_the_texture_of_its_group(charset: Charset, bars: str) -> None:
    assert (
        bars in plain(LanePainter(charset).paint(neighbours(), *last(10, 10.0), 80, 8).rows).splitlines()[0]
    )


def test_wide_lanes_show_each_groups_texture_beside_its_letter() -> None:
    names = [
        line[:23]
        for line in plain(LanePainter().paint(neighbours(), *last(10, 10.0), 140, 8).rows).splitlines()
    ]
    assert names[1:3] == ["A ██ exclusive one     ", "B ·· exclusive other   "]


def test_keys_of_the_person_are_marked_on_the_axis_in_words_where_there_is_room() -> None:
    run, _, _, _ = small_run()
    run.command("reset the world", 3.0)
    run.command("speed x2", 3.2)
    run.stop(10.0)
    axis = plain(LanePainter().paint(told(run), *last(10, 10.0), 80, 8).rows).splitlines()[-1]
    assert "▲▲speed x2" in axis


@pytest.mark.parametrize(("start", "sign"), [(6.0, "◂cursor"), (1.0, "cursor▸")])
def test_an_axis_tells_on_which_side_the_cursor_is(start: float, sign: str) -> None:
    timeline = shared_group()
    window = Window(ns(start), ns(start + 2))
    axis = plain(LanePainter().paint(timeline, window, ns(4.5), 80, 7).rows).splitlines()[-1]
    assert sign in axis


@pytest.mark.parametrize(("before", "label"), [(0, "now▲"), (1, "cursor▲"), (ns(4.5), "cursor▲")])
def test_only_the_runs_newest_moment_is_called_now(before: int, label: str) -> None:
    timeline = shared_group(12.0)
    cursor = timeline.end - before
    axis = plain(LanePainter().paint(timeline, Window(ns(2), ns(12)), cursor, 80, 7).rows).splitlines()[-1]
    assert f" {label}" in axis


def test_the_selected_lane_is_pointed_at_and_its_bar_stands_out() -> None:
    timeline = shared_group(12.9)
    lane = ThreadLane(timeline.threads[1])
    bar = timeline.spans_on(1, Window(ns(5), ns(6)))[0]
    picture = LanePainter().paint(timeline, *last(10, 12.9), 80, 8, Selection(lane, bar))
    assert plain(picture.rows).splitlines()[0].startswith("MainThread  ▸▎▎▎▎▎A timer_callback")
    selected = "".join(run.text for run in picture.rows[0] if run.ink.selected)
    assert selected.startswith("A timer_callback ███")
    assert not any(run.ink.selected for row in picture.rows[1:] for run in row)


@pytest.mark.parametrize("window", [Window(ns(0), ns(1)), Window(ns(6), ns(16)), Window(ns(12.4), ns(12.9))])
def test_rows_are_as_wide_as_the_picture_wherever_the_selected_bar_lies(window: Window) -> None:
    timeline = shared_group(12.9)
    path = [ChainStep(StepKind.WAITS, "a", ns(2), ns(3), entity=1)]
    for lane in all_lanes(timeline, "/motor_power"):
        for bar in bars_in(timeline, lane, Window(0, timeline.end))[::40]:
            picture = LanePainter().paint(
                timeline, window, timeline.end, 80, 8, Selection(lane, bar), path=path
            )
            assert {sum(cell_len(run.text) for run in row) for row in picture.rows} == {80}


def test_the_steps_of_a_chain_stand_out_on_the_lanes_of_their_callbacks() -> None:
    timeline = shared_group(12.9)
    lane = next(each for each in all_lanes(timeline, "") if isinstance(each, MemberLane))
    steps = [
        ChainStep(StepKind.WAITS, "a", ns(5), ns(7), entity=lane.entity.id),
        ChainStep(StepKind.RUNS, "a", ns(20), ns(21), entity=lane.entity.id),
    ]
    picture = LanePainter().paint(timeline, *last(10, 12.9), 80, 8, path=steps)
    marked = {
        number: sum(len(run.text) for run in row if run.ink.selected)
        for number, row in enumerate(picture.rows)
    }
    place = picture.lanes.index(lane)
    assert marked.pop(place) == ns(2) // picture.scale.per_column
    assert not any(marked.values())
    selected = "".join(run.text for run in picture.rows[place] if run.ink.selected)
    assert selected.startswith("1"), "colour is not the only sign"


def test_the_selected_lane_and_its_neighbours_are_shown_however_few_there_is_room_for() -> None:
    timeline = shared_group(12.9)
    every = all_lanes(timeline, "/motor_power")
    for place, lane in enumerate(every):
        shown = (
            LanePainter(service="/motor_power").paint(timeline, *last(10, 12.9), 80, 5, Selection(lane)).lanes
        )
        assert set(every[max(0, place - 1) : place + 2]) <= set(shown)
        assert list(shown) == [each for each in every if each in shown]


def test_a_callback_whose_group_has_no_lane_is_labelled_with_its_group() -> None:
    timeline = shared_group(12.9)
    kept = dict.fromkeys(timeline.entities, 0)
    for height in range(3, 12):
        picture = LanePainter().paint(timeline, *last(10, 12.9), 140, height, kept=kept)
        headed = {lane.group for lane in picture.lanes if isinstance(lane, GroupLane)}
        for row, lane in zip(picture.rows, picture.lanes, strict=False):
            if isinstance(lane, MemberLane):
                assert (row[0].text == f"{lane.group.letter} ") == (lane.group not in headed)


def test_marks_of_calls_in_a_row_stand_apart() -> None:
    row, sent = CellRow(16, Charset.BRAILLE), ((2.0, 10.0), (3.0, 12.0))
    calls = [Call(n, "/x", 0, "", ns(at), ns(replied)) for n, (at, replied) in enumerate(sent)]
    draw_calls(row, calls[::-1], TimeScale(0, ns(1.0), 16), ns(16.0), "s")
    assert "".join(row.cells).rstrip() == "  ▲▲s·····◂·◂"
