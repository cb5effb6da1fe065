"""Who stands where in the factory: a function of timeline, moment and glance, and of nothing else."""

from functools import cache, partial

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.cells import cell_len

from cbtui.looks.theme import Charset, Role
from cbtui.widgets.factory import FactoryPainter
from cbtui.widgets.factory.scene import Area, FactoryScene, WorkerState, scene_of
from cbtui.widgets.lanes.painter import LanePainter
from sim.trace.events import Reason, TimerCancelled, TimerReset
from sim.trace.model import Window
from sim.trace.timeline import Timeline
from tests.support.properties import examples
from tests.support.runs import Run, ns
from tests.widgets.factory.scenes import (
    four_workers_one_seat,
    many_groups,
    one_worker_three_areas,
    stuck_in_a_call,
)
from tests.widgets.pictures import dummy_server, plain, shared_group, split_groups, told

GLANCE = ns(0.15)
RUNS = (
    shared_group,
    split_groups,
    dummy_server,
    cache(four_workers_one_seat),
    cache(one_worker_three_areas),
    cache(stuck_in_a_call),
    cache(partial(many_groups, 12)),
    Timeline,
)


def one_call(start: float = 1.0, length: float = 1.0) -> Timeline:
    """One thread, one timer, one call of it."""
    run = Run()
    worker = run.thread("MainThread")
    run.executor("SingleThreadedExecutor", 1)
    timer = run.timer(run.exclusive(run.node("/n")), "tick_callback", 10.0)
    run.callback(timer, worker, start, length)
    run.stop(9.0)
    return told(run)


def scene_at(timeline: Timeline, at: float, glance: float = 0.15) -> FactoryScene:
    return scene_of(timeline, ns(at), ns(glance))


def only_area(timeline: Timeline, at: float) -> Area:
    (area,) = scene_at(timeline, at).areas
    return area


@pytest.mark.parametrize(
    ("at", "stay"),
    [
        (0.9, WorkerState.NEVER),
        (1.0, WorkerState.COMES),
        (1.149, WorkerState.COMES),
        (1.15, WorkerState.WORKS),
        (1.999, WorkerState.WORKS),
        (2.0, WorkerState.LEAVES),
        (2.149, WorkerState.LEAVES),
        (2.151, WorkerState.IDLE),
    ],
)
def test_a_worker_comes_works_leaves_and_waits(at: float, stay: WorkerState) -> None:
    (worker,) = scene_at(one_call(), at).workers
    assert worker.stay is stay


def test_an_executor_that_a_callback_made_has_no_worker_of_its_own() -> None:
    run = Run()
    pool = run.thread("ThreadPoolExecutor-0_0")
    run.executor("MultiThreadedExecutor", 3)
    run.executor("SingleThreadedExecutor", 1)
    timer = run.timer(run.exclusive(run.node("/n")), "ask_callback", 10.0)
    run.start(timer, pool, 1.0)
    run.executor("SingleThreadedExecutor", 1, at=1.5)
    run.stop(3.0)
    assert len(scene_at(told(run), 2.0).workers) == 3 + 1


def test_a_call_that_takes_no_time_is_seen_for_a_glance() -> None:
    timeline = one_call(length=0.0)
    assert [worker.stay for worker in scene_at(timeline, 1.1).workers] == [WorkerState.LEAVES]
    assert [worker.stay for worker in scene_at(timeline, 1.2).workers] == [WorkerState.IDLE]


def test_a_call_that_has_run_a_while_is_not_told_to_start_though_its_worker_still_walks() -> None:
    run = Run()
    pack = run.timer(run.exclusive(run.node("/n")), "pack", 1.0)
    run.callback(pack, run.thread("MainThread"), 1.0, 0.5)
    begun, later = (plain(FactoryPainter().paint(told(run), ns(at), 90, 9)) for at in (1.0, 1.1))
    assert "starts" in begun
    assert "MainThread goes to A" in begun
    assert "100 ms" in later
    assert "MainThread works in A" in later


@pytest.mark.parametrize(("lasted", "did"), [(0.0, "raised at once"), (0.5, "raised")])
def test_of_a_call_that_raised_that_is_told(lasted: float, did: str) -> None:
    run = Run()
    watch, thread = run.timer(run.exclusive(run.node("/n")), "watch", 1.0), run.thread("MainThread")
    run.start(watch, thread, 1.0)
    run.fail(watch, thread, 1.0 + lasted, "KeyError: 1")
    run.end(watch, thread, 1.0 + lasted)
    picture = plain(FactoryPainter().paint(told(run), ns(1.01 + lasted), 78, 9))
    assert f"watch {did}" in picture
    assert "watch took" not in picture


