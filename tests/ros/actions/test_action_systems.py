"""What holds of every action server, whatever its goals, its threads and the cancel requests it gets."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.interfaces import action
from sim.ros.actions import ActionClient, ActionServer, CancelResponse, GoalResponse
from sim.ros.actions.goal_states import TERMINAL, GoalEvent, GoalState, next_state
from sim.ros.actions.server import ServerGoalHandle
from sim.ros.exceptions import RCLError
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.ros.scheduling.executors import MultiThreadedExecutor, SingleThreadedExecutor
from tests.support.properties import examples
from tests.support.simulation import Simulation, Trace, simulate

pytestmark = pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")

Fibonacci = action("example_interfaces", "Fibonacci")
GRAIN = 0.1
"""Seconds; every time is a multiple of it, so that things often happen together."""


@dataclass(frozen=True)
class GoalPlan:
    """A goal sent at ``at``: ``steps`` grains of work, and how it ends; times are in grains."""

    at: int
    steps: int
    accepted: bool
    cancelled_after: int | None
    cancel_granted: bool
    ending: str


@dataclass(frozen=True)
class ServerPlan:
    """A server and what its goals do; ``threads`` None stands for a single-threaded executor."""

    group: type[CallbackGroup]
    threads: int | None
    coroutine: bool
    result_timeout: int
    goals: tuple[GoalPlan, ...]


goal_plans = st.builds(
    GoalPlan,
    at=st.integers(0, 6),
    steps=st.integers(0, 5),
    accepted=st.integers(0, 4).map(bool),
    cancelled_after=st.none() | st.integers(0, 6),
    cancel_granted=st.booleans(),
    ending=st.sampled_from(["succeed", "abort", "nothing", "raise"]),
)
server_plans = st.builds(
    ServerPlan,
    group=st.sampled_from([MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup]),
    threads=st.none() | st.integers(1, 4),
    coroutine=st.booleans(),
    result_timeout=st.sampled_from([0, 1, 10, -1]),
    goals=st.lists(goal_plans, min_size=1, max_size=6).map(tuple),
)


@dataclass
class Outcome:
    """What was heard of each goal, by its number."""

    accepted: dict[int, bool] = field(default_factory=dict)
    feedback: defaultdict[int, list[int]] = field(default_factory=lambda: defaultdict(list))
    sent: defaultdict[int, list[int]] = field(default_factory=lambda: defaultdict(list))
    results: defaultdict[int, list[Any]] = field(default_factory=lambda: defaultdict(list))
    statuses: defaultdict[bytes, list[GoalState]] = field(default_factory=lambda: defaultdict(list))
    ids: dict[int, bytes] = field(default_factory=dict)
    remembered: int = 0


class Play:
    """One play of a plan on virtual time."""

    def __init__(self, plan: ServerPlan, simulation: Simulation) -> None:
        self.plan = plan
        self.simulation = simulation
        self.outcome = Outcome()
        node = Node("server")
        self.server = ActionServer(
            node,
            Fibonacci,
            "work",
            self.execute_later if plan.coroutine else self.execute,
            callback_group=plan.group(),
            goal_callback=self.accept,
            cancel_callback=self.cancel,
            result_timeout=plan.result_timeout,
        )
        executor = SingleThreadedExecutor() if plan.threads is None else MultiThreadedExecutor(plan.threads)
        executor.add_node(node)
        simulation.start(executor.spin, "server")
        outside = simulation.outside_node()
        profile = QoSProfile(depth=1000)
        self.client = ActionClient(outside, Fibonacci, "work", feedback_sub_qos_profile=profile)
        outside.create_subscription(
            Fibonacci.Impl.GoalStatusMessage, "work/_action/status", self.see, profile
        )
        simulation.spin_outside(outside)

    def run(self) -> None:
        for number, goal in enumerate(self.plan.goals):
            self.simulation.at(goal.at * GRAIN, partial(self.send, number))
        self.simulation.sleep(30.0)
        self.outcome.remembered = len(self.server._goal_handles)

    # The server

    def accept(self, goal: Any) -> GoalResponse:
        return GoalResponse.ACCEPT if self.plan.goals[goal.order].accepted else GoalResponse.REJECT

    def cancel(self, goal_handle: ServerGoalHandle) -> CancelResponse:
        granted = self.plan.goals[goal_handle.request.order].cancel_granted
        return CancelResponse.ACCEPT if granted else CancelResponse.REJECT

    def execute(self, goal_handle: ServerGoalHandle) -> Any:
        for _ in self.work(goal_handle):
            self.simulation.sleep(GRAIN)
        return self.end(goal_handle)

    async def execute_later(self, goal_handle: ServerGoalHandle) -> Any:
        return self.execute(goal_handle)

    def work(self, goal_handle: ServerGoalHandle) -> Iterator[None]:
        number = goal_handle.request.order
        for step in range(self.plan.goals[number].steps):
            if goal_handle.is_cancel_requested:
                return
            self.outcome.sent[number].append(step)
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=[step]))
            yield

    def end(self, goal_handle: ServerGoalHandle) -> Any:
        number = goal_handle.request.order
        ending = self.plan.goals[number].ending
        if goal_handle.is_cancel_requested:
            goal_handle.canceled()
        elif ending == "raise":
            raise ValueError("on purpose")
        elif ending != "nothing":
            getattr(goal_handle, ending)()
        return Fibonacci.Result(sequence=[number])

    # The client

    def send(self, number: int) -> None:
        future = self.client.send_goal_async(
            Fibonacci.Goal(order=number),
            lambda message: self.outcome.feedback[number].append(message.feedback.sequence[0]),
        )
        future.add_done_callback(lambda each: self.answered(number, each.result()))

    def answered(self, number: int, goal_handle: Any) -> None:
        self.outcome.accepted[number] = goal_handle.accepted
        self.outcome.ids[number] = bytes(goal_handle.goal_id.uuid)
        result = goal_handle.get_result_async()
        result.add_done_callback(lambda each: self.outcome.results[number].append(each.result()))
        after = self.plan.goals[number].cancelled_after
        if after is not None:
            at = self.simulation.now + after * GRAIN
            self.simulation.at(at, goal_handle.cancel_goal_async)

    def see(self, status: Any) -> None:
        for each in status.status_list:
            seen = self.outcome.statuses[bytes(each.goal_info.goal_id.uuid)]
            state = GoalState(each.status)
            if not seen or seen[-1] is not state:
                seen.append(state)


def play(plan: ServerPlan) -> Outcome:
    """What is heard of the goals of a plan."""
    return traced_play(plan)[0]


def traced_play(plan: ServerPlan) -> tuple[Outcome, Trace]:
    """What is heard of the goals of a plan, and the trace of it all."""
    plays: list[Play] = []

    def program(simulation: Simulation) -> None:
        plays.append(Play(plan, simulation))
        plays[0].run()

    trace = simulate(program)
    return plays[0].outcome, trace


each_plan = settings(deadline=None, max_examples=examples(40), suppress_health_check=[HealthCheck.too_slow])


@each_plan
@given(server_plans)
def test_every_goal_is_answered_and_every_accepted_one_ends_in_exactly_one_terminal_state(
    plan: ServerPlan,
) -> None:
    outcome = play(plan)
    assert outcome.accepted == {number: goal.accepted for number, goal in enumerate(plan.goals)}
    for number, accepted in outcome.accepted.items():
        seen = outcome.statuses.get(outcome.ids[number], [])
        if not accepted:
            assert seen == []
            continue
        assert [state for state in seen if state in TERMINAL] == seen[-1:]
        assert all(_follows(one, other) for one, other in pairwise(seen))
        assert seen[0] is GoalState.ACCEPTED
        if plan.result_timeout > 0 or plan.result_timeout < 0:
            (response,) = outcome.results[number]
            assert response.status == seen[-1]


@each_plan
@given(server_plans)
def test_feedback_arrives_in_the_order_in_which_it_was_sent_and_none_is_made_up(plan: ServerPlan) -> None:
    outcome = play(plan)
    for number, heard in outcome.feedback.items():
        assert heard == outcome.sent[number][: len(heard)]


@each_plan
@given(server_plans)
def test_a_goal_ends_canceled_only_if_that_was_asked_for_and_granted(plan: ServerPlan) -> None:
    outcome = play(plan)
    for number, goal in enumerate(plan.goals):
        if GoalState.CANCELED in outcome.statuses.get(outcome.ids[number], []):
            assert goal.cancel_granted
            assert goal.cancelled_after is not None


@each_plan
@given(server_plans)
def test_in_the_end_only_a_server_that_keeps_results_for_ever_remembers_goals(plan: ServerPlan) -> None:
    outcome = play(plan)
    kept = sum(outcome.accepted.values()) if plan.result_timeout < 0 else 0
    assert outcome.remembered == kept


@settings(each_plan, max_examples=examples(15))
@given(server_plans)
def test_the_same_plan_gives_the_same_trace(plan: ServerPlan) -> None:
    assert traced_play(plan)[1].events == traced_play(plan)[1].events


def _follows(one: GoalState, other: GoalState) -> bool:
    reached = set()
    for event in GoalEvent:
        try:
            reached.add(next_state(one, event))
        except RCLError:
            continue
    return other in reached
