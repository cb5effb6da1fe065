"""Programs on real rclpy show what the model shows."""

import os
import sys
import time
from pathlib import Path
from selectors import DefaultSelector

import msgspec
import pytest

from sim.diagnosis import diagnose
from sim.diagnosis.rule import CodeLocation, Weight
from sim.engine.setup import RealRos, RobotUse
from sim.quantities.nanoseconds import SECOND
from sim.real.companions import RunRobot, ServiceCaller
from sim.real.programs import claimed_domain, unbootstrapped
from sim.real.wire import Sent
from sim.trace.events import (
    ArenaShown,
    CallbackFailed,
    CallbackResumed,
    CallbackStarted,
    CallbackSuspended,
    ExceptionSurfaced,
    Logged,
    MessageDropped,
    Notice,
    Printed,
    Published,
    Reason,
    RunEnding,
    ServiceCalled,
    ServiceReplied,
    Severity,
    WaitStarted,
)
from tests.real import programs
from tests.real.programs import entity_named, needs_ros, whole
from tests.support.engine_runs import Run, program_setup, run_to_end

BEGINNERS = Path(__file__).parents[1] / "diagnosis" / "beginners"
OF = ("", "_of_timer", "_of_service", "_of_done_callback")
pytestmark = [needs_ros, pytest.mark.slow]


@pytest.fixture(scope="module")
def starved(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return programs.run(
        tmp_path_factory.mktemp("starved"), programs.STARVED, "MultiThreadedExecutor(num_threads=2)"
    )


def test_a_wait_is_told_of_while_it_lasts_and_with_its_reason(starved: Run) -> None:
    timeline = starved.timeline
    work, hear = entity_named("work", timeline), entity_named("hear", timeline)
    spans = timeline.spans_of(work, whole(timeline))
    assert len(spans) >= 2
    waits = [event for event in starved.events if isinstance(event, WaitStarted) and event.entity == hear]
    delays = []
    for span in spans[:2]:
        assert span.end is not None
        told = next(wait for wait in waits if span.start < wait.t < span.end)
        assert (told.reason, told.holder) == (Reason.GROUP_HELD, work)
        delays.append(told.t - span.start)
    assert min(delays) < 0.3 * SECOND  # a busy machine may delay one


def test_a_guard_condition_waits_from_when_it_was_triggered(starved: Run) -> None:
    timeline = starved.timeline
    work, wake = entity_named("work", timeline), entity_named("wake", timeline)
    waits = [event for event in starved.events if isinstance(event, WaitStarted) and event.entity == wake]
    delays = []
    for span in timeline.spans_of(work, whole(timeline))[:2]:
        assert span.end is not None
        told = next(wait for wait in waits if span.start < wait.t < span.end)
        assert (told.reason, told.holder) == (Reason.GROUP_HELD, work)
        assert span.start < told.since < told.t
        delays.append(told.t - span.start)
    assert min(delays) < 0.3 * SECOND
    assert timeline.spans_of(wake, whole(timeline))


def test_what_a_full_queue_loses_is_counted(starved: Run) -> None:
    timeline = starved.timeline
    hear = entity_named("hear", timeline)
    lost = {event.message for event in starved.events if isinstance(event, MessageDropped)}
    taken = [e.message for e in starved.events if isinstance(e, CallbackStarted) and e.entity == hear]
    sent = [event.message for event in starved.events if isinstance(event, Published)]
    assert len(lost) >= 4  # of seven sent in 0.7 s, two are kept, twice over
    assert not lost & set(taken)
    assert 0 not in taken
    assert taken == sorted(taken)
    assert {message for message in sent if message <= taken[-1]} <= lost | set(taken) <= set(sent)


def test_log_and_output_are_told_of_once(starved: Run) -> None:
    logs = [event.text for event in starved.events if isinstance(event, Logged)]
    own = ("works", "worked")  # rclpy itself may print at Ctrl-C that it could not publish any more
    prints = [event.text for event in starved.events if isinstance(event, Printed) and event.text in own]
    assert set(logs) == {"works"}
    assert set(prints) == {"worked"}
    assert abs(len(logs) - len(prints)) <= 1


def test_the_run_ends_when_its_time_is_up_and_nothing_had_to_be_forced(starved: Run) -> None:
    assert starved.ending.time_was_up
    assert not starved.ending.failed
    assert next(event.t for event in starved.events if isinstance(event, RunEnding)) == 3.3 * SECOND
    assert [event.text for event in starved.events if isinstance(event, Notice)] == []
    assert starved.loss is None


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "import threading\nprint('here')\nthreading.Event().wait()\n",
            "the program has not imported rclpy so far; until then there is only its output to show",
        ),
        ("print('here')\n", "the program has not imported rclpy: there was only its output to show"),
    ],
    ids=["goes on", "returns"],
)
def test_of_a_program_without_rclpy_its_output_is_shown_and_that_is_told(
    tmp_path: Path, text: str, sentence: str
) -> None:
    path = tmp_path / "plain.py"
    path.write_text(text)
    run = run_to_end(msgspec.structs.replace(program_setup(path, 0.5, clock="real"), real=RealRos()))
    assert [event.text for event in run.events if isinstance(event, Printed)][:1] == ["here"]
    (told,) = (event for event in run.events if isinstance(event, Notice))
    assert told.text == sentence
    assert told.t < 0.2 * SECOND
    assert not run.ending.failed


