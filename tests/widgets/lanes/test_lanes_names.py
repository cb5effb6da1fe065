import pytest

from cbtui.widgets.lanes.names import group_name, more_lanes, service_name, shortened, thread_name, told_apart
from cbtui.widgets.lanes.painter import LanePainter
from cbtui.widgets.lanes.rows import GroupLane, MemberLane, SoleLane, ThreadLane, all_lanes, choose_lanes
from sim.trace.events import EntityAppeared, EntityKind, GroupKind, Reason
from sim.trace.model import GroupInfo, ThreadInfo, Window
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns


@pytest.mark.parametrize(
    ("name", "room", "shown"),
    [
        ("MainThread", 11, "MainThread"),
        ("ThreadPoolExecutor-0_0", 22, "ThreadPoolExecutor-0_0"),
        ("ThreadPoolExecutor-0_0", 11, "Pool-0_0"),
        ("exercise53-1 ThreadPoolExecutor-0_0", 22, "exercise53-1 Pool-0_0"),
        ("exercise53-1 ThreadPoolExecutor-0_0", 18, "exer…53-1 Pool-0_0"),
        ("exercise53-1 ThreadPoolExecutor-0_0", 11, "ex…3-1 P0_0"),
        ("talker MainThread", 11, "talker Main"),
        ("exercise53-1 worker-thread-of-mine", 11, "exercise53-1 worker-thread-of-mine"),
    ],
)
def test_a_threads_name_gives_way_where_it_tells_least(name: str, room: int, shown: str) -> None:
    assert thread_name(ThreadInfo(1, name, 0), room, "…") == shown


def test_threads_of_programs_that_differ_at_the_end_stay_apart() -> None:
    names = {thread_name(ThreadInfo(1, f"exercise53-{n} MainThread", 0), 11, "…") for n in range(1, 4)}
    assert len(names) == 3


@pytest.mark.parametrize(("room", "shown"), [(9, "exclusive"), (8, "excl")])
def test_a_groups_kind_is_cut_to_what_it_is_known_by(room: int, shown: str) -> None:
    assert group_name(GroupInfo(1, 1, GroupKind.EXCLUSIVE, "", 0), room) == shown


@pytest.mark.parametrize(
    ("hidden", "key", "room", "shown"),
    [
        (2, "Z", 23, "+2 lanes: Z shows more"),
        (2, "Z", 12, "+2 lanes Z"),
        (1, "Z", 12, "+1 lane Z"),
        (12, "↑ ↓", 12, "+12 ↑ ↓"),
        (2, "Z", 6, "+2 Z"),
        (2, "", 23, "+2 lanes"),
    ],
)
def test_lanes_without_room_are_told_of_with_their_key(hidden: int, key: str, room: int, shown: str) -> None:
    assert more_lanes(hidden, key, room) == shown


@pytest.mark.parametrize(
    ("names", "room", "shown"),
    [
        (["dummy_server", "odom"], 9, ["dummy_se…", "odom"]),
        (["ask_and_wait", "ask_and_leave", "walk"], 9, ["ask_…wait", "ask_…eave", "walk"]),
        (["get_a_part", "get_a_part ◂"], 9, ["get_…part", "get_a_… ◂"]),
        (["fetch_it client", "fetch_it server"], 10, ["fe… client", "fe… server"]),
    ],
)
def test_a_name_loses_its_end_unless_another_one_begins_like_it(
    names: list[str], room: int, shown: list[str]
) -> None:
    assert [shortened(name, room, "…", names) for name in names] == shown


def test_names_that_differ_at_an_end_stay_apart() -> None:
    names = ("front_wheel_odometry", "rear_wheel_odometry", "front_wheel_current")
    assert len({shortened(name, 9, "…") for name in names}) == 3
    assert shortened("odom", 9, "…") == "odom"


@pytest.mark.parametrize(
    ("service", "room", "shown"),
    [
        ("/fetch/_action/send_goal", 24, "/fetch/_action/send_goal"),
        ("/fetch/_action/send_goal", 14, "fetch send"),
        ("/fetch/_action/get_result", 14, "fetch result"),
        ("/fetch/_action/cancel_goal", 12, "fetch cancel"),
        ("/navigate_to_pose/_action/cancel_goal", 14, "nav…ose cancel"),
        ("/fetch/_action/cancel_goal", 8, "cancel"),
        ("/motor_power_of_all", 11, "/moto…f_all"),
    ],
)
def test_an_actions_services_differ_by_a_word(service: str, room: int, shown: str) -> None:
    assert service_name(service, room, "…") == shown


def test_services_of_actions_that_begin_alike_stay_apart() -> None:
    services = [f"/fetch_{what}/_action/send_goal" for what in ("it", "them")]
    assert service_name(services[0], 12, "…", services[:1]) == "fetch_… send"
    assert len({service_name(service, 12, "…", services) for service in services}) == 2


def test_lanes_of_one_group_have_names_of_their_own() -> None:
    run = Run()
    group = run.exclusive(run.node("/n"))
    run.service(group, "/bake", "on_bake")
    run.client(group, "/bake")
    run.timer(group, "count", 1.0)
    run.subscription(group, "/count", "on_count")
    run.subscription(group, "/words", "on_words")
    run.timer(group, "lorry", 1.0)
    run.service(group, "/lorry", "on_lorry")
    timeline = run_timeline(run)
    names = [told_apart(each, timeline, "◂") for each in timeline.entities.values()]
    assert names == ["bake", "bake ◂", "count", "on_count", "words", "lorry", "/lorry"]