def test_a_timer_is_on_its_way_from_when_it_is_made_and_due_at_its_moment() -> None:
    run = Run()
    node = run.node("/n")
    run.timer(run.exclusive(node), "tick", 1.0)
    run.log("one", 1.5)
    due = [scene_at(told(run), at).areas[0].belts[0].tick for at in (0.5, 1.0, 1.5)]
    assert [None if each is None else each.due for each in due] == [ns(1.0), ns(1.0), None]
    assert "is due" in plain(FactoryPainter().paint(told(run), ns(1.0), 78, 9))


def test_when_a_timer_is_due_is_unknown_on_a_simulated_clock_and_anew_after_a_reset() -> None:
    run = Run()
    simulated, node = run.node("/s"), run.node("/n")
    run.subscription(run.exclusive(simulated), "/clock", "")
    run.timer(run.exclusive(simulated), "tick", 1.0)
    again = run.timer(run.exclusive(node), "again", 1.0)
    run.add(TimerCancelled(ns(0.1), again))
    run.add(TimerReset(ns(0.6), again))
    ticks = [belt.tick for area in scene_at(told(run), 0.7).areas for belt in area.belts if belt.tick]
    assert [each.due for each in ticks] == [None, ns(1.6)]


@pytest.mark.parametrize("threads", [(0, 1), (1, 0), (0, 0)])
def test_of_calls_that_ended_at_one_moment_the_last_one_just_ran(threads: tuple[int, int]) -> None:
    run = Run()
    workers = [run.thread("Pool-0_0"), run.thread("Pool-0_1")]
    group = run.exclusive(run.node("/n"))
    pack, watch = run.timer(group, "pack", 1.0), run.timer(group, "watch", 1.0)
    run.callback(pack, workers[threads[0]], 1.0, 0.5)
    run.callback(watch, workers[threads[1]], 1.5, 0.0)
    picture = plain(FactoryPainter().paint(told(run), ns(1.51), 78, 9))
    assert "watch took no time" in picture
    assert "pack took" not in picture


@given(st.floats(0.0, 0.149), st.sampled_from([0.1, 1.0, 5.0, 20.0]))
def test_at_any_speed_a_worker_has_walked_as_far_after_the_same_moment_on_screen(
    shown: float, speed: float
) -> None:
    timeline = one_call(length=8.0)
    (worker,) = scene_at(timeline, 1.0 + shown * speed, 0.15 * speed).workers
    (slow,) = scene_at(timeline, 1.0 + shown, 0.15).workers
    assert worker.stay is WorkerState.COMES
    assert abs(worker.step - slow.step) <= 1


def test_a_coming_worker_nears_the_area_and_a_leaving_one_the_yard() -> None:
    def column(at: float, sign: str) -> int:
        text = plain(FactoryPainter(Charset.ASCII).paint(one_call(), ns(at), 78, 9))
        (line,) = (line for line in text.splitlines() if sign in line)
        return line.index(sign)

    assert column(1.0, "<@") > column(1.06, "<@") > column(1.14, "<@")
    assert column(2.0, "o>") < column(2.06, "o>") < column(2.14, "o>")


def test_threads_that_an_executor_has_not_started_yet_are_workers_too() -> None:
    workers = scene_at(four_workers_one_seat(), 9.0).workers
    assert [worker.name for worker in workers] == ["Pool-0_0", "worker 2", "worker 3", "worker 4"]
    assert [worker.stay for worker in workers[1:]] == [WorkerState.NEVER] * 3


def test_housekeeping_services_are_left_out() -> None:
    run = Run()
    run.thread("MainThread")
    node = run.node("/n")
    group = run.exclusive(node)
    run.service(group, "/n/get_parameters", "get_parameters_callback")
    run.service(run.exclusive(node), "/n/list_parameters", "list_parameters_callback")
    run.subscription(group, "/a", "a_callback")
    assert [belt.entity.name for belt in only_area(told(run), 1.0).belts] == ["/a"]


