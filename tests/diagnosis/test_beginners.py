"""Programs with a beginner's mistake each: one problem, with the line of the culprit and a cure.

The programs lie beside this file, in ``beginners``.
"""

from pathlib import Path

import pytest

from sim.diagnosis import Weight, diagnose
from tests.support.engine_runs import program_setup, run_program, run_to_end

PROGRAMS = Path(__file__).parent / "beginners"


@pytest.mark.parametrize(
    ("program", "rule", "culprit", "cure"),
    [
        ("nested_spin", "nested-spin", "rclpy.spin_until_future_complete(self, future)", "add_done_callback"),
        (
            "two_threads_spin",
            "nested-spin",
            "target=rclpy.spin, args=(right,)",
            "give each thread that spins an executor of its own",
        ),
        (
            "spin_in_function",
            "nested-spin",
            "rclpy.spin_until_future_complete(node, future)",
            "in an async def tick",
        ),
        (
            "spin_in_method",
            "nested-spin",
            "rclpy.spin_until_future_complete(self, self.future)",
            "in an async def plan",
        ),
        ("spin_in_service", "nested-spin", "spin_until_future_complete(", "await the future in an async def"),
        (
            "call_in_service",
            "self-made-deadlock",
            "self.adder.call(",
            "await the future of call_async() in an async def cook",
        ),
        ("spin_once", "nested-spin", "rclpy.spin_once(self)", "return from go, and go on in on_open"),
        ("asyncio_starved", "asyncio-starved", "while rclpy.ok():", "await asyncio.sleep(0)"),
        (
            "event_of_its_group",
            "group-starvation",
            "self.opened.wait(0.8)",
            "give on_bell a callback group of its own",
        ),
        (
            "two_timers_too_much",
            "overload",
            "def right(self):",
            "give right a callback group of its own, and",
        ),
        ("call_longer_than_period", "overrun-timer", "self.client.call(", "go on in a done-callback"),
        ("int_for_float", "program-raised", "command.linear.x = 1", "1.0 in place of 1"),
        (
            "misspelt_service",
            "service-never-comes",
            "wait_for_service(",
            "call /motor_power, which is offered",
        ),
        (
            "await_in_vain",
            "self-made-deadlock",
            "await self.ready",
            "go on in future.add_done_callback(), or give tick a callback group of its own",
        ),
        ("await_in_own_group", "overrun-timer", "await self.ready", "let on_start complete it"),
        ("type_mismatch", "qos-mismatch", "create_subscription(String", "the same message type"),
        ("event_never_set", "endless-wait", "self.go.wait()", "call self.go.set() where start may go on"),
        ("barrier_of_more", "endless-wait", "self.gate.wait()", "make it a Barrier(1)"),
        ("wait_for_event", "endless-wait", "self.opened.wait()", "give go a callback group of its own"),
        (
            "semaphore_in_reentrant_group",
            "endless-wait",
            "self.parts.acquire()",
            "make sure that it comes; give take a MutuallyExclusiveCallbackGroup",
        ),
        ("job_waits_for_job", "endless-wait", "submit(self.plan)", "let it call the function itself"),
        (
            "asked_too_often",
            "service-falls-behind",
            "time.sleep(1.2)",
            "let tick ask again only when the reply is there",
        ),
        ("late_bound_lambda", "slip", "lambda: self.blink(colour)", "lambda colour=colour: …"),
        (
            "lambda_returns_coroutine",
            "slip",
            "lambda message: self.ask(message.data)",
            "hand over an async def, or a functools.partial of ask",
        ),
        ("yield_in_timer", "slip", "def go(self):", "write go without yield"),
        (
            "never_awaited",
            "slip",
            "self.is_well()",
            "put await before is_well(), in an async def tick; if it awaits a reply of /state, give tick a "
            "callback group of its own too, for it keeps its group meanwhile",
        ),
        ("call_in_timer", "self-made-deadlock", "self.client.call(", "use call_async()"),
        ("calls_of_two_peers", "self-made-deadlock", "self.client.call(", "num_threads=3"),
        ("calls_back_and_forth", "self-made-deadlock", "self.other.call(", "group of its own, and give "),
        ("call_in_script", "self-made-deadlock", "client.call(", "give ask a callback group of its own"),
        ("call_in_subscription", "self-made-deadlock", "self.client.call(", "use call_async()"),
        ("wait_for_future", "self-made-deadlock", "time.sleep(0.1)", "add_done_callback"),
        ("busy_wait_for_future", "self-made-deadlock", "while not future.done():", "add_done_callback"),
        ("join_in_timer", "self-made-deadlock", "thread.join()", "without join()"),
        (
            "result_of_job",
            "self-made-deadlock",
            ".result()",
            "return from tick without result(), and let the job do what comes later; or give tick a callback",
        ),
        ("while_true", "still-computing", "while True:", "return from tick, and go on in on_ready;"),
        (
            "busy_wait_in_service",
            "still-computing",
            "while not self.closed:",
            "sleep() in the loop, and give close a callback group of its own",
        ),
        ("while_sleeping", "stays-in-loop", "while True:", "keep the state in self and return"),
        ("loop_in_subscription", "stays-in-loop", "while True:", "on_start begins a timer"),
        ("loop_with_break", "stays-in-loop", "while True:", "keep the state in self and return"),
        ("qos_mismatch", "qos-mismatch", "self.create_subscription(", "the same QoSProfile"),
        ("rate_sleep", "self-made-deadlock", "self.rate.sleep()", "num_threads=2"),
        (
            "wrong_arity",
            "program-raised",
            "def on_chatter(self):",
            "wrong_arity.py:10 raised it: rclpy calls on_chatter with other arguments; in line 16 write",
        ),
        ("no_self", "program-raised", "def on_chatter():", "def on_chatter(self, message)"),
        ("function_called", "program-raised", "self.create_timer(", "without calling it"),
        ("class_for_group", "program-raised", "callback_group=", "such as ReentrantCallbackGroup()"),
        ("wrong_arity_of_timer", "program-raised", "def tick(self, event):", "def tick(self)"),
        (
            "wrong_arity_of_service",
            "program-raised",
            "def on_bell(self, request):",
            "def on_bell(self, request, response)",
        ),
        (
            "wrong_arity_of_done_callback",
            "program-raised",
            "future.add_done_callback(lambda:",
            "write lambda future: …",
        ),
        ("result_at_once", "program-raised", "reply.message", "use the result in a done-callback"),
        ("result_of_helper", "program-raised", "response.message", "use the result in a done-callback"),
        ("call_before_spin", "node-never-spins", "self.client.call(", "use call_async() there"),
        ("publishes_in_loop", "node-never-spins", "while rclpy.ok():", "a timer's callback"),
        ("spin_once_seldom", "spins-too-rarely", "while rclpy.ok():", "call rclpy.spin(node)"),
        ("rate_in_main", "node-never-spins", "rate.sleep()", "spin the node in a thread beside the loop"),
        ("two_spins", "node-never-spins", "rclpy.spin(listener)", "add all nodes to one executor"),
        (
            "two_spins_of_new_nodes",
            "spin-not-reached",
            "rclpy.spin(Listener())",
            "add all nodes to one executor",
        ),
        (
            "node_in_two_executors",
            "node-never-spins",
            "other.add_node(talker)",
            "start the thread of line 39",
        ),
        ("two_executors", "node-never-spins", "viewer_executor.spin()", "add all nodes to one executor"),
        (
            "sim_time_without_clock",
            "clock-never-starts",
            "use_sim_time",
            "start what publishes",
        ),
        (
            "equal_stamps_only",
            "never-synchronised",
            "TimeSynchronizer(filters, 10)",
            "take an ApproximateTimeSynchronizer with slop=0.01",
        ),
        ("time_of_before", "times-kept", "self.done_at = now", "in a jump callback"),
        ("published_at_once", "sent-too-early", "self.create_subscription(", "TRANSIENT_LOCAL"),
        ("period_of_zero", "always-due", "1 // RATE", "give it a period in seconds"),
        (
            "lookup_in_timer",
            "lookup-keeps-transform",
            "self.buf.lookup_transform(",
            "give look a callback group",
        ),
        ("spin_past_executor", "spin-past-executor", "rclpy.spin(n)", "call ex.spin() in its place"),
        ("hides_a_name", "program-raised", "def handle(self, message):", "hides Node.handle"),
        ("input_in_timer", "program-raised", "input(", "read in another thread"),
        ("wait_for_service", "service-never-comes", "self.client.wait_for_service()", "start the node"),
        ("service_created_later", "service-never-comes", "wait_for_service()", "create /grip in __init__"),
        ("wait_in_service", "service-never-comes", "self.client.wait_for_service(", "start the node"),
        ("lock_across_callbacks", "self-made-deadlock", "with self.", "in the same order"),
        (
            "lock_during_call",
            "self-made-deadlock",
            "self.storage.call(",
            "let go of the lock before the call",
        ),
        ("locks_by_acquire", "self-made-deadlock", ".acquire()", "in the same order"),
        ("locks_in_methods", "self-made-deadlock", "with self.l", "in the same order"),
        ("locks_in_helpers", "self-made-deadlock", "with self.", "in the same order"),
        ("lock_by_decorator", "self-made-deadlock", "@locked", "threading.RLock"),
        ("item_of_its_group", "endless-wait", "self.items.get()", "give work a callback group of its own"),
        ("lock_of_ended_thread", "endless-wait", "with self.lock", "take locks by with"),
        ("lock_not_released", "self-made-deadlock", "self.lock.acquire()", "take the lock by with"),
        ("lock_left_by_another", "self-made-deadlock", "self.lock.acquire()", "take the lock by with"),
        ("thread_raises", "thread-raised", "10.0 / (3 - self.n)", "catch the exception in the thread"),
        ("job_raises", "thread-raised", "10.0 / (2 - self.n)", "ask the future that submit() returns for"),
        ("sensor_misspelt", "misspelt-topic", "self.create_subscription", "subscribe to /scan"),
        ("messages_in_bursts", "dropped-messages", "self.create_subscription", "a queue of 5"),
        ("lock_across_await", "self-made-deadlock", "with self.lock", "let go of the lock before the await"),
        (
            "lock_across_await_in_one_group",
            "self-made-deadlock",
            "await self.client",
            "let go of the lock before the await, and give ask a callback group",
        ),
        ("lock_acquired_twice", "self-made-deadlock", "self.lock.acquire()", "threading.RLock"),
        ("lock_taken_twice", "self-made-deadlock", "with self.lock", "threading.RLock"),
        ("no_response", "unreturned-response", "def answer(", "return response"),
        (
            "goal_awaited_in_one_group",
            "self-made-deadlock",
            "await self.client",
            "give send a callback group",
        ),
        ("goal_in_timer", "self-made-deadlock", "self.client.send_goal(", "add_done_callback"),
        (
            "call_in_parameter_callback",
            "self-made-deadlock",
            "self.client.call(",
            "ask by call_async() in a callback of add_post_set_parameters_callback(), or give tune a",
        ),
        ("lock_held_long", "lock-held-long", "time.sleep(1.2)", "sleep, wait and compute outside"),
        ("held_group", "group-starvation", "time.sleep(0.8)", "a callback group of its own"),
        ("sleep_in_service", "group-starvation", "time.sleep(1.5)", "num_threads=2"),
    ],
)
def test_a_beginners_mistake_is_one_problem_at_its_line(
    program: str, rule: str, culprit: str, cure: str
) -> None:
    path = PROGRAMS / f"{program}.py"
    timeline = run_to_end(program_setup(path, 4.0)).timeline
    found = diagnose(timeline)
    problems = [each for each in found if each.weight_in(timeline) is Weight.PROBLEM]
    assert [each.rule.id for each in problems] == [rule]
    told = problems[0].rule.explain(problems[0], timeline)
    assert told.place is not None
    assert told.place.file == str(path)
    assert culprit in path.read_text().splitlines()[told.place.first_line - 1]
    assert cure in told.cure