def test_the_servers_of_an_action_in_two_nodes_are_named_after_these() -> None:
    run = Run()
    for number, name in enumerate(("/robot", "/yard/dispatcher"), start=1):
        node = run.node(name)
        part = EntityAppeared(
            0, number, node, run.exclusive(node), EntityKind.WAITABLE, "/fetch_it server", "", "", 0, 0, 0, 0
        )
        run.add(part)
    timeline = run_timeline(run)
    names = [told_apart(each, timeline, "◂") for each in timeline.entities.values()]
    assert names == ["robot fetch_it server", "dispatcher fetch_it server"]


def test_a_thread_whose_callbacks_take_no_time_stays_before_a_service_that_nobody_called() -> None:
    run = Run()
    thread = run.thread("MainThread")
    group = run.exclusive(run.node("/n"))
    for name in ("one", "two"):
        run.callback(run.timer(group, name, 1.0), thread, 1.0, 0.0)
    timeline = run_timeline(run)
    lanes = choose_lanes(all_lanes(timeline, "/call"), 4, timeline, Window(0, ns(2.0)))
    assert [type(lane) for lane in lanes] == [ThreadLane, GroupLane, MemberLane, MemberLane]


def test_where_lanes_are_few_one_thread_stays_though_its_callbacks_take_no_time_and_others_wait() -> None:
    run = Run()
    thread, group = run.thread("MainThread"), run.exclusive(run.node("/n"))
    callbacks = [run.timer(group, f"ask_{number}", 1.0) for number in range(6)]
    for number, callback in enumerate(callbacks):
        run.wait(callback, 1.0, 1.1 + number, Reason.GROUP_HELD, callbacks[0])
        run.callback(callback, thread, 1.1 + number, 0.0)
    timeline = run_timeline(run)
    lanes = choose_lanes(all_lanes(timeline, ""), 4, timeline, Window(0, ns(5.0)), kept={callbacks[5]: 0})
    assert [type(lane) for lane in lanes] == [ThreadLane, GroupLane, MemberLane, MemberLane]


def test_where_lanes_are_few_threads_leave_room_for_callbacks_that_run() -> None:
    run = Run()
    node = run.node("/n")
    threads = [run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(6)]
    callbacks = [run.timer(run.exclusive(node), f"ask_{number}", 1.0) for number in range(6)]
    for thread, callback in zip(threads, callbacks, strict=True):
        run.callback(callback, thread, 0.5, 4.0)
    timeline = run_timeline(run)
    lanes = choose_lanes(all_lanes(timeline, ""), 8, timeline, Window(0, ns(5.0)))
    assert [isinstance(each, ThreadLane) for each in lanes] == 4 * [True] + 4 * [False]


def test_the_thread_that_the_picture_is_about_keeps_its_lane() -> None:
    run = Run()
    node = run.node("/n")
    threads = [run.thread(f"ThreadPoolExecutor-0_{number}") for number in range(6)]
    callbacks = [run.timer(run.exclusive(node), f"ask_{number}", 1.0) for number in range(6)]
    for thread, callback in zip(threads, callbacks, strict=True):
        run.callback(callback, thread, 0.5, 4.0)
    timeline = run_timeline(run)
    every, window = all_lanes(timeline, ""), Window(0, ns(5.0))
    about = next(lane for lane in every if isinstance(lane, ThreadLane) and lane.thread.id == threads[-1])
    assert about not in choose_lanes(every, 4, timeline, window)
    lanes = choose_lanes(every, 4, timeline, window, kept={callbacks[-1]: 0}, kept_thread=threads[-1])
    assert about in lanes
    assert callbacks[-1] in {lane.entity.id for lane in lanes if isinstance(lane, MemberLane | SoleLane)}
    selected = next(lane for lane in every if isinstance(lane, SoleLane) and lane.entity.id == callbacks[2])
    beside = choose_lanes(every, 3, timeline, window, selected, {callbacks[2]: 0}, threads[-1])
    assert about in beside
    assert about in LanePainter().paint(timeline, window, ns(5.0), 80, 5, kept_thread=threads[-1]).lanes
    assert selected in beside


def test_a_callback_that_the_picture_is_about_keeps_its_lane_though_it_is_idle() -> None:
    run = Run()
    node, thread = run.node("/n"), run.thread("MainThread")
    group = run.exclusive(node)
    callbacks = [run.timer(group, f"ask_{number}", 1.0) for number in range(6)]
    for number, callback in enumerate(callbacks[:-1]):
        run.callback(callback, thread, 0.5 * number, 0.5 * number + 0.1)
    timeline = run_timeline(run)
    every, window = all_lanes(timeline, ""), Window(0, ns(5.0))
    idle = every[-1]
    assert idle not in choose_lanes(every, 4, timeline, window)
    ranks = {callbacks[0]: 1, callbacks[-1]: 0}
    assert idle in choose_lanes(every, 4, timeline, window, kept=ranks)
    assert choose_lanes(every, 1, timeline, window, kept=ranks) == [idle]


def run_timeline(run: Run) -> Timeline:
    timeline = Timeline()
    timeline.extend(run.until(5.0))
    return timeline
