"""Chains of messages from a first topic to a last one: how long each took, and where the time went."""

from bisect import bisect_left, bisect_right
from collections import defaultdict, deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache, cached_property
from heapq import heappop, heappush

from sim.trace.descriptions import name_of, why_waiting
from sim.trace.events import EntityId, EntityKind, NodeId
from sim.trace.model import Call, Nanoseconds, Sending, Span, Window
from sim.trace.timeline import Timeline


class ChainError(ValueError):
    """A chain cannot be followed; the text is a sentence."""


class StepKind(StrEnum):
    """What a callback or its message did during a step of a chain."""

    WAITS = "waits"
    """A message or request was in a queue, and its callback was not called yet, or not resumed."""
    RUNS = "runs"
    """A callback ran until it sent the next message, or to its end."""
    CALLS = "calls"
    """A callback was blocked in a service call, or awaited its reply."""
    AWAITS = "awaits"
    """A callback awaited something else."""
    KEPT = "kept"
    """A callback had stored the message, until another one of its node used it."""


_KEPT_COST = 10
"""The distance to a message that another callback had stored; to one that the sender took it is 1."""
_WORDS = {
    StepKind.WAITS: "{} waits",
    StepKind.RUNS: "{} runs",
    StepKind.CALLS: "{} is called",
    StepKind.AWAITS: "{} awaits",
    StepKind.KEPT: "kept until {} uses it",
}


@dataclass(frozen=True, slots=True)
class ChainStep:
    """A step of a chain; ``who`` is a callback, or the service that it calls, ``why`` a wait's reason."""

    kind: StepKind
    who: str
    start: Nanoseconds
    end: Nanoseconds
    why: str = ""
    entity: EntityId = 0

    @property
    def length(self) -> Nanoseconds:
        """Nanoseconds from its start to its end."""
        return self.end - self.start

    @property
    def words(self) -> str:
        """The step as a clause: ``scan_callback waits, group A held by timer_callback``."""
        what = _WORDS[self.kind].format(self.who)
        return f"{what}, {self.why}" if self.why else what


@dataclass(frozen=True, slots=True)
class ChainRun:
    """One output of a chain and the input that led to it; the steps fill the time between them.

    ``first``: whether it is the first output of that input; later ones use the same message again.
    """

    input: Sending
    output: Sending
    steps: tuple[ChainStep, ...]
    first: bool

    @property
    def latency(self) -> Nanoseconds:
        """From the sending of the input to that of the output."""
        return self.output.at - self.input.at

    @property
    def longest_step(self) -> ChainStep:
        """The step that took longest."""
        return max(self.steps, key=_length)


@dataclass(frozen=True, slots=True)
class Cost:
    """The total time of all steps of one kind and callback, and the longest of them."""

    total: Nanoseconds
    longest: ChainStep


@dataclass(frozen=True)
class Chain:
    """The messages of a chain. ``path`` are topics and services, from the first to the last one.

    There are two latencies. *Whole chain*: from each input to its first output; inputs without one were
    replaced by newer ones, lost, or have not arrived yet. *Last message*: from each output back to the
    input that it used, which a callback that keeps the latest message may use again and again.
    """

    path: tuple[str, ...]
    runs: tuple[ChainRun, ...]
    inputs: int
    outputs: int

    @cached_property
    def whole_chain(self) -> tuple[ChainRun, ...]:
        """The first output of each input that has one."""
        return tuple(each for each in self.runs if each.first)

    @property
    def critical(self) -> ChainRun | None:
        """The run with the longest latency of the whole chain; None if there is no run."""
        return max(self.whole_chain, key=lambda each: each.latency, default=None)

    @property
    def costs(self) -> list[Cost]:
        """The cost of each step of the whole chain in all its runs, the highest first."""
        steps: defaultdict[tuple[StepKind, str], list[ChainStep]] = defaultdict(list)
        for each in self.whole_chain:
            for step in each.steps:
                steps[step.kind, step.who].append(step)
        costs = [Cost(sum(map(_length, found)), max(found, key=_length)) for found in steps.values()]
        return sorted(costs, key=lambda cost: -cost.total)


