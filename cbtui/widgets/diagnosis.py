"""The diagnosis of a moment in one sentence: the longest wait and its reason, or that nothing waits."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum, auto

from cbtui.keys.action import Scope
from cbtui.keys.keymap import STANDARD, Keymap
from cbtui.looks.theme import Charset
from cbtui.runs.live.findings import ExplainedFinding
from cbtui.runs.live.live_run import RunState, ShownRun
from cbtui.runs.live.playhead import Playhead
from cbtui.text.callback_names import short_name
from cbtui.widgets.lanes.service_calls import LatestCalls, unanswered
from sim.diagnosis import CodeLocation
from sim.diagnosis.words import late_reply, only_thread, thread_count, threads_needed
from sim.quantities.durations import duration
from sim.quantities.nanoseconds import SECOND
from sim.trace.descriptions import doing_of, name_of, waiting_name
from sim.trace.events import Doing, EntityId, EntityKind, KeyboardAsked, Notice, NoticeKind, Reason, Severity
from sim.trace.figures.concurrency import Concurrency
from sim.trace.figures.waiting import (
    WORTH_TELLING,
    is_held_by_own_call,
    next_in_turn,
    waited_so_far,
    waits_for_others,
    waits_since,
)
from sim.trace.model import (
    AxisMarkKind,
    Blocked,
    Call,
    EntityInfo,
    Moment,
    Nanoseconds,
    Position,
    Wait,
    Window,
)
from sim.trace.timeline import Timeline

_SERIOUS: Nanoseconds = SECOND
_NOTICE_STAYS: Nanoseconds = 5_000_000_000
_REPLY_STAYS: Nanoseconds = 5_000_000_000


class DiagnosisLevel(Enum):
    """The importance of a diagnosis."""

    FINE = auto()
    PENDING = auto()
    """Something is late, blocked or without a reply, and keeps no other callback waiting."""
    WAITS = auto()
    TROUBLE = auto()

    @property
    def is_calm(self) -> bool:
        """Whether no callback waits for another one."""
        return self in (DiagnosisLevel.FINE, DiagnosisLevel.PENDING)


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """A sentence about a moment, and its importance; ``at_length`` is shown instead if it fits.

    ``time`` is the beginning of a sentence about another moment; it is left out if room is short. ``place``
    is its line of code.

    A diagnosis that stays (a notice, the end of a run) may take several lines; the others change from moment
    to moment and take one line, so that the screen does not jump. ``is_stall``: nothing moves for an unknown
    reason.
    """

    text: str
    level: DiagnosisLevel
    stays: bool = field(default=False, compare=False)
    at_length: str = ""
    time: str = field(default="", compare=False)
    place: CodeLocation | None = None
    is_stall: bool = field(default=False, compare=False)


def diagnosis_on_screen(
    run: ShownRun, playhead: Playhead, concurrency: Concurrency, keymap: Keymap = STANDARD
) -> Diagnosis:
    """Return the diagnosis of the moment on screen; at a run's end, how it ended and how to continue."""
    timeline, real = run.timeline, run.setup.real
    is_watched = real is not None and real.is_watched
    if playhead.at is None:
        if run.loss is not None:
            return _diagnosis_of_loss(run.loss, _key("run_again", keymap))
        if run.state is RunState.SILENT:
            return _diagnosis_of_silence(timeline, _key("run_again", keymap))
        if run.state is RunState.ENDED:
            again = "watch those that come" if is_watched else "run again"
            return _diagnosis_of_end(timeline, f"press {_key('run_again', keymap)} to {again}")
        if run.state is RunState.REPLAY_STANDS and timeline.ended is not None:
            return _diagnosis_of_end(timeline, f"{_key('resume', keymap)} plays it from its beginning")
    at = playhead.now(timeline.end)
    moment = diagnosis_at(timeline, at, concurrency, keymap, can_type=run.alive)
    if is_watched and not (timeline.processes or moment.stays):
        text = "no process to watch yet: start one with cbtui probe -- COMMAND"
        moment = Diagnosis(text, DiagnosisLevel.FINE)
    notice = _latest_notice(timeline, at)
    if playhead.at is None and run.alive and notice is not None and notice.kind is NoticeKind.NO_PROGRESS:
        return replace(moment, text=f"{moment.text}; {_key('start_over', keymap)} starts over")
    return moment