def test_areas_have_the_letters_and_numbers_of_their_groups_though_some_are_left_out() -> None:
    run = Run()
    node = run.node("/n")
    run.service(run.exclusive(node), "/n/list_parameters", "list_parameters_callback")
    run.subscription(run.exclusive(node), "/a", "a_callback")
    timeline = told(run)
    area = only_area(timeline, 1.0)
    assert (area.group.letter, area.number) == ("B", 1)
    rows = FactoryPainter().paint(timeline, ns(1.0), 64, 12)
    assert {run.ink.number for row in rows for run in row if run.ink.role is Role.LINE} == {1}


def test_a_suspended_coroutine_keeps_its_seat_and_frees_its_worker() -> None:
    run = Run()
    worker = run.thread("MainThread")
    asking = run.subscription(run.exclusive(run.node("/n")), "/a", "ask_callback")
    run.start(asking, worker, 1.0)
    run.suspend(asking, worker, 2.0)
    timeline = told(run)
    scene = scene_at(timeline, 3.0)
    assert [worker.stay for worker in scene.workers] == [WorkerState.IDLE]
    assert [entity.callback for entity in scene.areas[0].kept] == ["ask_callback"]
    assert "kept by ask_callback" in plain(FactoryPainter().paint(timeline, ns(3.0), 78, 9))


@pytest.mark.parametrize(("width", "height"), [(78, 9), (130, 30)])
def test_a_call_that_awaits_in_an_open_area_has_not_ended_and_keeps_no_seat(width: int, height: int) -> None:
    run = Run()
    worker = run.thread("MainThread")
    group = run.reentrant(run.node("/n"))
    asking = run.subscription(group, "/a", "ask_callback")
    run.timer(group, "other", 9.0)
    run.start(asking, worker, 1.0)
    run.suspend(asking, worker, 2.0)
    timeline = told(run)
    picture = plain(FactoryPainter().paint(timeline, ns(2.01), width, height))
    assert "ask_callback awaits" in picture
    assert not any(word in picture for word in ("kept", "just ran", "took"))
    lanes = plain(LanePainter().paint(timeline, Window(0, ns(5.0)), ns(2.01), 140, 8).rows)
    assert "open, 1 awaits" in lanes


@pytest.mark.parametrize(("width", "height"), [(78, 9), (138, 30)])
def test_a_task_is_in_no_group_and_has_no_belt(width: int, height: int) -> None:
    run = Run()
    worker = run.thread("MainThread")
    run.callback(run.task(run.node("/n"), "answered"), worker, 1.0, 1.0)
    timeline = told(run)
    picture = plain(FactoryPainter().paint(timeline, ns(1.5), width, height))
    (head,) = (line for line in picture.splitlines() if " A " in line and "MainThread" not in line)
    assert "no group" in head
    (row,) = (line for line in picture.splitlines() if line.startswith(" answered"))
    assert set(row.removeprefix(" answered")[: row.index("╎") - len(" answered")]) == {" "}
    lanes = plain(LanePainter().paint(timeline, Window(0, ns(5.0)), ns(1.5), width, 8).rows)
    assert "reentrant" not in picture + lanes


def test_a_timer_that_waits_for_its_own_last_call_is_not_counted_among_those_who_wait() -> None:
    timeline = split_groups()
    assert not list(scene_at(timeline, 9.4).waits())
    text = plain(FactoryPainter().paint(timeline, ns(9.4), 104, 20))
    assert "late 4.9 s: its last call still runs" in text


def test_the_next_tick_leaves_out_those_that_were_missed() -> None:
    run = Run()
    timer = run.timer(run.exclusive(run.node("/n")), "tick_callback", 1.0)
    run.callback(timer, run.thread("MainThread"), 5.3, 0.1, late=3.3)
    (belt,) = only_area(told(run), 5.5).belts
    assert belt.tick is not None
    assert belt.tick.due == ns(6.0)
    assert belt.tick.late == ns(3.3)


def test_a_tick_nears_the_door_until_it_is_due() -> None:
    run = Run()
    timer = run.timer(run.exclusive(run.node("/n")), "tick_callback", 1.0)
    run.callback(timer, run.thread("MainThread"), 1.0, 0.0)
    timeline = told(run)

    def place(at: float) -> int:
        (line,) = (
            line
            for line in plain(FactoryPainter(Charset.ASCII).paint(timeline, ns(at), 78, 9)).splitlines()
            if "*" in line
        )
        return line.index("*")

    assert place(1.1) < place(1.5) < place(1.9)