@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_a_lock_across_an_await_is_told_as_kept_when_further_calls_of_the_callback_want_it(
    tmp_path: Path, clock: str
) -> None:
    program = (PROGRAMS / "lock_across_await.py").read_text().replace("MutuallyExclusive", "Reentrant")
    program = program.replace("(Job())", "(Job(), rclpy.executors.MultiThreadedExecutor(4))")
    program = program.replace("(1.0, self.ask", "(0.3, self.ask")
    timeline = run_program(tmp_path, program, 1.5, clock=clock).timeline
    [told] = [each.explained(timeline) for each in diagnose(timeline)]
    assert "which ask took at node.py:19 and keeps while it awaits; /work is answered by work" in told.what
    assert "let go of the lock before the await" in told.cure


def test_a_future_that_only_a_callback_of_the_same_group_completes_is_a_deadlock() -> None:
    timeline = run_to_end(program_setup(PROGRAMS / "await_in_vain.py", 4.0)).timeline
    [told] = [each.explained(timeline) for each in diagnose(timeline)]
    assert told.what == (
        "deadlock: tick waits for self.ready for ever; self.ready.set_result() in on_start "
        "(await_in_vain.py:24) needs group A, which tick holds"
    )
    assert told.for_ever


@pytest.mark.parametrize(
    "more",
    [
        "Thread(target=self.on_start)",  # a thread asks no group
        "self.ready.cancel()",
        "other = self.ready",
        "self.create_timer(1.0, lambda: self.ready.set_result(1), callback_group=None)",
    ],
)
def test_it_is_none_where_something_else_may_complete_it(tmp_path: Path, more: str) -> None:
    program, send = (PROGRAMS / "await_in_vain.py").read_text(), "    def send(self):"
    program = program.replace(send, f"    def other(self):\n        {more}\n\n{send}")
    timeline = run_program(tmp_path, program, 4.0).timeline
    [told] = [each.explained(timeline) for each in diagnose(timeline)]
    assert "tick awaits self.ready, which has not come so far, since 0.500 s" in told.what