def how_to_continue(run: ShownRun, keymap: Keymap) -> str:
    """Return how to restart a run in which callbacks wait for ever; "" if the run is over."""
    return f"{_key('start_over', keymap)} starts over" if run.alive else ""


def with_worst_problem(
    moment: Diagnosis,
    findings: Sequence[ExplainedFinding],
    how_to_continue: str = "",
    at: Nanoseconds | None = None,
) -> Diagnosis:
    """Replace a diagnosis without a problem by the worst problem that the rules found in the run.

    A diagnosis that stays is kept, but for its tick, unless it is a stall; any other gives way to a wait that
    never ends, or only by its timeout. ``how_to_continue`` is added to a wait that never ends where there is
    room. Of a past moment ``at`` only what was known then is told.
    """
    problems = [each for each in findings if each.is_problem and (at is None or _is_known(each, at))]
    endless = [each for each in problems if each.explanation.for_ever]
    in_vain = [each for each in problems if each.explanation.until]
    worst = next(iter((*endless, *in_vain, *problems)), None)
    if worst is None:
        return moment
    if moment.stays and not (moment.is_stall and worst.explanation.for_ever):
        no_tick = moment.level is DiagnosisLevel.FINE
        return replace(moment, level=DiagnosisLevel.WAITS) if no_tick else moment
    if not moment.level.is_calm and worst not in (*endless, *in_vain):
        return moment
    explanation = worst.explanation
    what, level = explanation.what, DiagnosisLevel.WAITS if worst in in_vain else DiagnosisLevel.TROUBLE
    if worst.at is None:
        return Diagnosis(what, level, at_length=worst.headline, place=explanation.place)
    counts_on = at is not None and worst.finding.count > 1
    when = "whole run: " if counts_on else f"at {worst.at / 1e9:.1f} s: "
    further = f"; {how_to_continue}" if how_to_continue and explanation.for_ever else ""
    at_length = f"{worst.name} {'in the ' if counts_on else ''}{when}{what}{further}".lstrip()
    time = "" if counts_on else when  # the moment's own numbers are others, so that is never left out
    return Diagnosis(f"{when}{what}", level, at_length=at_length, time=time, place=explanation.place)


def _is_known(found: ExplainedFinding, at: Nanoseconds) -> bool:
    """Whether all that a finding says had happened by a moment."""
    finding, explanation = found.finding, found.explanation
    from_start = explanation.for_ever or explanation.until or finding.rule.known_from_start
    return (finding.known_at if from_start else finding.until) <= at


def _key(action: str, keymap: Keymap) -> str:
    return keymap.sign(Scope.LESSON, action, Charset.ASCII)


def _diagnosis_of_loss(loss: str, key: str) -> Diagnosis:
    """The loss of the engine, short enough for a line of 80 columns with the number of problems."""
    how = loss.rstrip(".").removeprefix("the engine ").removeprefix("was ")
    return Diagnosis(f"engine lost: {how}; {key} runs again", DiagnosisLevel.TROUBLE, stays=True)


def _diagnosis_of_silence(timeline: Timeline, key: str) -> Diagnosis:
    silent = (each for each in reversed(timeline.notices) if each.kind is NoticeKind.ENGINE_SILENT)
    return Diagnosis(f"{next(silent).problem}; {key} runs again", DiagnosisLevel.TROUBLE, stays=True)


def _diagnosis_of_end(timeline: Timeline, how_to_continue: str) -> Diagnosis:
    ended = timeline.ended
    if ended is None:
        return Diagnosis(f"the run is over; {how_to_continue}", DiagnosisLevel.FINE, stays=True)
    level = DiagnosisLevel.TROUBLE if ended.failed else DiagnosisLevel.FINE
    return Diagnosis(f"the run is over: {ended.reason.rstrip('.')}; {how_to_continue}", level, stays=True)