@pytest.mark.parametrize(
    ("reason", "words"),
    [
        (Reason.NO_FREE_WORKER, "waits 2.0 s: no free worker"),
        (Reason.EVENT_QUEUE, "2.0 s: in the event queue"),
        (Reason.NOBODY_SPINS, "waits 2.0 s: nobody spins"),
    ],
)
def test_whoever_waits_stands_at_the_door_with_the_reason(reason: Reason, words: str) -> None:
    run = Run()
    run.thread("MainThread")
    entity = run.subscription(run.exclusive(run.node("/n")), "/a", "a_callback")
    run.message(entity, 1.0)
    run.wait(entity, 1.0, None, reason)
    run.stop(9.0)
    assert words in plain(FactoryPainter().paint(told(run), ns(3.0), 78, 9))


def test_a_full_belt_says_so_and_what_it_lost() -> None:
    text = plain(FactoryPainter().paint(four_workers_one_seat(), ns(9.0), 78, 9))
    assert "3/3 ! lost 2" in text


def test_boxes_carry_their_ages_the_oldest_at_the_door() -> None:
    text = plain(FactoryPainter(Charset.ASCII).paint(four_workers_one_seat(), ns(9.0), 78, 9))
    assert "[4.5s][4.6s][4.7s]X" in text


def test_a_blocked_worker_names_the_service_where_there_is_room() -> None:
    text = plain(FactoryPainter().paint(stuck_in_a_call(), ns(3.0), 138, 30))
    assert "blocked in /motor_power 1.8 s" in text


def test_more_belts_than_rows_say_how_many_are_left_out() -> None:
    run = Run()
    run.thread("MainThread")
    group = run.exclusive(run.node("/n"))
    entities = [run.subscription(group, f"/t{number}", f"t{number}_callback") for number in range(20)]
    run.wait(entities[17], 1.0, None, Reason.NOBODY_SPINS)
    run.stop(9.0)
    text = plain(FactoryPainter().paint(told(run), ns(2.0), 64, 8))
    assert "t17" in text
    assert "+15 more belts" in text


def test_where_rows_are_few_those_who_are_busy_come_first() -> None:
    run = Run()
    threads = [run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(20)]
    group = run.exclusive(run.node("/n"))
    entities = [run.subscription(group, f"/t{number}", f"t{number}_callback") for number in range(20)]
    for entity, thread in zip(entities[:19], threads[:19], strict=True):
        run.callback(entity, thread, 0.1 + entity / 100, 0.001)
    run.callback(entities[19], threads[19], 1.0, 8.0)
    run.stop(9.0)
    text = plain(FactoryPainter().paint(told(run), ns(2.0), 120, 10))
    assert "Pool-0_19 works in A" in text
    assert "t19 0/10" in text


def test_everybody_in_an_open_area_is_seen_in_a_single_row() -> None:
    run = Run()
    node = run.node("/n")
    group = run.reentrant(node)
    box = run.subscription(group, "/box", "box_callback")
    run.timer(run.exclusive(node), "blink", 1.0)
    run.timer(run.exclusive(node), "beat", 1.0)
    for number in range(4):
        run.callback(box, run.thread(f"ThreadPoolExecutor-0_{number}"), 1.0, 8.0)
    run.stop(9.0)
    text = plain(FactoryPainter().paint(told(run), ns(2.0), 78, 9))
    assert "(☻) (☻) (☻) (☻) 4 busy" in text


@settings(max_examples=examples(150), deadline=None)
@given(
    st.sampled_from(RUNS).map(lambda timeline: timeline()),
    st.floats(0, 31),
    st.integers(0, 150),
    st.integers(0, 45),
    st.sampled_from(Charset),
)
def test_a_picture_has_the_size_that_was_asked_for(
    timeline: Timeline, now: float, width: int, height: int, charset: Charset
) -> None:
    text = plain(FactoryPainter(charset).paint(timeline, ns(now), width, height))
    lines = text.split("\n") if width and height else []
    assert len(lines) == (height if width else 0)
    assert all(cell_len(line) == width for line in lines)
    assert charset is not Charset.ASCII or text.isascii()