def test_an_await_in_vain_is_told_with_what_is_awaited() -> None:
    timeline = run_to_end(program_setup(PROGRAMS / "await_in_own_group.py", 4.0)).timeline
    [told] = [each.explained(timeline) for each in diagnose(timeline)]
    assert "tick awaits self.ready, which has not come so far, since 0.500 s" in told.what
    assert "let on_start complete it" in told.cure


def test_of_an_await_of_what_nothing_completes_the_line_is_told_that_makes_it(tmp_path: Path) -> None:
    program = (PROGRAMS / "await_in_own_group.py").read_text().replace("self.ready.set_result(True)", "pass")
    timeline = run_program(tmp_path, program, 4.0).timeline
    [told] = [each.explained(timeline) for each in diagnose(timeline)]
    assert "nothing in node.py completes self.ready, which line 11 makes" in told.cure


@pytest.mark.parametrize(
    ("program", "kind"),
    [
        ("call_in_timer", "self-made-deadlock"),
        ("rate_sleep", "deadlock-over-a-rate"),
        ("lock_across_callbacks", "deadlock-over-a-lock"),
        ("lock_during_call", "deadlock-over-a-lock"),
        ("held_group", "group-held-beside-threads"),
    ],
)
def test_a_deadlock_is_of_the_kind_of_what_is_waited_for(program: str, kind: str) -> None:
    timeline = run_to_end(program_setup(PROGRAMS / f"{program}.py", 4.0)).timeline
    found = diagnose(timeline)[0]
    assert found.rule.kind(found, timeline) == kind