def diagnosis_at(
    timeline: Timeline,
    at: Nanoseconds,
    concurrency: Concurrency,
    keymap: Keymap = STANDARD,
    *,
    can_type: bool = True,
) -> Diagnosis:
    """Return the most important fact of a moment; ``can_type`` tells that a program still reads keys."""
    notice = _latest_notice(timeline, at)
    if notice is not None:
        stalled = notice.kind is NoticeKind.NO_PROGRESS
        return Diagnosis(notice.text, DiagnosisLevel.TROUBLE, stays=True, is_stall=stalled)
    asked = timeline.asked(at)
    if asked is not None and not timeline.entities:
        return Diagnosis(_of_keyboard(asked, keymap, can_type), DiagnosisLevel.PENDING)
    if not timeline.entities:
        return Diagnosis("no callback yet: the node is starting", DiagnosisLevel.FINE)
    moment = timeline.moment(at)
    for_others = waits_for_others(moment, timeline)
    if for_others:
        return _of_waits(for_others, moment, timeline)
    if asked is not None:
        return Diagnosis(_of_keyboard(asked, keymap, can_type), DiagnosisLevel.PENDING)
    return _at_rest(moment, timeline, concurrency.peak(at))


def _at_rest(moment: Moment, timeline: Timeline, peak: int) -> Diagnosis:
    """The diagnosis of a moment at which no callback waits for another one."""
    lately = timeline.marks(Window(moment.at - _NOTICE_STAYS, moment.at + 1))
    raised = [mark for mark in lately if mark.kind is AxisMarkKind.ERROR]
    if raised:
        time = f"at {raised[-1].at / 1e9:.1f} s: "
        return Diagnosis(f"{time}{raised[-1].text}", DiagnosisLevel.WAITS, time=time)
    turns = next_in_turn(moment, timeline)
    since, for_itself = min(((since, entity) for entity, since in turns.items()), default=(moment.at, 0))
    stuck = _stuck(moment, timeline)
    own = timeline.own_threads_at(moment.at)
    threads, briefly = _threads_needed(moment.at, timeline, peak, has_own=bool(own))
    pending = unanswered(LatestCalls(timeline).latest, moment.at)
    if moment.at - since < WORTH_TELLING:
        first = next(iter((*moment.waiting, *turns)), 0)
        ready = f"{name_of(first, timeline)} is ready" if first else ""
        if is_held_by_own_call(first, moment, timeline):
            ready = _overdue(timeline.entities[first], moment, timeline, turns.get(first, moment.at))
        waits = stuck or _no_reply(pending, moment.at, timeline, ready or "no callback waits") or ready
        level = DiagnosisLevel.PENDING if waits else DiagnosisLevel.FINE
        none = "no callback waits" if any(each.doing is Doing.WAITS for each in own) else "nothing waits"
        return Diagnosis(stuck or f"{waits or none}; {threads}", level)
    nothing = "no other callback waits" if pending else "nothing else waits"
    overdue = _overdue(timeline.entities[for_itself], moment, timeline, since)
    text = f"{overdue}; {stuck or nothing}"
    if stuck:
        return Diagnosis(text, DiagnosisLevel.PENDING)
    return Diagnosis(f"{text}; {briefly}", DiagnosisLevel.PENDING, at_length=f"{text}; {threads}")


def _no_reply(pending: Sequence[Call], at: Nanoseconds, timeline: Timeline, others: str) -> str:
    """The text on the oldest call without a reply, the newest first in ``pending``; "" if there is none."""
    if not pending:
        return ""
    by_program = [call for call in pending if call.caller]
    if not by_program:  # the note beside it tells of those from outside
        return others
    call = by_program[-1]
    caller = name_of(call.caller, timeline)
    return f"{caller} has no reply from {call.service} for {duration(at - call.sent)}; {others}"


