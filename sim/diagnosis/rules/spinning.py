"""The rule on spinning an executor that is already being spun."""

from collections.abc import Iterator

from sim.diagnosis.rule import CodeLocation, Explanation, Finding, Rule
from sim.diagnosis.rules.edits import edits_for_reply
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import often, threads_for, who, with_threads
from sim.trace.events import SpinClashed
from sim.trace.timeline import Timeline


class NestedSpin(Rule):
    """A callback spins its own executor, or takes its node away from it; or two threads spin one executor.

    Since Jazzy 7.1.9 the executor raises. ``rclpy.spin_until_future_complete(node, future)`` and its like use
    the global executor: a node that another one spins is moved there, and is in none afterwards.
    """

    id = "nested-spin"
    summary = "a callback spins the executor that runs it"

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Yield each attempt."""
        for clash in reversed(view.timeline.spin_clashes):
            if clash.t <= view.window.start:
                return
            yield Finding(self, clash.t, clash.t, clash.entity, clash.entity, about=clash.function)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        """Say what it led to, and how to do without it."""
        clash = next(
            each for each in timeline.spin_clashes if (each.t, each.entity) == (found.at, found.subject)
        )
        subject = who(clash.entity, timeline) if clash.entity else "the program"
        runner = (
            f"the executor that runs {subject}" if clash.entity else "an executor that another thread spins"
        )
        if clash.node:
            node = timeline.nodes.get(clash.node, "its node")
            what = f"{subject} takes {node} from {runner}, by {clash.function}(): that serves it no more"
            why = (
                "a node is in one executor at a time: this one has it until the call returns, "
                "and then none has it"
            )
        else:
            what = (
                f"{subject} spins {runner}, by {clash.function}(): RuntimeError: Executor is already spinning"
            )
            why = "an executor is spun once at a time; rclpy before Jazzy 7.1.9 tells nobody, and may hang"
        place = CodeLocation(clash.file, clash.line, clash.line) if clash.file else None
        remedies = edits_for_reply(place, clash.entity, timeline) if clash.entity else ()
        cure = _cure(clash, subject, timeline)
        return Explanation(f"{what}{often(found.count)}", why, cure, place, remedies=remedies)


def _cure(clash: SpinClashed, subject: str, timeline: Timeline) -> str:
    if not clash.entity:
        return (
            "spin each node in one thread only; another thread waits for a future by a threading.Event "
            "that the future's done-callback sets"
        )
    if not clash.function.endswith("future_complete"):
        return f"leave {clash.function}() out: callbacks run by themselves as soon as {subject} returns"
    threads = ""
    if threads_for([clash.entity], clash.t, timeline) == 1:
        threads = f", and spin with {with_threads(2)}"
    return (
        f"after call_async() let {subject} return and go on in future.add_done_callback(), or await the "
        f"future in an async def {subject}; to wait inside {subject}, use client.call(), give the client a "
        f"callback group of its own{threads}"
    )