@given(st.sampled_from(RUNS).map(lambda timeline: timeline()), st.floats(0, 31), st.floats(0, 31))
@settings(max_examples=examples(30), deadline=None)
def test_a_moment_looks_the_same_whatever_was_looked_at_before(
    timeline: Timeline, now: float, other: float
) -> None:
    painter = FactoryPainter()
    before = painter.paint(timeline, ns(now), 78, 9)
    painter.paint(timeline, ns(other), 78, 9)
    assert painter.paint(timeline, ns(now), 78, 9) == before


@pytest.mark.parametrize(("width", "height"), [(38, 10), (64, 12), (78, 9), (138, 38)])
def test_walls_stand_still_whatever_happens(width: int, height: int) -> None:
    def walls(timeline: Timeline, at: float) -> list[tuple[int, int]]:
        rows = plain(FactoryPainter().paint(timeline, ns(at), width, height)).splitlines()
        signs = "┏┓┗┛┣┫┃"
        return [(y, x) for y, row in enumerate(rows) for x, sign in enumerate(row) if sign in signs]

    for timeline in (shared_group(), split_groups()):
        assert len({tuple(walls(timeline, at / 10)) for at in range(0, 300, 7)}) == 1


def test_areas_of_several_executors_say_whose_they_are() -> None:
    run = Run()
    main, beside = run.thread("MainThread"), run.thread("Thread-1 (spin)")
    timers = [run.timer(run.exclusive(run.node(f"/{name}")), name, 1.0) for name in ("a", "b")]
    run.callback(timers[0], main, 1.0, 0.1)
    run.callback(timers[1], beside, 2.0, 0.1)
    timeline = told(run)
    assert [area.crew for area in scene_at(timeline, 1.5).areas] == ["", ""]
    assert [area.crew for area in scene_at(timeline, 9.0).areas] == ["MainThread", "Thread-1"]
    picture = plain(FactoryPainter().paint(timeline, ns(9.0), 78, 14))
    assert " A ██ MainThread ━" in picture
    assert " B ·· one seat, Thread-1 ━" in picture


def test_a_timer_that_was_cancelled_has_no_next_tick_until_it_is_called_again() -> None:
    run = Run()
    timer, thread = run.timer(run.exclusive(run.node("/n")), "tick", 1.0), run.thread("MainThread")
    run.callback(timer, thread, 1.0, 0.1)
    run.add(TimerCancelled(ns(1.05), timer))
    run.callback(timer, thread, 3.0, 0.1)
    timeline = told(run)

    def due(at: float) -> int | None:
        (belt,) = only_area(timeline, at).belts
        return None if belt.tick is None else belt.tick.due

    assert [due(at) for at in (1.02, 1.06, 2.5, 3.5)] == [ns(2.0), None, None, ns(4.0)]
    pictures = [plain(FactoryPainter().paint(timeline, ns(at), 78, 14)) for at in (1.02, 2.5, 3.5)]
    assert ["cancelled" in each for each in pictures] == [False, True, False]


def test_a_thread_whose_callback_raised_and_whose_node_nobody_spins_waits_for_no_work() -> None:
    run = Run()
    worker = run.thread("Thread-1 (spin)")
    timer = run.timer(run.exclusive(run.node("/n")), "tick_callback", 1.0)
    run.start(timer, worker, 1.0)
    run.fail(timer, worker, 1.0, "ValueError: no scan")
    run.wait(timer, 2.0, reason=Reason.NOBODY_SPINS)
    run.stop(9.0)
    assert [each.stay for each in scene_at(told(run), 3.0).workers] == [WorkerState.STOPPED]


def test_a_thread_whose_callback_another_one_runs_now_waits_for_no_work() -> None:
    run = Run()
    main, worker = run.thread("MainThread"), run.thread("Thread-1 (spin)")
    other = run.timer(run.exclusive(run.node("/n")), "other", 1.0)
    timer = run.timer(run.exclusive(run.node("/n")), "tick", 1.0)
    run.callback(timer, main, 1.0, 0.1)
    run.callback(other, worker, 1.5, 0.1)
    run.callback(timer, worker, 2.0, 0.1)
    run.stop(9.0)
    stays = [[each.stay for each in scene_at(told(run), at).workers] for at in (1.8, 3.0)]
    assert stays == [[WorkerState.IDLE] * 2, [WorkerState.STOPPED, WorkerState.IDLE]]