def _stuck(moment: Moment, timeline: Timeline) -> str:
    """The text on the callback that has waited longest in its call, for a reply or a lock; "" for none."""
    positions = (timeline.position_on(thread, moment.at) for thread in moment.running)
    calls = (each for each in moment.blocked.values() if moment.at - each.start >= WORTH_TELLING)
    waiting: list[Blocked | Position] = [*calls]
    waiting += [each for each in positions if each is not None and each.doing is Doing.WAITS]
    stuck = min(waiting, key=lambda each: each.start, default=None)
    if stuck is None:
        return ""
    who = name_of(stuck.entity, timeline) if stuck.entity else "the program"
    lasts = duration(moment.at - stuck.start)
    if isinstance(stuck, Blocked):
        return late_reply(stuck, moment, timeline) or (
            f"{who} has been blocked in the call of {stuck.service} for {lasts}"
        )
    return f"{who} {doing_of(stuck)}{f' for {lasts}' if moment.at > stuck.start else ''}"


def _of_keyboard(asked: KeyboardAsked, keymap: Keymap, can_type: bool) -> str:
    way = f"; type it in the shell pane ({_key('type', keymap)})" if can_type else ""
    return f"{asked.program} waits for input from the keyboard{way}"


def call_note(timeline: Timeline, at: Nanoseconds) -> tuple[str, ...]:
    """Return texts on the latest call from outside, the fullest first: without reply, or just answered.

    Of a call without a reply the number of others gives way first, then the service's name. Else (); also
    while the program itself has a call of the service without a reply.
    """
    lately = Window(at - _REPLY_STAYS - 1, at + 1)
    calls = [call for call in timeline.calls_within(lately) if call.caller == 0]
    pending = [call for call in calls if call.replied is None or call.replied > at]
    if pending:
        brief = f"no reply for {duration(at - pending[0].sent)}"
        texts = (f"{brief}: {pending[0].service}", brief)
        return (f"{texts[0]} and {len(pending) - 1} more", *texts) if len(pending) > 1 else texts
    latest = max(calls, key=lambda call: call.replied or 0, default=None)
    if latest is None or latest.replied is None or at - latest.replied > _REPLY_STAYS:
        return ()
    if any(call.service == latest.service for call in unanswered(timeline.calls_within(lately), at)):
        return ()
    return f"{latest.service} replied {response_of(latest)}", f"{latest.service} replied"


def response_of(call: Call) -> str:
    """Return a response's fields without its class and an empty message; of a success, the message alone."""
    inside = call.response.partition("(")[2].removesuffix(")").removesuffix(", message=''")
    return inside.removeprefix("success=True, message=") or call.response


def _latest_notice(timeline: Timeline, at: Nanoseconds) -> Notice | None:
    """Return the engine's last warning, for as long as it stays on screen and its call has not come back."""
    for notice in reversed(timeline.notices):
        if notice.t <= at:
            serious = notice.severity in (Severity.WARN, Severity.ERROR, Severity.FATAL)
            stays = serious and at - notice.t <= _NOTICE_STAYS
            return notice if stays and not _has_come_back(notice, timeline, at) else None
    return None


def _has_come_back(notice: Notice, timeline: Timeline, at: Nanoseconds) -> bool:
    """Whether no call that ran as a callback was reported runs by a moment for as long as the reported one.

    Which of several it was is unknown: it ran no longer than the first.
    """
    if notice.kind is not NoticeKind.NO_PROGRESS:
        return False
    calls = timeline.spans_of(notice.entity, Window(notice.t, notice.t + 1))
    longest = max((notice.t - call.start for call in calls), default=0)
    left = (call for call in calls if call.end is None or call.end > at)
    return len(calls) > 0 and all(at - call.start < longest for call in left)