def chain(timeline: Timeline, names: Sequence[str]) -> Chain:
    """Follow a chain through a run; ``names`` are two or more of its topics and services, in order.

    The names between two of these are found: those of the shortest way that messages took.

    Raises:
        ChainError: nothing was sent on a name, or no message led from one to the next.
    """
    if len(names) < 2:
        raise ChainError("a chain has a first and a last topic, such as /scan:/cmd_vel")
    for name in names:
        if name not in timeline.names_sent:
            known = ", ".join(timeline.names_sent) or "nothing"
            raise ChainError(f"nothing was sent on {name}; there was {known}")
    tracer = _Tracer(timeline)
    path = [names[0]]
    for after in names[1:]:
        path += tracer.way(path[-1], after)
    outputs = timeline.sent_on(path[-1])
    inputs_seen: set[int] = set()
    runs: list[ChainRun] = []
    for output in outputs:
        traced = tracer.back(output, path)
        if traced is not None:
            source, steps = traced
            runs.append(ChainRun(source, output, tuple(steps), source.id not in inputs_seen))
            inputs_seen.add(source.id)
    return Chain(tuple(path), tuple(runs), len(timeline.sent_on(path[0])), len(outputs))


def _length(step: ChainStep) -> Nanoseconds:
    return step.length


def _at(sending: Sending) -> Nanoseconds:
    return sending.at


def _sent(call: Call) -> Nanoseconds:
    return call.sent


