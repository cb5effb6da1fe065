"""Rules on threads and groups that make no difference: remarks, since nothing goes wrong."""

from collections.abc import Iterator
from itertools import islice

from sim.diagnosis.rule import Explanation, Finding, Rule, Weight, is_models, made_at, place_of
from sim.diagnosis.timeline_view import TimelineView
from sim.diagnosis.words import listed, thread_count
from sim.quantities.nanoseconds import SECOND
from sim.quantities.plural import counted
from sim.trace.events import EntityKind, GroupKind, NodeId
from sim.trace.model import EntityInfo, ExecutorInfo, GroupInfo, Nanoseconds
from sim.trace.timeline import Timeline

_WARMED_UP: Nanoseconds = SECOND
"""Shorter runs are not judged: their nodes may not be complete."""


class ThreadsNeverUsed(Rule):
    """An executor has more threads than there are groups, all of which are mutually exclusive.

    Not told where others run callbacks, too, nor where calls are made: their done-callbacks need threads, and
    are in no group. That fewer threads did in one run says nothing about the next one.
    """

    id = "threads-never-used"
    summary = "more threads than groups"
    weight = Weight.REMARK
    is_effect = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Compare the threads with the groups."""
        timeline = view.timeline
        threads = sum(each.threads for each in _with_workers(timeline))
        if view.known < _WARMED_UP or not threads or timeline.calls or not view.threads_needed:
            return
        inhabited = (each for each in timeline.groups.values() if timeline.group_members(each.id))
        groups = list(islice(inhabited, threads))
        is_judged = all(each.kind is GroupKind.EXCLUSIVE for each in groups) and _runs_on_one_executor(view)
        if is_judged and len(groups) < threads and _only_group(timeline) is None:
            yield Finding(self, 0, view.end, size=len(groups), detail=str(threads))

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        groups = f"{'is' if found.size == 1 else 'are'} {counted(found.size, 'group')}"
        return Explanation(
            f"no more than {found.size} of {found.detail} threads can run callbacks at once: there {groups}",
            "a mutually exclusive group lets one callback in at a time, however many threads there are",
            f"num_threads={found.size} will do, until callbacks get further groups, or a reentrant one",
            None,
        )


class GroupsChangeNothing(Rule):
    """Groups without threads, or threads without groups: each alone changes nothing.

    With one thread groups matter to callbacks that await or spin: they hold their groups while others run.
    Threads matter to the done-callbacks of calls, which are in no group.
    """

    id = "groups-change-nothing"
    summary = "groups or threads make no difference"
    weight = Weight.REMARK
    is_effect = True

    def check(self, view: TimelineView) -> Iterator[Finding]:
        """Find several groups with one thread, or several threads with one group."""
        if view.known < _WARMED_UP or not view.threads_needed:
            return
        only = _only_group(view.timeline)
        calls = any(each.kind is EntityKind.CLIENT for each in view.few_entities)
        if only is not None and not calls:
            first = view.timeline.group_members(only.id)[0]
            yield Finding(self, 0, view.end, first.id, detail=_THREADS)
        node = _node_with_groups(view.timeline)
        held_without_thread = {*view.timeline.ever_suspended, *view.nested_spinners}
        if node is not None and thread_count(view.timeline) == 1 and not held_without_thread:
            yield Finding(self, 0, view.end, node.id, detail=_GROUPS)

    def explain(self, found: Finding, timeline: Timeline) -> Explanation:
        subject = timeline.entities[found.subject]
        if found.detail == _THREADS:
            letter = timeline.groups[subject.group].letter
            return Explanation(
                f"{thread_count(timeline)} threads change nothing: all callbacks share group {letter}",
                "a mutually exclusive group lets one callback in at a time, however many threads there are",
                "give callbacks that should run at the same time groups of their own",
                made_at(subject) or place_of(found.subject, timeline),
            )
        of_node = (each for each in _groups(timeline) if each.node == subject.node)
        own = (each for each in of_node if _callbacks(timeline, each))
        groups = list(islice(own, _MOST_LETTERS + 1))
        plural = len(groups) > 1
        named = listed(_abbreviated([each.letter for each in groups]))
        return Explanation(
            f"group{'s' if plural else ''} {named} change{'' if plural else 's'} nothing: "
            "there is only one thread",
            "groups say what may run at the same time; with one thread nothing can",
            "spin with MultiThreadedExecutor(num_threads=2) or more",
            place_of(found.subject, timeline),
        )


_MOST_LETTERS = 8
_THREADS = "threads"
_GROUPS = "groups"


def _abbreviated(letters: list[str]) -> list[str]:
    """Return the first letters, and that there are others."""
    return letters if len(letters) <= _MOST_LETTERS else [*letters[: _MOST_LETTERS - 1], "others"]


def _with_workers(timeline: Timeline) -> list[ExecutorInfo]:
    """The executors with several threads that have begun to run callbacks on them."""
    at_work = {each.executor for each in timeline.threads.values()}
    return [each for each in timeline.executors.values() if each.threads > 1 and each.id in at_work]


def _runs_on_one_executor(view: TimelineView) -> bool:
    threads = view.timeline.threads.values()
    return len({each.executor for each in threads if view.timeline.spans_on(each.id, view.window)}) == 1


def _only_group(timeline: Timeline) -> GroupInfo | None:
    """The exclusive group that all callbacks share despite several threads, those that rclpy makes too."""
    if not _with_workers(timeline):
        return None
    every = timeline.groups.values()
    groups = list(islice((each for each in every if timeline.group_members(each.id)), 2))
    if len(groups) != 1 or groups[0].kind is not GroupKind.EXCLUSIVE:
        return None
    return groups[0] if len(_callbacks(timeline, groups[0])) > 1 else None


def _groups(timeline: Timeline) -> Iterator[GroupInfo]:
    """The callback groups, without what stands for none."""
    return (each for each in timeline.groups.values() if each.kind is not GroupKind.NONE)


def _node_with_groups(timeline: Timeline) -> EntityInfo | None:
    """A callback of a node that has several groups or a reentrant one."""
    first: dict[NodeId, EntityInfo] = {}
    for group in _groups(timeline):
        for callback in _callbacks(timeline, group)[:1]:
            if group.node in first or group.kind is GroupKind.REENTRANT:
                return first.get(group.node, callback)
            first[group.node] = callback
    return None


def _callbacks(timeline: Timeline, group: GroupInfo) -> list[EntityInfo]:
    """The first two entities of a group that a program made: those with a callback, and clients."""
    own = (each for each in timeline.group_members(group.id) if not is_models(each))
    return list(islice((each for each in own if each.callback or each.kind is EntityKind.CLIENT), 2))