def test_a_callback_that_sleeps_by_a_rate_alone_in_its_group_needs_only_a_thread(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    lines = (PROGRAMS / "rate_sleep.py").read_text().splitlines()
    path.write_text("\n".join(each for each in lines if "create_subscription" not in each))
    timeline = run_to_end(program_setup(path, 2.0)).timeline
    found = diagnose(timeline)[0]
    told = found.explained(timeline)
    assert told.cure.endswith("; or keep it, and spin with MultiThreadedExecutor(num_threads=2)")
    assert told.remedies[-1].own_groups == ()


@pytest.mark.parametrize("more", ["", "\n        self.destroy_rate(rate)"])
def test_a_callback_that_makes_its_rate_and_keeps_it_is_told_to_destroy_it(tmp_path: Path, more: str) -> None:
    program = (PROGRAMS / "rate_sleep.py").read_text().replace("self.rate.sleep()", f"rate.sleep(){more}")
    program = program.replace("for number", "rate = self.create_rate(10)\n        for number")
    timeline = run_program(tmp_path, program, 2.0).timeline
    told = diagnose(timeline)[0].explained(timeline)
    assert (", let tick end with destroy_rate(), and spin with " in told.cure) == (not more)
    edit = told.remedies[-1].edit
    assert (edit is None) == bool(more)
    if edit is not None:
        destroyed = "rate.sleep()\n        self.destroy_rate(rate)"
        assert edit.applied(program) == program.replace("rate.sleep()", destroyed)


def test_the_timer_of_a_rate_has_one_name_in_sentences_and_tables() -> None:
    timeline = run_to_end(program_setup(PROGRAMS / "rate_sleep.py", 2.0)).timeline
    assert "rate's timer" in {each.spoken_name for each in timeline.entities.values() if each.period}
    told = diagnose(timeline)[0].rule.explain(diagnose(timeline)[0], timeline)
    assert "waits for the rate's timer for ever" in told.what


@pytest.mark.parametrize("program", ["spin_in_service", "call_in_service"])
def test_a_service_is_not_told_to_go_on_after_it_has_returned(program: str) -> None:
    timeline = run_to_end(program_setup(PROGRAMS / f"{program}.py", 2.0)).timeline
    told = [each.explained(timeline) for each in diagnose(timeline)]
    assert told
    assert "done_callback" not in "".join(each.cure for each in told)


def test_the_services_of_the_robot_are_known_without_the_robot(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    lines = (PROGRAMS / "misspelt_service.py").read_text().splitlines()
    path.write_text("\n".join(each for each in lines if "create_service" not in each))
    timeline = run_to_end(program_setup(path, 2.0)).timeline
    told = diagnose(timeline)[0].rule.explain(diagnose(timeline)[0], timeline)
    assert told.cure.startswith("call /motor_power, which the robot offers; ")


def test_who_holds_a_lock_long_is_told_with_all_who_wait_for_it_and_what_they_lose() -> None:
    timeline = run_to_end(program_setup(PROGRAMS / "lock_held_long.py", 4.0)).timeline
    first, *others = (each.explained(timeline) for each in diagnose(timeline))
    assert first.what.endswith("for self.lock, which optimise held: it sleeps at line 37 (2 times in all)")
    assert first.what.startswith(
        ("on_pose and check waited up to 1.2 s", "check and on_pose waited up to 1.2 s")
    )
    assert "on_pose lost" in "".join(each.what for each in others)
    assert "let on_pose return sooner" not in "".join(each.cure for each in (first, *others))


@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_a_thread_that_holds_a_lock_while_it_sleeps_is_told(tmp_path: Path, clock: str) -> None:
    start = "threading.Thread(target=self.optimise, daemon=True).start()"
    text = (PROGRAMS / "lock_held_long.py").read_text()
    text = text.replace("self.create_timer(1.5, self.optimise, callback_group=Exclusive())", start)
    timeline = run_program(tmp_path, text, 4.0, clock).timeline
    told = diagnose(timeline)[0].explained(timeline)
    assert "for self.lock, which Thread-1 (optimise) held: it sleeps at line 37" in told.what


def test_a_lock_that_is_held_shortly_is_nothing(tmp_path: Path) -> None:
    text = (PROGRAMS / "lock_held_long.py").read_text().replace("time.sleep(1.2)", "time.sleep(0.01)")
    timeline = run_program(tmp_path, text, 4.0).timeline
    assert [each.rule.id for each in diagnose(timeline) if each.weight_in(timeline) is Weight.PROBLEM] == []


@pytest.mark.parametrize(
    ("program", "wants"),
    [
        (
            "lock_across_callbacks",
            "deadlock: move (lock_across_callbacks.py:25) wants self.camera, which look took at "
            "lock_across_callbacks.py:29; look (lock_across_callbacks.py:31) wants self.arm, which move took",
        ),
        (
            "lock_by_decorator",
            "deadlock: count (lock_by_decorator.py:34) wants self.lock, which it took itself at "
            "lock_by_decorator.py:29",
        ),
        (
            "lock_of_ended_thread",
            "waits for self.lock, which Thread-1 (poll) took at lock_of_ended_thread.py:18, in poll and did "
            "not release before it ended",
        ),
    ],
)
def test_a_lock_has_its_name_with_who_took_it_and_where(program: str, wants: str) -> None:
    timeline = run_to_end(program_setup(PROGRAMS / f"{program}.py", 3.0)).timeline
    told = diagnose(timeline)[0].rule.explain(diagnose(timeline)[0], timeline)
    assert wants in told.what


def test_of_what_would_end_a_wait_it_is_told_that_it_waits_itself() -> None:
    timeline = run_to_end(program_setup(PROGRAMS / "waits_for_who_waits.py", 5.0)).timeline
    go, grip = (each.explained(timeline).what for each in diagnose(timeline))
    file = "waits_for_who_waits.py"
    assert f"in open ({file}:28), which is in Client.call() ({file}:27), would end it" in go
    assert f"in go ({file}:23), which itself waits in Event.wait() ({file}:22), would end it" in grip


def test_the_call_that_would_end_a_wait_for_an_item_is_told_with_its_line() -> None:
    timeline = run_to_end(program_setup(PROGRAMS / "item_of_its_group.py", 3.0)).timeline
    told = diagnose(timeline)[0].rule.explain(diagnose(timeline)[0], timeline)
    assert "; self.items.put() in on_raw (item_of_its_group.py:21) would end it; " in told.what
    assert told.cure.endswith(", so that what ends the wait can run")


def test_two_nodes_of_one_name_are_told_apart(tmp_path: Path) -> None:
    text = (
        "import rclpy\n\nrclpy.init()\nnodes = [rclpy.create_node('sensor') for _ in range(2)]\n\n\n"
        "def measure():\n    pass\n\n\nfor node in nodes:\n    node.create_timer(0.5, measure)\n"
        "rclpy.spin(nodes[0])\n"
    )
    timeline = run_program(tmp_path, text, 3.0).timeline
    told = diagnose(timeline)[0].rule.explain(diagnose(timeline)[0], timeline)
    assert told.what.startswith("measure (the second /sensor) has been ready for 2.5 s")


def test_it_is_told_who_sets_the_event_that_a_callback_waits_for() -> None:
    timeline = run_to_end(program_setup(PROGRAMS / "event_of_its_group.py", 3.0)).timeline
    told = diagnose(timeline)[0].rule.explain(diagnose(timeline)[0], timeline)
    assert told.why.endswith(", and go waits for what on_bell sets")


def test_it_is_told_who_sets_what_a_loop_waits_for() -> None:
    timeline = run_to_end(program_setup(PROGRAMS / "busy_wait_in_service.py", 2.0)).timeline
    told = [each.explained(timeline) for each in diagnose(timeline)]
    assert told[0].why.endswith("does, and it waits for what on_closed sets")


def test_a_loop_that_sleeps_is_not_told_to_sleep(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    text = (PROGRAMS / "busy_wait_in_service.py").read_text()
    path.write_text(
        text.replace("            pass\n", "            time.sleep(0.05)\n").replace(
            "import rclpy", "import time\n\nimport rclpy", 1
        )
    )
    timeline = run_to_end(program_setup(path, 4.0)).timeline
    (told,) = (each.explained(timeline) for each in diagnose(timeline) if each.rule.id == "stays-in-loop")
    assert told.cure == "give close a callback group of its own"


def test_a_circle_through_a_pools_job_names_its_thread_and_is_over_with_its_timeout(tmp_path: Path) -> None:
    text = (PROGRAMS / "result_of_job.py").read_text()
    for end, there in (
        ("", ""),
        (".result()", ".result(9.0)"),
        ("Request())", "Request(), timeout_sec=9.0)"),
    ):
        timeline = run_program(tmp_path, text.replace(end, there) if end else text, 4.0).timeline
        found = diagnose(timeline)[0]
        assert found.ring[:2] == ("tick", "the result of a job")
        assert found.ring[3:] == ("/fetch", "group A", "tick")
        told = found.explained(timeline)
        assert told.for_ever == (not end)
        until = "in vain until 9.5 s" if end else "deadlock"
        assert told.what.startswith(f"{until}: tick (node.py:23) waits for the job on ")


def test_a_circle_through_a_joined_thread_names_the_thread_and_is_over_with_its_timeout(
    tmp_path: Path,
) -> None:
    text = (PROGRAMS / "join_in_timer.py").read_text()
    found = diagnose(run_to_end(program_setup(PROGRAMS / "join_in_timer.py", 4.0)).timeline)[0]
    ring = ("tick", "the end of a thread", "Thread-1 (work)", "/fetch", "group A", "tick")
    assert found.ring == ring
    program = tmp_path / "node.py"
    program.write_text(
        text.replace("self.client.call(", "time.sleep(1.0)\n        self.client.call(").replace(
            "import threading", "import threading\nimport time"
        )
    )
    timeline = run_to_end(program_setup(program, 4.0)).timeline
    found = diagnose(timeline)[0]
    assert found.ring == ring, "the callback is first, though its thread began to wait last"
    assert found.explained(timeline).why.startswith("the thread waits for what comes only once")
    for end, there in ((".join()", ".join(timeout=9.0)"), ("Request())", "Request(), timeout_sec=9.0)")):
        program.write_text(text.replace(end, there))
        timeline = run_to_end(program_setup(program, 4.0)).timeline
        told = [each.explained(timeline) for each in diagnose(timeline)]
        assert told[0].what.startswith("in vain until 9.5 s: tick (node.py:")
        assert "tick waits" not in told[0].what, "who waits is named once"
        assert not told[0].for_ever
