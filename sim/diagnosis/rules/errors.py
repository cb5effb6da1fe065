"""Rules on exceptions that go unnoticed."""

import re
from collections.abc import Iterator

from sim.diagnosis.edits.actions import return_result
from sim.diagnosis.edits.fields import write_float
from sim.diagnosis.edits.functions import fit_parameters, hand_over_function
from sim.diagnosis.edits.names import rename_definition
from sim.diagnosis.edits.program_file import asked_of_file
from sim.diagnosis.edits.replies import futures_used, use_in_done_callback
from sim.diagnosis.rule import (
    CodeLocation,
    Explanation,
    Finding,
    Rule,
    Weight,
    by_edit,
    line_location,
    made_at,
    place_of,
)
from sim.diagnosis.rules.known_errors import NO_FLOAT, NO_RESULT, SPUN_TWICE, known_reason
from sim.diagnosis.timeline_view import TimelineView, is_worker, pool_of, raised_last
from sim.diagnosis.words import listed, often, who
from sim.interpreter.exception_text import UNREADABLE
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import EntityId, EntityKind, Notice, NoticeKind, Reason, RunEnded
from sim.trace.model import AxisMarkKind, EntityInfo, Nanoseconds, Span, Window
from sim.trace.timeline import Timeline


class ProgramRaised(Rule):
    """An exception ended the program, or one of several, which is told while the others go on."""

    id = "program-raised"
    summary = "an exception ends the program"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield the exceptions, but for those that another rule finds."""
        ends = list(_ends_by_exceptions(view.timeline))
        if not ends:
            return
        clashes = {(clash.file, clash.line) for clash in view.timeline.spin_clashes}
        last = [span for each in view.entities(EntityKind.SERVICE) for span in view.spans(each.id)[-1:]]
        unreturned = {span.error for span in last if span.no_response}
        is_silent = any(span.end is not None and span.message in view.unanswered for span in last)
        latest = [span for each in view.entities() for span in view.spans(each.id)[-1:] if span.error]
        for ended in ends:
            if tuple(ended.place) in clashes or ended.error in unreturned:
                continue
            raised = next((span for span in latest if span.error == ended.error), None)
            is_of_response = ended.error == "TypeError" or "_Response'>, got" in (ended.error or "")
            if raised is None and is_of_response and is_silent:
                continue  # real rclpy raises it when the service's callback is over, 7.1.6 without a text
            at = ended.t if raised is None or raised.end is None else raised.end  # others may have gone on
            worker = raised.thread if raised and is_worker(raised.thread, view.timeline) else 0
            subject = raised.entity if raised else 0
            yield Finding(self, at, at, subject, about=ended.reason, thread=worker, event=ended)

    def kind(self, found: Finding, timeline: Timeline) -> str:
        """Distinguish exceptions on a worker, which may be lost, from those that end the program at once."""
        return self.id if found.thread else "program-failed"

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        ended = found.event
        assert isinstance(ended, RunEnded)
        place = line_location(*ended.place)
        has_spun = any(each.executor for each in timeline.threads.values())
        why = "an exception that no except clause takes ends the program"
        why += ", and spin() with it" if has_spun else ""
        cure = "correct the line, or catch the exception there" if timeline.threads else "correct the line"
        if ended.exception in UNREADABLE:
            why, cure = "Python could not read the file, so nothing of it ran", "correct the line"
        why, cure = known_reason(ended.error or "") or (why, cure)
        is_arity = " positional argument" in (ended.error or "")
        remedies = (
            *by_edit(place, "define it with the parameters it is called with", fit_parameters),
            *by_edit(place, "give it another name", rename_definition, not is_arity),
        )
        if field := NO_FLOAT.fullmatch(ended.error or ""):
            remedies = by_edit(place, "write a float", write_float, field[1])
        if attribute := _used_too_soon(ended):
            why = "result() does not wait: of a future that is not done yet it is None"
            cure = "wait by rclpy.spin_until_future_complete(node, future) before result()"
            if found.subject:
                subject = who(found.subject, timeline)
                cure = "use the result in a done-callback, by future.add_done_callback(), or await the future"
                cure += f" in an async def {subject} with a callback group of its own"
            words = "use the result in a done-callback of the future"
            remedies = by_edit(place, words, use_in_done_callback, attribute)
        if (entity := _called_too_soon(ended, timeline)) is not None:
            why = f"this {entity.kind.value} was made with what a call returned, in place of a function"
            cure = "hand over the function itself, without calling it: self.tick, not self.tick()"
            place = made_at(entity)
            remedies = by_edit(place, "hand over the function itself", hand_over_function)
        what = ended.problem
        if (entity := _without_result(ended, timeline)) is not None:
            subject, place = who(entity.id, timeline), place_of(entity.id, timeline)
            what, cure = f"{subject} returned no result: {what}", cure.replace("that callback", subject)
            remedies = by_edit(place, cure, return_result, entity.made_at)
        return Explanation(what, why, ended.advice or cure, place, remedies=remedies)


def _ends_by_exceptions(timeline: Timeline) -> Iterator[RunEnded]:
    """Yield how programs ended by exceptions: each of several that has, or the run's."""
    told = set()
    for each in timeline.notices:
        if each.kind is NoticeKind.PROGRAM_RAISED:
            told.add((each.problem, tuple(each.place)))
            kind = each.error.partition(":")[0]
            yield RunEnded(
                each.t, each.text, True, False, each.error, each.place, each.problem, each.advice, kind
            )
    ended = timeline.ended
    if ended is not None and ended.problem and (ended.problem, tuple(ended.place)) not in told:
        yield ended


