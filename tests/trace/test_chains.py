"""Chains of messages, in runs whose latencies are worked out by hand."""

from collections.abc import Sequence

import pytest

from lessons.checks import Verdict, chain_never_takes_longer_than, chain_never_uses_older_than
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackStarted,
    CallBlocked,
    CallUnblocked,
    EntityId,
    Published,
    Reason,
    ServiceCalled,
    ServiceReplied,
    WaitEnded,
    WaitStarted,
)
from sim.trace.figures.chains import Chain, ChainError, chain
from sim.trace.figures.chains_text import chain_text
from sim.trace.timeline import Timeline
from tests.support.builder import Run, ns

MS = 1_000_000


class Line:
    """A run of several nodes, written event by event; times in milliseconds, entities by their callbacks."""

    def __init__(self) -> None:
        self._run = Run()
        self._events: list[AnyEvent] = []
        self._of: dict[str, EntityId] = {}
        self._thread = self._run.thread("MainThread")

    def node(self, name: str, **takers: str) -> None:
        """A node; each callback takes a topic, or a service whose name ends in ``?`` (client: ``!``)."""
        node = self._run.node(name)
        group = self._run.reentrant(node)
        for callback, what in takers.items():
            if not what:
                self._of[callback] = self._run.timer(group, callback, 1.0)
            elif what.endswith("?"):
                self._of[callback] = self._run.service(group, what[:-1], callback)
            elif what.endswith("!"):
                self._of[callback] = self._run.client(group, what[:-1], callback)
            else:
                self._of[callback] = self._run.subscription(group, what, callback)

    def send(self, at: float, topic: str, message: int, by: str = "") -> None:
        self._events.append(Published(round(at * MS), message, topic, 0, self._of.get(by, 0)))

    def starts(self, at: float, callback: str, message: int = 0, thread: int = 1) -> None:
        self._events.append(CallbackStarted(round(at * MS), self._of[callback], thread, message, 0, 0))

    def ends(self, at: float, callback: str, thread: int = 1) -> None:
        self._events.append(CallbackEnded(round(at * MS), self._of[callback], thread))

    def waits(self, since: float, until: float, callback: str, holder: str) -> None:
        entity = self._of[callback]
        begun = WaitStarted(
            round(since * MS), entity, round(since * MS), Reason.GROUP_HELD, self._of[holder], False
        )
        self._events += [begun, WaitEnded(round(until * MS), entity)]

    def calls(self, at: float, service: str, call: int, by: str, *, blocks: bool = True) -> None:
        self._events.append(ServiceCalled(round(at * MS), call, service, self._of[by], ""))
        if blocks:
            self._events.append(CallBlocked(round(at * MS), call, 1, self._of[by], service))

    def replies(self, at: float, service: str, call: int) -> None:
        self._events += [
            ServiceReplied(round(at * MS), call, service, ""),
            CallUnblocked(round(at * MS), call, 1),
        ]

    @property
    def events(self) -> list[AnyEvent]:
        return [*self._run.events, *self._events]

    def timeline(self) -> Timeline:
        timeline = Timeline()
        timeline.extend(self.events)
        return timeline

    def chain(self, *names: str) -> Chain:
        return chain(self.timeline(), names)


