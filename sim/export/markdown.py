"""Writes a report of a run in Markdown: set-up, diagnosis, statistics, waits, output, a picture."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence

from sim.diagnosis import diagnose, location_text, sentence, with_stop
from sim.export.texts import markdown as plain
from sim.export.texts import seconds
from sim.quantities.durations import duration
from sim.trace.descriptions import why_waiting
from sim.trace.events import EntityId, EntityKind
from sim.trace.figures.chains_text import chain_report
from sim.trace.figures.statistics import CallbackStatistics, Distribution, Statistics, ages_used, statistics
from sim.trace.figures.summary import CallbackFigures, Summary, summarise, waits_in_run, without_waits
from sim.trace.figures.summary_text import robot_line, service_line
from sim.trace.model import AxisMark, AxisMarkKind, Nanoseconds, Window
from sim.trace.timeline import Timeline

_MARKS = 200
"""Commands and errors that a report lists at most."""

_HEADS = (
    "callback",
    "group",
    "calls",
    "duration min",
    "median",
    "p95",
    "max",
    "wait min",
    "median",
    "p95",
    "max",
    "jitter median",
    "max",
    "lost",
    "age or lateness median",
    "max",
    "errors",
)


def report(timeline: Timeline, picture: str | None = None, chains: Sequence[Sequence[str]] = ()) -> str:
    """The report on a timeline; ``picture`` is the link to its picture, ``chains`` are topics to follow.

    Text from the learner's program is shown literally.
    """
    summary, figures = summarise(timeline), statistics(timeline)
    parts = (
        _setup(timeline, summary),
        _diagnosis(timeline),
        _callbacks(summary, figures),
        _data(summary, figures, timeline),
        _waits(summary, timeline),
        _threads(timeline, summary, figures),
        _chains(timeline, chains),
        _calls_and_robot(summary),
        _words(timeline),
        _picture(picture),
    )
    return "\n".join(line for part in parts for line in part)


def _chains(timeline: Timeline, chains: Sequence[Sequence[str]]) -> Iterator[str]:
    for names in chains:
        yield from ("## Chain", "", "```text", chain_report(timeline, names).rstrip(), "```", "")


def _setup(timeline: Timeline, summary: Summary) -> Iterator[str]:
    yield f"# {plain(summary.target) or 'A run'}"
    yield ""
    clock = f" of {plain(summary.clock)} time" if summary.clock else ""
    ending = f": {plain(summary.ending)}" if summary.ending else ""
    yield f"{duration(summary.length)}{clock}{ending}"
    yield ""
    if summary.lost:
        yield f"**The trace lost {summary.lost} events, so some figures below are too small.**"
        yield ""
    yield from _heading("Set-up")
    for executor in timeline.executors.values():
        threads = "1 thread" if executor.threads == 1 else f"{executor.threads} threads"
        yield f"- {plain(executor.kind)}, {threads}"
    yield ""
    yield from _table(("group", "kind", "node", "callbacks"), _groups(timeline))


def _groups(timeline: Timeline) -> Iterator[Sequence[str]]:
    for group in timeline.groups.values():
        members = (entity.spoken_name for entity in timeline.group_members(group.id))
        yield (
            group.letter,
            plain(group.class_name),
            plain(timeline.nodes.get(group.node, "")),
            plain(", ".join(members)),
        )


def _diagnosis(timeline: Timeline) -> Iterator[str]:
    yield from _heading("Diagnosis")
    findings = diagnose(timeline)
    if not findings:
        yield "No problems found."
    for found in findings:
        told = found.explained(timeline)
        weight = found.weight_in(timeline)
        where = location_text(found, told)
        what = with_stop(plain(told.what))
        yield f"- **{weight.value.capitalize()}**{f' ({plain(where)})' if where else ''}: {what}"
        yield f"  {plain(sentence(told.why))} What to do: {with_stop(plain(told.cure))}"
    yield ""


def _callbacks(summary: Summary, figures: Statistics) -> Iterator[str]:
    about = {each.entity.id: each for each in summary.callbacks}
    yield from _heading("Callbacks")
    yield from _table(_HEADS, (_row(each, about.get(each.entity.id)) for each in figures.callbacks))


def _row(each: CallbackStatistics, about: CallbackFigures | None) -> Sequence[str]:
    return (
        plain(about.name if about else each.entity.spoken_name),
        about.group if about else "",
        str(each.calls),
        *_four(each.duration),
        *_four(each.wait),
        *_two(each.jitter),
        "-" if each.drops is None or not each.entity.depth else str(each.drops),
        *_two(each.age or each.late),
        str(each.errors),
    )


def _four(values: Distribution | None) -> Sequence[str]:
    if values is None:
        return ("-",) * 4
    return tuple(map(duration, (values.least, values.median, values.p95, values.most)))


def _two(values: Distribution | None) -> Sequence[str]:
    return ("-", "-") if values is None else (duration(values.median), duration(values.most))


def _data(summary: Summary, figures: Statistics, timeline: Timeline) -> Iterator[str]:
    names = {each.entity.id: each.name for each in summary.callbacks}
    rows = [
        (plain(names.get(timer.entity.id, "")), plain(_name(used, names, timeline)), *_four(ages))
        for timer in figures.callbacks
        if timer.entity.kind is EntityKind.TIMER
        for used, ages in ages_used(timeline, timer.entity, figures.window).items()
    ]
    if rows:
        yield "How old the newest data of each subscription was when a timer's callback began:"
        yield ""
        yield from _table(("timer", "data from", "age min", "median", "p95", "max"), rows)


def _name(entity: EntityId, names: dict[EntityId, str], timeline: Timeline) -> str:
    return names.get(entity) or timeline.entities[entity].spoken_name


def _waits(summary: Summary, timeline: Timeline) -> Iterator[str]:
    yield from _heading("Waits")
    rows = [row for each in summary.callbacks for row in _reasons(each, timeline)]
    if rows:
        yield from _table(("callback", "waited in all", "longest", "because"), rows)
    else:
        yield f"{without_waits(summary.callbacks).capitalize()}."
        yield ""


def _reasons(each: CallbackFigures, timeline: Timeline) -> Iterator[Sequence[str]]:
    """The total wait for each reason, the longest first, and the longest wait of which it is the main one."""
    total: defaultdict[str, Nanoseconds] = defaultdict(int)
    longest: defaultdict[str, Nanoseconds] = defaultdict(int)
    waits = timeline.waits_of(each.entity.id, Window(0, timeline.end + 1))
    for wait in waits:
        total[why_waiting(wait, timeline)] += wait.end_at(timeline.end) - wait.start
    for whole in waits_in_run(waits, timeline):
        longest[whole.why] = max(longest[whole.why], whole.length)
    for why in sorted(total, key=lambda why: -total[why]):
        most = duration(longest[why]) if longest[why] else "-"
        yield plain(each.name), duration(total[why]), most, plain(why)


def _threads(timeline: Timeline, summary: Summary, figures: Statistics) -> Iterator[str]:
    yield from _heading("Threads")
    busy = ((plain(timeline.threads[thread].name), f"{share:.1%}") for thread, share in figures.busy.items())
    yield from _table(("thread", "busy"), busy)
    yield f"{summary.threads_used} ran callbacks, at most {figures.threads_at_once} at once."
    yield ""


def _calls_and_robot(summary: Summary) -> Iterator[str]:
    lines = [service_line(service) for service in summary.services]
    if summary.robot:
        lines.append(f"robot: {robot_line(summary.robot)}")
    if lines:
        yield from _heading("Services and robot")
        yield from (f"- {plain(line)}" for line in lines)
        yield ""


def _words(timeline: Timeline) -> Iterator[str]:
    if timeline.notices:
        yield from _heading("Notices")
        for notice in timeline.notices:
            yield f"- {seconds(notice.t)} s, {notice.severity.value}: {plain(notice.text)}"
        yield ""
    marks = [
        mark
        for mark in timeline.marks(Window(0, timeline.end + 1))
        if mark.kind in (AxisMarkKind.COMMAND, AxisMarkKind.ERROR)
    ]
    if marks:
        yield from _heading("Commands and errors")
        yield from map(_mark, marks[:_MARKS])
        if len(marks) > _MARKS:
            yield f"- and {len(marks) - _MARKS} more"
        yield ""


def _mark(mark: AxisMark) -> str:
    return f"- {seconds(mark.at)} s: {plain(mark.text)}"


def _picture(picture: str | None) -> Iterator[str]:
    if picture is not None:
        yield from _heading("Picture")
        yield f"![Threads, callback groups and waits over time](<{_link(picture)}>)"
        yield ""


def _link(path: str) -> str:
    """A path as Markdown takes it between angle brackets."""
    return path.replace("%", "%25").replace("<", "%3C").replace(">", "%3E").replace("\n", "%0A")


def _heading(title: str) -> tuple[str, str]:
    return f"## {title}", ""


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    yield f"| {' | '.join(heads)} |"
    yield f"|{' --- |' * len(heads)}"
    for row in rows:
        yield f"| {' | '.join(row)} |"
    yield ""