def _used_too_soon(ended: RunEnded) -> str:
    """Return the attribute that was asked of the result of a future that was not done; "" for none."""
    known = _NO_ATTRIBUTE.fullmatch(ended.error or "")
    file, line = ended.place
    if known and _futures_used(file, line, known[1]):
        return known[1]
    return ""


def _called_too_soon(ended: RunEnded, timeline: Timeline) -> EntityInfo | None:
    """Return what was made with a value in place of a callback, if that is why a program ended."""
    if ended.exception != "TypeError" or not (ended.error or "").endswith("object is not callable"):
        return None
    kinds = (EntityKind.TIMER, EntityKind.SUBSCRIPTION, EntityKind.SERVICE)
    entities = (each for each in timeline.entities.values() if each.kind in kinds and not each.callback)
    return next((each for each in entities if made_at(each)), None)


def _without_result(ended: RunEnded, timeline: Timeline) -> EntityInfo | None:
    """Return the execute callback that returned no result, if that ended a program, and no other has run."""
    if not NO_RESULT.fullmatch(ended.error or ""):
        return None
    goals = (
        each for each in timeline.entities.values() if each.kind is EntityKind.WAITABLE and each.callback
    )
    ran = [each for each in goals if timeline.spans_of(each.id, Window(0, ended.t + 1))]
    return ran[0] if len(ran) == 1 else None


_futures_used = asked_of_file(futures_used)
_NO_ATTRIBUTE = re.compile(r"AttributeError: 'NoneType' object has no attribute '(\w+)'")