def _overdue(entity: EntityInfo, moment: Moment, timeline: Timeline, since: Nanoseconds) -> str:
    """The text on a callback that only waits for its own previous call, or is about to be called again."""
    waited = duration(moment.at - since)
    does = "still runs" if is_held_by_own_call(entity.id, moment, timeline) else "is next"
    match entity.kind:
        case EntityKind.TIMER:
            return f"{entity.spoken_name} {does}, due {waited} ago"
        case EntityKind.SUBSCRIPTION:
            return f"{entity.spoken_name} {does}, and the next message has waited {waited} for it"
        case EntityKind.SERVICE:
            return f"{entity.spoken_name} {does}, and the next request has waited {waited} for it"
    return f"{entity.spoken_name} {does}, ready again {waited} ago"


def _of_waits(waits: list[Wait], moment: Moment, timeline: Timeline) -> Diagnosis:
    longest = waits[0]
    waited = moment.at - waits_since(longest, moment.queues[longest.entity], timeline)
    more = len(waits) - 1
    others = f"; {more} more wait{'s' if more == 1 else ''}" if more else ""
    name = _with_lane(longest.entity, timeline)
    waits_so = f"waits {waited_so_far(longest, moment, timeline)}: {_why(longest, moment, timeline)}"
    level = DiagnosisLevel.TROUBLE if waited >= _SERIOUS else DiagnosisLevel.WAITS
    what = waiting_name(longest.entity, Window(longest.since, moment.at + 1), timeline)
    what = what if "(" in what else name
    return Diagnosis(f"{name} {waits_so}", level, at_length=f"{what} {waits_so}{others}")


def _with_lane(entity: EntityId, timeline: Timeline) -> str:
    """The name of a callback, with its lane's in brackets where nothing shows that they are one."""
    name, known = name_of(entity, timeline), timeline.entities.get(entity)
    if known is None or short_name(name) in known.label or known.label in name:
        return name
    return f"{name} ({known.label})"


def _why(wait: Wait, moment: Moment, timeline: Timeline) -> str:
    match wait.reason:
        case Reason.GROUP_HELD:
            return f"{_group_of(wait, timeline)} is held by {_with_lane(wait.holder, timeline)}"
        case Reason.NO_FREE_WORKER | Reason.EVENT_QUEUE:
            return _busy_threads(wait, moment, timeline)
        case Reason.NOBODY_SPINS:
            return "nobody spins its node"


def _group_of(wait: Wait, timeline: Timeline) -> str:
    group = timeline.groups[timeline.entities[wait.entity].group]
    return f"group {group.letter}"


def _busy_threads(wait: Wait, moment: Moment, timeline: Timeline) -> str:
    """The text on what occupies all threads, the most frequent callback first."""
    running = [name_of(span.entity, timeline) for span in moment.running.values()]
    if not running:
        return "no thread is free"
    holders = [thread for thread, span in moment.running.items() if span.entity == wait.holder]
    if holders and not timeline.threads[holders[0]].executor:  # it is of no pool
        return f"{only_thread(timeline)} runs {name_of(wait.holder, timeline)}"
    names = sorted(dict.fromkeys(running), key=running.count, reverse=True)[:2]
    if len(running) < thread_count(timeline):  # others are of other executors, or about to take up work
        return f"no thread is free for it: {' and '.join(names)} {'runs' if len(names) == 1 else 'run'}"
    if len(running) == 1:
        return f"the only thread runs {running[0]}"
    every = "both" if len(running) == 2 else f"all {len(running)}"
    return f"{every} threads are busy with {' and '.join(names)}"


def _threads_needed(at: Nanoseconds, timeline: Timeline, peak: int, *, has_own: bool) -> tuple[str, str]:
    """How many threads were needed by a moment, in full and short; ``has_own``: the program has its own."""
    count = thread_count(timeline)
    kinds = {each.kind for each in timeline.executors.values()}
    if count == 1 and peak and "MultiThreadedExecutor" in kinds:  # its number of threads can be chosen
        return ("1 of 1 threads needed",) * 2
    if count <= 1:
        return ("one thread runs all callbacks" if has_own else "one thread does all the work",) * 2
    if not peak:
        return ("no callback has run yet",) * 2
    return threads_needed(peak, count, at, timeline), f"{peak} of {count} threads needed"