@pytest.mark.parametrize("ground", ["ros2", "model"])
def test_what_a_program_raises_when_it_is_ended_is_told_and_no_failure_of_the_run(
    tmp_path: Path, ground: str
) -> None:
    run = programs.run(tmp_path, programs.RAISES_AT_ITS_END, ground=ground, seconds=1.0)
    assert run.ending.time_was_up
    assert not run.ending.failed
    (told,) = (event.text for event in run.events if isinstance(event, Notice))
    assert "raised ValueError: too late" in told


@pytest.mark.parametrize(
    ("body", "executor", "rule"),
    [
        (programs.CALLS_ITSELF, "SingleThreadedExecutor()", "self-made-deadlock"),
        (programs.CALLS_ITSELF, "MultiThreadedExecutor(num_threads=2)", "self-made-deadlock"),
        (programs.WANTS_ONE_MORE, "MultiThreadedExecutor(num_threads=2)", "needs-one-more-worker"),
        (programs.NEVER_MATCHES, "SingleThreadedExecutor()", "qos-mismatch"),
    ],
    ids=["one thread", "two threads", "no thread left", "no match"],
)
def test_a_problem_is_the_same_on_both_grounds(tmp_path: Path, body: str, executor: str, rule: str) -> None:
    found = {}
    for ground in ("ros2", "model"):
        timeline = programs.run(tmp_path, body, executor, ground=ground, seconds=2.0).timeline
        told = [each for each in diagnose(timeline) if each.rule.id == rule]
        found[ground] = [each.explained(timeline).what for each in told]
    assert found["ros2"] == found["model"]
    assert len(found["ros2"]) == 1