class SpinRaised(Rule):
    """A callback raised, and nobody has spun its node since, though the program goes on.

    So it is when a thread that spins ends by the exception. The losses that follow are part of the finding.
    """

    id = "spin-raised"
    summary = "an exception ends a spin(), and the program goes on without it"
    by_culprit = True
    threshold = SECOND

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each call that raised, with the first wait that it led to."""
        found: dict[EntityId, Finding] = {}
        taken = {clash.node for clash in view.timeline.spin_clashes}
        for node, wait in view.unspun.items():
            span = raised_last(node, view.timeline)
            waited = view.end - wait.parts[-1].start
            if span is None or span.end is None or waited < self.threshold or node in taken:
                continue
            if span.entity not in found or waited > found[span.entity].size:
                found[span.entity] = Finding(
                    self, span.end, view.end, span.entity, span.entity, size=waited, thread=span.thread
                )
        yield from found.values()

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject, thread = who(found.subject, timeline), timeline.threads[found.thread]
        span = timeline.spans_of(found.subject, Window(0, found.at + 1))[-1]
        on = "" if thread.executor else f" on {thread.name}"
        waits = timeline.moment(found.until).waiting.values()
        unspun = [each.entity for each in waits if each.reason is Reason.NOBODY_SPINS]
        nodes = {timeline.entities[each].node for each in unspun}
        lasts = ((node, raised_last(node, timeline)) for node in nodes)
        ended = {node for node, last in lasts if last is not None and last.entity == found.subject}
        waiting = listed(who(each, timeline) for each in unspun if timeline.entities[each].node in ended)
        return Explanation(
            f"{subject} raised {span.error}{on}, and nobody spins its node any more: {waiting} cannot run",
            "an exception of a callback comes out of spin() and ends it, and a thread that only spins",
            f"correct the line, or catch the exception in {subject}",
            _raised_at(span, timeline),
        )


_KEPT = {
    NoticeKind.JOB_DIED: ("a job that was given to a pool", "submit()"),
    NoticeKind.COROUTINE_DIED: ("a coroutine that was given to a loop", "asyncio.run_coroutine_threadsafe()"),
}
"""What a future keeps the exception of, and the function that returns this future."""


class ThreadRaised(Rule):
    """An exception ended a thread of the program's own, or a job or coroutine whose result nobody asks for.

    If it came out of a callback, that is told.
    """

    id = "thread-raised"
    summary = "an exception ends a thread, a pool's job or a coroutine, and the program goes on without it"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each line once, as the engine reports it."""
        for notice in view.timeline.notices:
            if notice.kind in (NoticeKind.THREAD_DIED, *_KEPT) and notice.t <= view.end:
                about = f"{notice.place[0]}:{notice.place[1]}"
                yield Finding(self, notice.t, notice.t, about=about, event=notice, detail=notice.error)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        notice = found.event
        assert isinstance(notice, Notice)
        if notice.kind in _KEPT:
            what, given_by = _KEPT[notice.kind]
            return Explanation(
                f"{what} ended by {found.detail}, and nobody asked for its result",
                "what it raises is kept in its future, and Python prints nothing of it",
                f"correct the line; ask the future that {given_by} returns for its result(), in "
                "a done-callback",
                line_location(*notice.place),
            )
        return Explanation(
            f"a thread of the program ended by {found.detail}, and the rest went on without it",
            "Python prints what a thread raises, and ends that thread alone",
            "correct the line, or catch the exception in the thread, log it, and go on",
            line_location(*notice.place),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if a callback raised it, or if it is told with the second spin that it comes from."""
        if found.detail == SPUN_TWICE and timeline.spin_clashes:
            return None
        spans = (timeline.spans_of(each, Window(0, found.at + 1))[-1:] for each in timeline.entities)
        raised = any(span.error == found.detail for (span,) in filter(None, spans))
        return None if raised else super().weigh(found, timeline)


class ExceptionSwallowed(Rule):
    """A callback raised on a worker thread, and ``spin`` has not raised its exception.

    A MultiThreadedExecutor keeps the exceptions of callbacks, and raises the oldest when it next hands a
    callback to a worker; the others are lost.
    """

    id = "exception-swallowed"
    summary = "a callback raises and nobody hears of it"
    threshold: Nanoseconds = 500_000_000

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each call that raised on a worker; ``weigh`` drops those that surfaced."""
        if not any(mark.kind is AxisMarkKind.ERROR for mark in view.timeline.marks(view.window)):
            return
        for entity in view.entities():
            for span in view.spans(entity.id):
                if not span.error or span.no_response or span.end is None:
                    continue
                if is_worker(span.thread, view.timeline):
                    yield Finding(
                        self,
                        span.start,
                        span.end,
                        entity.id,
                        size=span.start,
                        detail=span.error,
                        thread=span.thread,
                    )

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject, ended = who(found.subject, timeline), timeline.ended
        why = "a MultiThreadedExecutor raises only the oldest exception, when it starts the next callback"
        cure = f"catch exceptions in {subject} and log them"
        if ended is not None and not ended.failed and not ended.time_was_up:
            why += "; here none came, for spin() had returned or was about to"
            cure += f"; let main() wait for {subject} before it shuts down what that uses"
        return Explanation(
            f"{subject} raised what spin() has not raised: {found.detail}{often(found.count)}",
            why,
            cure,
            _raised_at(_span(found, timeline), timeline),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if ``spin`` raised it, as it also does at the end of a run or for another callback."""
        ended = timeline.ended
        if ended is not None and ended.failed:
            return None if ended.error in (None, found.detail) else Weight.PROBLEM
        if timeline.end - found.until < self.threshold and ended is None:
            return None
        if _came_out(_span(found, timeline), timeline):
            return None
        since = Window(found.until, timeline.end + 1)
        pool = pool_of(found.thread, timeline)
        handed_out = (span.start for each in pool for span in timeline.spans_on(each, since))
        return None if any(start > found.until for start in handed_out) else Weight.PROBLEM


def _span(found: Finding, timeline: Timeline) -> Span:
    """Return the call that raised."""
    return timeline.spans_of(found.subject, Window(found.at, found.at + 1))[-1]


def _raised_at(span: Span, timeline: Timeline) -> CodeLocation | None:
    """Return the program's own line that raised, else the callback of the call."""
    return line_location(*span.raised_at) or place_of(span.entity, timeline)


def _came_out(span: Span, timeline: Timeline) -> bool:
    """Return whether a spin() raised a call's exception: at once, or later if a worker ran it."""
    came = ((each.error, each.file, each.line) for each in timeline.surfaced if each.t >= span.start)
    return not is_worker(span.thread, timeline) or (span.error, *span.raised_at) in came


_LEAVE = ("SystemExit", "KeyboardInterrupt", "ExternalShutdownException")
"""What is raised to end a program."""


class ExceptionCaught(Rule):
    """A callback raised, and its node was spun on or the program ended: it caught what its executor raised.

    Whether the program says anything of it is unknown.
    """

    id = "exception-caught"
    summary = "a callback raises, and the program catches it and goes on"
    weight = Weight.REMARK

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each call that raised, if a callback of its node began since, or the program returned."""
        if not any(mark.kind is AxisMarkKind.ERROR for mark in view.timeline.marks(view.window)):
            return
        latest = [(each.node, span.start) for each in view.entities() for span in view.spans(each.id)[-1:]]
        spun, ended = dict(sorted(latest)), view.timeline.ended
        returned = ended is not None and not (ended.failed or ended.time_was_up)
        for entity in view.entities():
            for span in view.spans(entity.id):
                end = span.end_at(view.end)
                if not span.error or span.no_response or span.error.partition(":")[0] in _LEAVE:
                    continue
                if end < spun[entity.node] or (returned and _came_out(span, view.timeline)):
                    yield Finding(self, span.start, end, entity.id, size=span.start, detail=span.error)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject = who(found.subject, timeline)
        return Explanation(
            f"{subject} raised {found.detail}{often(found.count)}, and the program caught it",
            "what an except clause around spin() or spin_once() takes, and does not log, nobody hears of",
            f"correct the line, or catch the exception in {subject} and log it there",
            _raised_at(_span(found, timeline), timeline),
        )

    def weigh(self, found: Finding, timeline: Timeline) -> Weight | None:
        """Irrelevant if it ended the program or a thread, which is told, though others went on since."""
        ended, told = timeline.ended, timeline.notices
        if any(each.kind in (NoticeKind.THREAD_DIED, *_KEPT) and each.error == found.detail for each in told):
            return None
        is_told = ended is not None and ended.failed and (ended.error, found.count) == (found.detail, 1)
        return None if is_told else super().weigh(found, timeline)