def steps(found: Chain, place: int = 0) -> list[tuple[str, int]]:
    """The steps of a run that took any time, in words, with their milliseconds."""
    run = found.runs[place]
    assert sum(step.length for step in run.steps) == run.latency
    assert [step.start for step in run.steps[1:]] == [step.end for step in run.steps[:-1]]
    return [(step.words, step.length // MS) for step in run.steps if step.length]


@pytest.fixture
def line() -> Line:
    line = Line()
    line.node("filter", look="/scan")
    line.node("drive", steer="/points", tick="")
    return line


def test_a_callback_that_publishes_hands_the_chain_on(line: Line) -> None:
    # 10 in the queue, 20 in look, 5 in the queue, 30 in steer: 65 in all.
    line.send(100, "/scan", 1)
    line.starts(110, "look", 1)
    line.send(130, "/points", 2, by="look")
    line.ends(135, "look")
    line.starts(135, "steer", 2)
    line.send(165, "/cmd_vel", 3, by="steer")
    line.ends(170, "steer")
    found = line.chain("/scan", "/cmd_vel")
    assert found.path == ("/scan", "/points", "/cmd_vel")
    assert [run.latency for run in found.whole_chain] == [65 * MS]
    assert steps(found) == [("look waits", 10), ("look runs", 20), ("steer waits", 5), ("steer runs", 30)]


def test_a_message_that_a_timer_uses_twice_is_whole_once_and_older_the_second_time(line: Line) -> None:
    # Sent at 100, stored until 110; the timer uses it at 150 and, as nothing newer came, at 250: 50 and 150.
    line.send(100, "/points", 1)
    line.starts(105, "steer", 1)
    line.ends(110, "steer")
    for at, message in ((150, 2), (250, 3)):
        line.starts(at, "tick")
        line.send(at, "/cmd_vel", message, by="tick")
        line.ends(at, "tick")
    found = line.chain("/points", "/cmd_vel")
    assert [run.latency for run in found.whole_chain] == [50 * MS]
    assert [run.latency for run in found.runs] == [50 * MS, 150 * MS]
    assert steps(found, 1) == [("steer waits", 5), ("steer runs", 5), ("kept until tick uses it", 140)]


def test_a_message_replaced_by_a_newer_one_leads_to_no_output(line: Line) -> None:
    for at, message in ((100, 1), (120, 2)):
        line.send(at, "/points", message)
        line.starts(at, "steer", message)
        line.ends(at, "steer")
    line.starts(150, "tick")
    line.send(160, "/cmd_vel", 3, by="tick")
    line.ends(160, "tick")
    found = line.chain("/points", "/cmd_vel")
    assert (found.inputs, len(found.whole_chain)) == (2, 1)
    assert [run.latency for run in found.whole_chain] == [40 * MS]
    assert steps(found) == [("kept until tick uses it", 30), ("tick runs", 10)]


def test_at_one_moment_a_timer_that_is_served_first_has_not_seen_the_message_yet(line: Line) -> None:
    line.send(50, "/points", 1)
    line.starts(50, "steer", 1)
    line.ends(50, "steer")
    line.send(100, "/points", 2)
    line.starts(100, "tick")
    line.send(100, "/cmd_vel", 3, by="tick")
    line.ends(100, "tick")
    line.starts(100, "steer", 2)
    line.ends(100, "steer")
    assert [run.latency for run in line.chain("/points", "/cmd_vel").runs] == [50 * MS]


def test_a_service_on_the_way_is_one_step_of_its_caller_or_told_in_full_if_it_is_named(line: Line) -> None:
    # look runs 10, stands still for 40 of which the service waits 15 and runs 25, then runs 5.
    line.node("map", find="/find?")
    line.send(100, "/scan", 1)
    line.starts(100, "look", 1)
    line.calls(110, "/find", 2, by="look")
    line.waits(110, 125, "find", holder="steer")
    line.starts(125, "find", 2, thread=2)
    line.ends(150, "find", thread=2)
    line.replies(150, "/find", 2)
    line.send(155, "/points", 3, by="look")
    line.ends(160, "look")
    assert steps(line.chain("/scan", "/points")) == [
        ("look runs", 10),
        ("/find is called, in look", 40),
        ("look runs", 5),
    ]
    assert steps(line.chain("/scan", "/find", "/points")) == [
        ("look runs", 10),
        ("find waits, group C held by steer", 15),
        ("find runs", 25),
        ("look runs", 5),
    ]


def test_the_callback_that_takes_a_reply_hands_the_chain_on(line: Line) -> None:
    # Asked at 110, served from 120 to 140, the reply is taken at 170 and leads to a message at 180.
    line.node("map", find="/find?")
    line.node("asker", ask="/scan", done="/find!")
    line.send(100, "/scan", 1)
    line.starts(100, "ask", 1)
    line.calls(110, "/find", 2, by="ask", blocks=False)
    line.ends(110, "ask")
    line.starts(120, "find", 2)
    line.ends(140, "find")
    line.replies(140, "/find", 2)
    line.starts(170, "done", 2)
    line.send(180, "/points", 3, by="done")
    line.ends(180, "done")
    found = line.chain("/scan", "/points")
    assert found.path == ("/scan", "/find", "/points")
    assert steps(found) == [
        ("ask runs", 10),
        ("find waits", 10),
        ("find runs", 20),
        ("done waits", 30),
        ("done runs", 10),
    ]


def test_two_inputs_at_the_same_moment_keep_their_own_outputs(line: Line) -> None:
    # Both lie in the queue until 200, and are handled in no time: 100 and 80, by the order of the calls.
    line.send(100, "/scan", 1)
    line.send(120, "/scan", 2)
    for message in (1, 2):
        line.starts(200, "look", message)
        line.send(200, "/points", message + 10, by="look")
        line.ends(200, "look")
    assert [run.latency for run in line.chain("/scan", "/points").whole_chain] == [100 * MS, 80 * MS]


def test_the_dearest_step_is_marked_and_the_costs_add_up(line: Line) -> None:
    for place in range(3):
        at = 100 * place
        line.send(at, "/scan", 2 * place + 1)
        line.waits(at, at + 30, "look", holder="tick")
        line.starts(at + 30, "look", 2 * place + 1)
        line.send(at + 40, "/points", 2 * place + 2, by="look")
        line.ends(at + 40, "look")
    found = line.chain("/scan", "/points")
    assert [(cost.total // MS, cost.longest.words) for cost in found.costs] == [
        (90, "look waits, group A held by tick"),
        (30, "look runs"),
    ]
    text = chain_text(found)
    assert ">    30 ms  look waits, group A held by tick" in text
    assert "  whole chain         3     40 ms     40 ms     40 ms     40 ms" in text


def test_a_chain_has_a_budget(line: Line) -> None:
    line.send(100, "/points", 1)
    line.starts(100, "steer", 1)
    line.ends(100, "steer")
    for at in (150, 950):
        line.starts(at, "tick")
        line.send(at, "/cmd_vel", at, by="tick")
        line.ends(at, "tick")
    run = line.timeline()
    names = ("/points", "/cmd_vel")
    assert chain_never_takes_longer_than(names, 0.05).judge(run).passed
    assert chain_never_uses_older_than(names, 0.5).judge(run) == Verdict(
        False, "at most 0.5 s", "0.85 s, of which 0.85 s: kept until tick uses it", ns(0.1)
    )
    nowhere = chain_never_takes_longer_than(("/points", "/odom"), 1.0).judge(run)
    assert nowhere.seen == "nothing was sent on /odom; there was /points, /cmd_vel"


@pytest.mark.parametrize("names", ["/scan:/cmd_vel", ("/scan",)])
def test_a_budget_without_a_chain_is_refused_at_once(names: Sequence[str]) -> None:
    for check in (chain_never_takes_longer_than, chain_never_uses_older_than):
        with pytest.raises(ValueError, match="is not a chain; give a first and a last topic"):
            check(names, 1.0)


def test_what_did_not_lead_there_is_said(line: Line) -> None:
    line.send(100, "/scan", 1)
    line.send(100, "/cmd_vel", 2)
    with pytest.raises(ChainError, match="no message of /scan led to one of /cmd_vel"):
        line.chain("/scan", "/cmd_vel")