@pytest.mark.parametrize(
    "made",
    ["self.create_timer(0.2, self.tick)", "self.create_timer(0.4, self.tick).timer_period_ns = 200_000_000"],
)
def test_a_tick_that_missed_others_is_as_late_as_the_first_of_them(tmp_path: Path, made: str) -> None:
    body = programs.MISSES_TICKS.replace("self.create_timer(0.2, self.tick)", made)
    timeline = programs.run(tmp_path, body, seconds=2.1).timeline
    [work], ticks = (
        timeline.calls_begun(entity_named(name, timeline), whole(timeline)) for name in ("work", "tick")
    )
    assert work.end is not None
    late = next(tick for tick in ticks if tick.start > work.end)
    missed = next(
        due for due in range(ticks[0].start - ticks[0].age, work.end, SECOND // 5) if due > work.start
    )
    assert late.start - late.age == pytest.approx(missed, abs=0.05 * SECOND)


def test_a_coroutine_leaves_its_thread_and_comes_back(tmp_path: Path) -> None:
    run = programs.run(tmp_path, programs.AWAITS, seconds=2.3)
    tick = entity_named("tick", run.timeline)
    steps = [
        type(event)
        for event in run.events
        if isinstance(event, CallbackSuspended | CallbackResumed) and event.entity == tick
    ]
    assert steps[:4] == [CallbackSuspended, CallbackResumed] * 2
    said = next(event for event in run.events if isinstance(event, Logged))
    assert (said.text, said.entity) == ("answered well", tick)


def test_calls_from_outside_come_in_and_are_answered(tmp_path: Path) -> None:
    run = programs.run(tmp_path, programs.AWAITS, "SingleThreadedExecutor()", 1.2, seconds=2.3)
    outside = next(event for event in run.events if isinstance(event, ServiceCalled) and event.entity == 0)
    assert outside.service == "/switch"
    assert outside.t == pytest.approx(1.2 * SECOND, abs=0.8 * SECOND)
    assert outside.call in {event.call for event in run.events if isinstance(event, ServiceReplied)}
    serve = entity_named("serve", run.timeline)
    served = {e.message for e in run.events if isinstance(e, CallbackStarted) and e.entity == serve}
    assert outside.call in served


def test_an_exception_ends_the_program_and_is_placed(tmp_path: Path) -> None:
    run = programs.run(tmp_path, programs.RAISES)
    failed = next(event for event in run.events if isinstance(event, CallbackFailed))
    assert (failed.error, Path(failed.file).name) == ("ValueError: no more", "tried.py")
    assert run.ending.failed
    assert run.ending.reason == f"tried.py:{failed.line}: the program raised ValueError: no more"
    [found] = diagnose(run.timeline)
    explained = found.explained(run.timeline)
    assert (explained.what, explained.place) == (
        "the program raised ValueError: no more",
        CodeLocation(failed.file, failed.line, failed.line),
    )


@pytest.mark.parametrize("ground", ["ros2", "model"])
def test_an_exception_that_a_pool_raises_and_the_program_catches_is_no_problem(
    tmp_path: Path, ground: str
) -> None:
    run = programs.run(tmp_path, programs.CATCHES, "Catching(2)", ground=ground)
    failed = next(event for event in run.events if isinstance(event, CallbackFailed))
    surfaced = next(event for event in run.events if isinstance(event, ExceptionSurfaced))
    assert (surfaced.error, surfaced.file, surfaced.line) == (failed.error, failed.file, failed.line)
    assert not run.ending.failed
    found = [each for each in diagnose(run.timeline) if "exception" in each.rule.id]
    assert all(each.weight_in(run.timeline) is Weight.REMARK for each in found)


@pytest.mark.parametrize("program", ["hides_a_name", *(f"wrong_arity{of}" for of in OF)])
def test_what_makes_rclpy_raise_is_told_at_its_definition_as_on_the_model(program: str) -> None:
    setup = program_setup(BEGINNERS / f"{program}.py", 3.0)
    real, model = (
        run_to_end(each).ending
        for each in (msgspec.structs.replace(setup, clock="real", real=RealRos()), setup)
    )
    assert real.place[1] > 0
    assert (real.place, real.advice) == (model.place, model.advice)


def test_a_module_with_a_syntax_error_is_told_at_its_line_as_on_the_model(tmp_path: Path) -> None:
    (tmp_path / "broken.py").write_text("x = 1\nx = {\n")
    program = tmp_path / "program.py"
    program.write_text("import rclpy\nimport broken\n")
    setup = program_setup(program, 3.0)
    real, model = (
        run_to_end(each).ending
        for each in (msgspec.structs.replace(setup, clock="real", real=RealRos()), setup)
    )
    assert real.reason == "broken.py:2: '{' was never closed"
    assert (real.reason, real.place, real.exception) == (model.reason, model.place, model.exception)


def test_a_wait_for_a_reply_by_await_is_told_at_its_line(tmp_path: Path) -> None:
    body = programs.AWAITS.replace("ReentrantCallbackGroup()", "MutuallyExclusiveCallbackGroup()")
    timeline = programs.run(tmp_path, body, "SingleThreadedExecutor()", seconds=2.3).timeline
    [found] = [each for each in diagnose(timeline) if each.rule.id == "self-made-deadlock"]
    place = found.explained(timeline).place
    assert place is not None
    assert "await" in Path(place.file).read_text().splitlines()[place.first_line - 1]


def test_a_goal_of_an_action_is_seen_at_work_as_on_the_model(tmp_path: Path) -> None:
    def seen(ground: str) -> set[tuple[str, str, str, int]]:
        timeline = programs.run(tmp_path, programs.ACTS, "MultiThreadedExecutor(2)", ground=ground).timeline
        entities = [timeline.entities[number] for number in timeline.entities]
        return {
            (
                each.name,
                each.callback,
                timeline.groups[each.group].kind,
                len(timeline.spans_of(each.id, whole(timeline))),
            )
            for each in entities
        }

    assert seen("ros2") == seen("model")
    assert ("/count", "execute", "no group", 1) in seen("model")


def test_a_timer_without_a_period_is_watched_as_any_other(tmp_path: Path) -> None:
    ran = programs.run(tmp_path, programs.ALWAYS_DUE, seconds=2.0)
    assert ran.timeline.ended is not None
    assert not ran.timeline.ended.failed
    assert sum(isinstance(event, CallbackStarted) for event in ran.events) > 5


def test_what_waits_behind_a_callback_of_an_events_executor_is_seen(tmp_path: Path) -> None:
    timeline = programs.run(tmp_path, programs.WAITS_IN_THE_EVENT_QUEUE, "Looping()", seconds=2.0).timeline
    [first, *_] = timeline.waits_of(entity_named("hear", timeline), whole(timeline))
    assert first.reason is Reason.EVENT_QUEUE
    assert first.holder == entity_named("tell", timeline)


@pytest.mark.parametrize("spin", ["rclpy.spin(self)", "self.executor.spin()"])
def test_a_spin_inside_a_callback_is_told_as_what_keeps_its_group(spin: str, tmp_path: Path) -> None:
    body = f"""
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_timer(0.2, self.tick)

    def tick(self):
        {spin}
"""
    timeline = programs.run(tmp_path, body, seconds=3.0).timeline
    told = next(each.explained(timeline) for each in diagnose(timeline) if each.rule.id == "nested-spin")
    assert told.what.startswith("deadlock: tick waits in spin() for ever; all callbacks of its node are in")
    assert told.place is not None
    assert Path(told.place.file).read_text().splitlines()[told.place.first_line - 1].strip() == spin


def test_two_threads_that_spin_one_executor_are_told_with_the_exception_that_ends_one(tmp_path: Path) -> None:
    path = tmp_path / "tried.py"
    path.write_text((BEGINNERS / "two_threads_spin.py").read_text())
    run = run_to_end(msgspec.structs.replace(program_setup(path, 4.0), clock="real", real=RealRos()))
    first, *_ = (each.explained(run.timeline) for each in diagnose(run.timeline))
    assert first.what == (
        "the program spins an executor that another thread spins, by spin(): "
        "ValueError: generator already executing, which ended that thread"
    )
    assert first.place is not None
    assert "target=rclpy.spin" in path.read_text().splitlines()[first.place.first_line - 1]
    assert "thread-raised" not in [each.rule.id for each in diagnose(run.timeline)]
    waits = {
        wait.reason
        for each in run.timeline.entities
        for wait in run.timeline.waits_of(each, whole(run.timeline))
        if wait.end_at(run.timeline.end) - wait.start > SECOND
    }
    assert waits == {Reason.NOBODY_SPINS}, "its spin() has taken the node out again"


def test_an_exception_that_ends_a_thread_is_told_as_on_the_model(tmp_path: Path) -> None:
    setup = program_setup(BEGINNERS / "thread_raises.py", 3.0)
    on_model, on_ros = (
        [(each.explained(run.timeline).what, each.explained(run.timeline).place) for each in found]
        for run in (
            run_to_end(setup),
            run_to_end(msgspec.structs.replace(setup, clock="real", real=RealRos())),
        )
        for found in [[each for each in diagnose(run.timeline) if each.rule.id == "thread-raised"]]
    )
    assert on_model
    assert on_ros == on_model


SLEEPS_BY_A_RATE = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.rate = self.create_rate(2)
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.rate.sleep()
"""


@pytest.mark.slow
def test_what_sleeps_by_a_rate_whose_timer_needs_its_thread_is_told_as_on_the_model(tmp_path: Path) -> None:
    timelines = [programs.run(tmp_path, SLEEPS_BY_A_RATE, ground=each).timeline for each in ("model", "ros2")]
    on_model, on_ros = ([each.explained(of).what for each in diagnose(of)] for of in timelines)
    assert "needs the only thread" in on_model[0]
    assert on_ros == on_model


RATE = """
class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.create_timer(0.3, self.walk)

    def walk(self):
        rate = self.create_rate(5.0)
        rate.sleep()
        self.destroy_rate(rate)
"""


@pytest.mark.parametrize("ground", ["model", "ros2"])
def test_a_single_threaded_executor_is_given_more_threads(tmp_path: Path, ground: str) -> None:
    timeline = programs.run(tmp_path, RATE, ground=ground, seconds=1.5, threads=2).timeline
    assert [(each.kind, each.threads) for each in timeline.executors.values()] == [
        ("MultiThreadedExecutor", 2)
    ]
    assert "rate's timer" in {each.callback for each in timeline.entities.values()}
    walk = entity_named("walk", timeline)
    assert timeline.calls_of(walk, whole(timeline)) >= 2


SIM_TIME = """
from threading import Thread

from rclpy.duration import Duration
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock


class Tried(Node):
    def __init__(self):
        super().__init__("tried", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.create_service(SetBool, "bake", self.bake)
        world = rclpy.create_node("world")
        publisher = world.create_publisher(Clock, "/clock", 10)
        start = time.time()

        def tick():
            message = Clock()
            message.clock.sec, message.clock.nanosec = divmod(int((time.time() - start) * 1e9), 10**9)
            publisher.publish(message)

        world.create_timer(0.05, tick)
        executor = SingleThreadedExecutor()
        executor.add_node(world)
        Thread(target=executor.spin, daemon=True).start()

    def bake(self, request, response):
        self.get_clock().sleep_for(Duration(seconds=1))
        return response
"""


@pytest.mark.parametrize("ground", ["model", "ros2"])
def test_a_sleep_by_simulated_time_that_stops_its_clock_is_a_deadlock(tmp_path: Path, ground: str) -> None:
    call = 1.5  # seconds in which a busy machine has loaded rclpy
    timeline = programs.run(
        tmp_path, SIM_TIME, "SingleThreadedExecutor()", call, ground=ground, seconds=4.5
    ).timeline
    (found,) = (each for each in diagnose(timeline) if each.rule.id == "self-made-deadlock")
    assert found.rule.kind(found, timeline) == "deadlock-over-the-clock"
    assert "clock_callback" in {each.callback for each in timeline.entities.values()}


UNANSWERED = """
from rclpy.parameter import Parameter


class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.declare_parameter("speed", 1)
        self.add_on_set_parameters_callback(self.asked)
        self.create_timer(0.2, self.tick)

    def asked(self, parameters):
        pass

    def tick(self):
        refused = self.set_parameters([Parameter("speed", value=2)])
"""


@pytest.mark.parametrize("ground", ["model", "ros2"])
def test_a_parameter_callback_that_returns_nothing_is_told_once(tmp_path: Path, ground: str) -> None:
    timeline = programs.run(tmp_path, UNANSWERED, ground=ground, seconds=1.5).timeline
    (found,) = (each for each in diagnose(timeline) if each.rule.id == "slip")
    told = found.explained(timeline)
    assert told.what == "asked returned no SetParametersResult, so rclpy refuses what was to be set"
    assert told.place is not None


REFUSED = """
from rclpy.parameter import Parameter


class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.declare_parameter("speed", 1)
        self.create_timer(0.2, self.tick)

    def tick(self):
        looked_at = self.set_parameters([Parameter("speed", value=1.5)])
        self.set_parameters([Parameter("speed", value=2)])
        self.set_parameters([Parameter("speed", value=2.5)])  # dropped
"""


@pytest.mark.parametrize("ground", ["model", "ros2"])
def test_a_refused_parameter_is_told_where_its_answer_is_dropped(tmp_path: Path, ground: str) -> None:
    run = programs.run(tmp_path, REFUSED, ground=ground, seconds=1.5)
    (found,) = (each for each in diagnose(run.timeline) if each.rule.id == "answer-overlooked")
    told = found.explained(run.timeline)
    assert "tick does not look at what set_parameters() returns: speed was refused: Wrong" in told.what
    assert told.place is not None
    assert "# dropped" in Path(told.place.file).read_text().splitlines()[told.place.first_line - 1]


def test_the_robot_leaves_a_real_run_whose_program_publishes_for_its_sensors() -> None:
    told: list[object] = []
    with DefaultSelector() as selector:
        robot = RunRobot(RobotUse.WHEN_USED, None, None, selector, {}, told.extend)
        robot.hear([Sent(5, 1, "/numbers", 0, 0, 0, 0)])
        assert told == []
        robot.hear([Sent(6, 2, "/scan", 0, 0, 0, 0)])
        robot.hear([Sent(7, 3, "/scan", 0, 0, 0, 0)])
    text = "the program publishes /scan itself, so the lessons' robot stays out"
    assert told == [Notice(6, Severity.INFO, text), ArenaShown(6, (), (0, 0, 0), 0)]


def test_what_helps_a_run_leaves_nothing_in_shared_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("FASTDDS_BUILTIN_TRANSPORTS")
    domain, claim = claimed_domain()
    ports = {f"fastrtps_port{7400 + 250 * domain + place}" for place in range(250)}
    deadline = time.monotonic() + 60

    def left() -> set[str]:
        return ports & set(os.listdir("/dev/shm"))  # noqa: PTH208

    with claim, DefaultSelector() as selector:
        for old in left():  # what somebody else was killed beside, in a domain that is ours now
            Path("/dev/shm", old).unlink()
        environment = {**unbootstrapped(sys.executable), "ROS_DOMAIN_ID": str(domain)}
        caller = ServiceCaller(selector, sys.executable, environment, print)
        robot = RunRobot(RobotUse.ALWAYS, None, None, selector, environment, print).process
        caller.start()
        robot.start()
        while len(left()) < 2:
            assert time.monotonic() < deadline, "of each process a port"
            time.sleep(0.05)
        caller.stop()
        robot.stop()
        while selector.get_map():
            for key, _ in selector.select():
                key.data()
    assert left() == set()


NOBODY_OFFERS = """
from std_srvs.srv import Trigger


class Tried(Node):
    def __init__(self):
        super().__init__("tried")
        self.client = self.create_client(Trigger, "calibrate")
        self.create_timer(0.3, self.tick)

    async def tick(self):
        await self.client.call_async(Trigger.Request())
"""


@pytest.mark.parametrize("ground", ["model", "ros2"])
def test_a_call_of_a_service_that_nobody_offers_is_told(tmp_path: Path, ground: str) -> None:
    timeline = programs.run(tmp_path, NOBODY_OFFERS, ground=ground, seconds=1.5).timeline
    (found,) = (each for each in diagnose(timeline) if each.rule.id == "nobody-offers")
    assert found.explained(timeline).what.startswith("tick called /calibrate, which nobody offered")


@pytest.mark.parametrize("ground", ["model", "ros2"])
def test_a_service_that_returns_no_response_is_told_alone_though_it_ends_the_program(ground: str) -> None:
    setup = program_setup(BEGINNERS / "no_response.py", 3.0)
    if ground == "ros2":
        setup = msgspec.structs.replace(setup, clock="real", real=RealRos())
    timeline = run_to_end(setup).timeline
    assert [each.rule.id for each in diagnose(timeline)] == ["unreturned-response"]