class _Tracer:
    """Follows messages of one timeline back to the messages that led to them."""

    def __init__(self, timeline: Timeline) -> None:
        self._run = timeline
        self._run_window = Window(0, timeline.end + 1)
        self.sent = cache(self._sent)
        self._calls: dict[int, Call] = {call.id: call for call in timeline.calls}
        self._taken = cache(self._taken_by)
        self._begun = cache(self._begun_by)
        self._firsts = cache(self._firsts_of)
        self._made = cache(self._made_by)
        self._named = cache(self._named_by)

    def way(self, first: str, last: str) -> list[str]:
        """Return the names between two, and the last one.

        Raises:
            ChainError: no message led from one to the other.
        """
        after: dict[str, str] = {}
        known = {last: 0}
        waiting = [(0, last)]
        while waiting:
            cost, name = heappop(waiting)
            if name == first and name != last:
                found = [after[first]]
                while found[-1] != last:
                    found.append(after[found[-1]])
                return found
            for each, more in self._sources(name).items():
                if cost + more < known.get(each, cost + more + 1):
                    known[each], after[each] = cost + more, name
                    heappush(waiting, (cost + more, each))
        raise ChainError(f"no message of {first} led to one of {last}")

    def back(self, output: Sending, path: Sequence[str]) -> tuple[Sending, list[ChainStep]] | None:
        """Return the input that led to an output, and the steps between them; None if it is unknown."""
        steps: deque[ChainStep] = deque()
        at = output
        for name in reversed(path[:-1]):
            found = self._hop(at, name)
            if found is None:
                return None
            at, taken = found
            steps.extendleft(reversed(taken))
        return at, list(steps)

    def _sources(self, name: str) -> dict[str, int]:
        """Return the topics and services whose messages led to those on a name, with their distances."""
        found: dict[str, int] = {}
        senders = {each.sender.entity: None for each in self._run.sent_on(name) if each.sender is not None}
        known = [self._run.entities[entity] for entity in senders if entity in self._run.entities]
        for each in known:
            found.update(dict.fromkeys(self._subscribed(each.node), _KEPT_COST))
        for each in known:
            found.update(dict.fromkeys((each.name, *self._called_by(each.id)), 1))
        return {source: cost for source, cost in found.items() if source in self._run.names_sent}

    def _called_by(self, entity: EntityId) -> Iterator[str]:
        return (call.service for call in self._calls.values() if call.caller == entity)

    def _subscribed(self, node: NodeId) -> Iterator[str]:
        for each in self._run.entities.values():
            if each.node == node and each.kind is EntityKind.SUBSCRIPTION:
                yield each.name

    def _hop(self, output: Sending, name: str) -> tuple[Sending, list[ChainStep]] | None:
        """Return the sending on ``name`` that led to an output, and the steps between them."""
        call = output.sender
        known = None if call is None else self._run.entities.get(call.entity)
        if call is None or known is None:
            return None
        sent = self.sent(name)
        if known.name == name and call.message in sent:
            source = sent[call.message]
            if known.kind is EntityKind.CLIENT:
                return source, [*self._served(source, name), *self._handled(call, output.at, source)]
            return source, self._handled(call, output.at, source)
        return self._asked(output, call, name) or self._kept(output, call, name)

    def _asked(self, output: Sending, call: Span, name: str) -> tuple[Sending, list[ChainStep]] | None:
        """Return the latest answered request that the sending call had made before."""
        began = self._began(call)
        sent = self._run.sent_on(name)
        for place in range(bisect_right(sent, output.at, key=_at) - 1, -1, -1):
            source = sent[place]
            if source.at < began.start:
                return None
            replied = self._calls[source.id].replied if source.id in self._calls else None
            by_it = source.sender is not None and source.sender.entity == call.entity
            if by_it and replied is not None and replied <= output.at:
                return source, [*self._served(source, name), *self._ran(call, replied, output.at)]
        return None

    def _kept(self, output: Sending, call: Span, name: str) -> tuple[Sending, list[ChainStep]] | None:
        """Return the last message that the sender's node had taken when the sending call began."""
        node = self._run.entities[call.entity].node
        began = self._began(call)
        latest: Span | None = None
        for each in self._run.entities.values():
            if each.node == node and each.name == name and each.kind is EntityKind.SUBSCRIPTION:
                spans, ends = self._taken(each.id)
                place = bisect_right(ends, (began.start, began.number))
                if place and (latest is None or spans[place - 1].number > latest.number):
                    latest = spans[place - 1]
        if latest is None or latest.end is None or latest.message not in self.sent(name):
            return None
        source = self.sent(name)[latest.message]
        who = name_of(call.entity, self._run)
        kept = ChainStep(StepKind.KEPT, who, latest.end, began.start, "", call.entity)
        steps = [*self._handled(latest, latest.end, source), kept, *self._ran(call, began.start, output.at)]
        return source, [step for step in steps if step.length or step.kind is not StepKind.KEPT]

    def _served(self, source: Sending, service: str) -> list[ChainStep]:
        """Return the steps of a request until its reply; one step if the run does not offer the service."""
        replied = self._calls[source.id].replied or source.at
        served = self._taker(service, EntityKind.SERVICE, source.id)
        if served is not None:
            return self._handled(served, replied, source)
        return [ChainStep(StepKind.CALLS, service, source.at, replied)]

    def _taker(self, service: str, kind: EntityKind, call: int) -> Span | None:
        """Return the first span of the callback that took a request, or its reply."""
        for entity in self._named(service, kind):
            if call in self._begun(entity):
                return self._begun(entity)[call]
        return None

    def _handled(self, call: Span, until: Nanoseconds, source: Sending) -> list[ChainStep]:
        """Return the wait of a message or reply for its callback, and the callback's run."""
        began = self._began(call)
        since = source.at
        if self._run.entities[call.entity].kind is EntityKind.CLIENT:
            since = self._calls[source.id].replied or source.at
        return [self._waited(began, since), *self._ran(call, began.start, until)]

    def _waited(self, began: Span, since: Nanoseconds) -> ChainStep:
        """Return the wait of a message or reply for its callback, with the reason that lasted longest."""
        waits = self._run.waits_of(began.entity, Window(since, began.start))
        longest = max(
            waits, key=lambda wait: min(wait.end_at(self._run.end), began.start) - wait.start, default=None
        )
        why = "" if longest is None else why_waiting(longest, self._run)
        who = name_of(began.entity, self._run)
        return ChainStep(StepKind.WAITS, who, since, began.start, why, began.entity)

    def _ran(self, call: Span, start: Nanoseconds, end: Nanoseconds) -> list[ChainStep]:
        """Return the run of a callback, with steps for service calls, and for whatever else it awaited."""
        began, who = self._began(call), name_of(call.entity, self._run)
        steps: list[ChainStep] = []
        at = start

        def add(kind: StepKind, until: Nanoseconds, what: str = who, why: str = "") -> None:
            nonlocal at
            steps.append(ChainStep(kind, what, at, until, why, call.entity))
            at = until

        for span in self._run.spans_of(call.entity, Window(start, end + 1)):
            if self._began(span).number != began.number:
                continue
            if span.start > at:
                asked = self._awaited(began, Window(at, span.start))
                if asked is None:
                    add(StepKind.AWAITS, span.start)
                else:
                    replied = asked.replied or at
                    add(StepKind.CALLS, replied, asked.service, f"in {who}")
                    taken = self._taker(asked.service, EntityKind.CLIENT, asked.id)
                    if taken is not None and taken.start <= span.start:
                        steps.append(self._waited(taken, replied))
                        at = taken.start
                    add(StepKind.WAITS, span.start)
            for each in self._run.blocks_on(span.thread, Window(at, min(span.end_at(end), end))):
                if each.entity == call.entity and each.start >= at:
                    add(StepKind.RUNS, each.start)
                    add(StepKind.CALLS, min(each.end_at(end), end), each.service, f"in {who}")
            add(StepKind.RUNS, min(span.end_at(end), end))
        if at < end:
            add(StepKind.RUNS, end)
        return steps

    def _awaited(self, began: Span, gap: Window) -> Call | None:
        """Return the service call that was answered last while the callback that made it was suspended."""
        made = self._made(began.entity)
        first, behind = bisect_left(made, began.start, key=_sent), bisect_right(made, gap.start, key=_sent)
        answered = (each for each in made[first:behind] if gap.start <= (each.replied or 0) <= gap.end)
        return max(answered, key=lambda each: each.replied or 0, default=None)

    def _began(self, call: Span) -> Span:
        """Return the first span of a call; a call that awaited something has several."""
        return self._firsts(call.entity).get(call.first, call)

    def _sent(self, name: str) -> dict[int, Sending]:
        return {each.id: each for each in self._run.sent_on(name)}

    def _begun_by(self, entity: EntityId) -> dict[int, Span]:
        """Return the first span of each call of an entity by the message that it took."""
        return {span.message: span for span in self._run.calls_begun(entity, self._run_window)}

    def _firsts_of(self, entity: EntityId) -> dict[int, Span]:
        """Return the first span of each call of an entity by its number."""
        return {span.number: span for span in self._run.calls_begun(entity, self._run_window)}

    def _made_by(self, entity: EntityId) -> list[Call]:
        """Return the service calls that an entity's callback made."""
        return sorted((call for call in self._calls.values() if call.caller == entity), key=_sent)

    def _named_by(self, name: str, kind: EntityKind) -> list[EntityId]:
        return [each.id for each in self._run.entities.values() if (each.name, each.kind) == (name, kind)]

    def _taken_by(self, entity: EntityId) -> tuple[list[Span], list[tuple[Nanoseconds, int]]]:
        """Return the ended calls of a subscription in order of their ends, and these with call numbers."""
        ended = [span for span in self._run.spans_of(entity, self._run_window) if span.end is not None]
        ended.sort(key=lambda span: (span.end or 0, span.number))
        return ended, [(span.end or 0, span.number) for span in ended]
