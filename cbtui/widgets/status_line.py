"""The status line at the top: title, state and speed of the run, moment, executor and losses."""

from collections.abc import Sequence
from dataclasses import dataclass

from textual.geometry import Size
from textual.reactive import reactive

from cbtui.learning.stage import LessonStep, StepState
from cbtui.looks.theme import Charset, Ink, Role, TextRun
from cbtui.runs.live.findings import Standstill
from cbtui.runs.live.live_run import LiveRun, RunState, ShownRun
from cbtui.runs.live.playhead import Playhead
from cbtui.text.cells import fit
from cbtui.widgets.lanes.names import short_thread
from cbtui.widgets.painted_widget import PaintedWidget, painted
from sim.quantities.durations import duration, timestamp
from sim.trace.descriptions import executor_label
from sim.trace.events import NoticeKind
from sim.trace.figures.losses import all_losses
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_PLAIN = Ink(Role.TEXT)
_STRONG = Ink(Role.STRONG)
_FAINT = Ink(Role.FAINT)
_WARN = Ink(Role.WARN)
_GAP = TextRun("   ", _PLAIN)
_LEAST_TITLE = 5
"""The least columns of the title before the recording's state is dropped."""
_TURN = 0.15
"""Seconds between two pictures of the turning sign of a starting engine."""
_WORTH_TELLING = 10_000_000
"""Least size of a recording that is shown, in bytes."""


@dataclass(frozen=True, slots=True)
class RunStatus:
    """The content of the status line.

    ``pace`` names the clock and the speed, ``brief_pace`` the speed alone on virtual time. ``back`` is the
    distance of the moment on screen from the end, 0 for live; ``dropped`` is None where losses are not known;
    ``recorded`` how many events have been recorded, None if nothing is being recorded, ``unrecorded`` how
    many came too fast for that, ``recorded_bytes`` how large the recording is;
    ``exported`` is how many per cent of an export are done, None if there is none.
    """

    title: str
    state: RunState
    pace: str
    brief_pace: str
    at: Nanoseconds
    back: Nanoseconds
    executor: str
    dropped: int | None
    lost: int
    recorded: int | None = None
    unrecorded: int = 0
    recorded_bytes: int = 0
    exported: int | None = None
    steps: tuple[LessonStep, ...] = ()
    """The steps through the lesson, if there are any."""
    still: Nanoseconds | None = None
    """Nanoseconds since the last callback stopped for ever; None if others run."""
    moves: str = ""
    """The one thread that goes on beside the callbacks that stopped; "" for none."""
    only: str = ""
    """The callback because of which nothing else has been served for ``still``; "" for none."""
    goal: Nanoseconds | None = None
    """The moment at which a run that goes on will pause; None if there is none."""


_TENTH = 0.1
"""The least speed that one decimal place tells."""


def speed_text(asked: float | None, slow: float | None) -> str:
    """Return the speed that was asked for (None: as fast as it goes), and the real one if it is less."""
    speed = "max" if asked is None else f"×{asked:.1f}"
    if slow is None:
        return speed
    return f"×{slow:.1f} of {speed}" if slow >= _TENTH else f"×{slow:.1g} of {speed}"


def status_of(
    title: str,
    run: ShownRun,
    playhead: Playhead,
    usual_executor: str,
    exported: int | None = None,
    steps: tuple[LessonStep, ...] = (),
    still: Standstill | None = None,
    slow: float | None = None,
) -> RunStatus:
    """Return the status of a run; until its executor appears, ``usual_executor`` is shown.

    ``still`` tells that all callbacks that run have stopped for ever, None if others do; ``slow`` is how fast
    the run goes if that is less than the speed that was asked for.
    """
    timeline, recording = run.timeline, run.recording
    at = playhead.now(timeline.end)
    stands = run.state is RunState.LIVE and run.virtual and _time_stands(timeline)
    speed = "time stands" if stands else speed_text(run.speed, slow)
    pace = _pace(run, speed)
    return RunStatus(
        title=title,
        state=run.state,
        pace=pace,
        brief_pace=speed if run.virtual else pace,
        at=at,
        back=timeline.end - at if playhead.at is not None else 0,
        executor=executor_label(timeline) or usual_executor,
        dropped=all_losses(timeline, at),
        lost=timeline.lost,
        recorded=None if recording is None else recording.count,
        unrecorded=0 if recording is None else recording.lost,
        recorded_bytes=0 if recording is None else recording.size,
        exported=exported,
        steps=steps,
        still=None if still is None else timeline.end - still.since,
        moves="" if still is None else short_thread(still.moves),
        only="" if still is None else still.only,
        goal=run.goal if isinstance(run, LiveRun) else None,
    )


def _time_stands(timeline: Timeline) -> bool:
    """Whether the last that is known of the program is that it does not come back to virtual time."""
    last = timeline.notices[-1] if timeline.notices else None
    return last is not None and last.kind is NoticeKind.NO_PROGRESS and last.t == timeline.end


def _pace(run: ShownRun, speed: str) -> str:
    if run.setup.real is not None:
        return "real ROS 2"
    if not run.virtual:
        return "real: computing goes on" if run.state is RunState.PAUSED else f"real {speed}"
    return f"virtual {speed}"


class StatusLine(PaintedWidget):
    """Shows a status; ``turn`` grows while an engine starts and turns the sign."""

    status: reactive[RunStatus | None] = painted(None)
    turn: reactive[int] = painted(0)

    def on_mount(self) -> None:
        """Start the timer that turns the sign."""
        if self.app.animation_level != "none":
            self.set_interval(_TURN, self._turn_sign)

    def _turn_sign(self) -> None:
        if self.status is not None and self.status.state is RunState.STARTING:
            self.turn += 1

    def rows(self, size: Size) -> Sequence[Sequence[TextRun]]:
        """Paint the line."""
        return [] if self.status is None else [status_row(self.status, size.width, self.turn)]


def status_row(status: RunStatus, width: int, turn: int = 0) -> list[TextRun]:
    """Return the line in exactly ``width`` columns; the executor is dropped first, then most of the steps.

    Pace and recording are dropped next, the losses of the trace last.
    """
    title = TextRun(f" {status.title}", _STRONG)
    state = _state(status, turn)
    brief_state = TextRun(state.text.removesuffix(_still(status)), state.ink)
    pace = TextRun(f"  {status.pace}", _PLAIN)
    brief = TextRun(f"  {status.brief_pace}", _PLAIN)
    steps, step = _steps(status.steps), _steps(_about_current(status.steps))
    time = TextRun(f"t {timestamp(status.at)}", _STRONG)
    executor = TextRun(status.executor, _PLAIN)
    losses = _losses(status)
    recording = [*_export(status), *_recording(status)]
    whole = len(title.text) + 2
    for parts, least in (
        ([*steps, state, pace, _GAP, time, _GAP, executor, _GAP, *recording, *losses], whole),
        ([*steps, state, pace, _GAP, time, _GAP, *recording, *losses], whole),
        ([*step, state, pace, _GAP, time, _GAP, *recording, *losses], whole),
        ([*step, brief_state, brief, _GAP, time, _GAP, *recording, *losses], whole),
        ([*step[:1], *step[-1:], brief_state, brief, _GAP, time, _GAP, *recording, *losses], whole),
        ([*step[:1], *step[-1:], brief_state, _GAP, time, _GAP, *recording, *losses], whole),
        ([state, pace, _GAP, time, _GAP, *recording, *losses], whole),
        ([state, _GAP, time, _GAP, *recording, *losses], _LEAST_TITLE),
        ([state, _GAP, time, _GAP, *losses], _LEAST_TITLE),
        ([state, _GAP, time, _GAP, losses[-1]], 0),
    ):
        room = width - sum(len(run.text) for run in parts) - 1
        if room >= least:
            break
    shown = f"{fit(title.text, room - 1, Charset.BRAILLE)} " if room > 1 else " " * room
    return [TextRun(shown, _STRONG), *parts, TextRun(" ", _PLAIN)]


def _state(status: RunStatus, turn: int) -> TextRun:
    if status.back and status.state in (
        RunState.STARTING,
        RunState.LIVE,
        RunState.PAUSED,
        RunState.SILENT,
        RunState.ENDED,
    ):
        paused = ", paused" if status.state is RunState.PAUSED else ""
        return TextRun(f"◂ BACK {duration(status.back)}{paused}", _WARN)
    if status.state is RunState.STARTING:
        return TextRun(f"{_TURNING[turn % len(_TURNING)]} STARTING", _STRONG)
    if status.state is RunState.LIVE and status.still is not None:
        state = "STARVED" if status.only else "STUCK"
        return TextRun(f"✗ {state} {duration(status.still)}{_still(status)}", _WARN)
    if status.state is RunState.LIVE and status.goal is not None:
        return TextRun(f"● LIVE to {status.goal / 1e9:.9g} s", _STRONG)
    return _STATES[status.state]


def _still(status: RunStatus) -> str:
    if status.only:
        return f", only {status.only} runs"
    return f", only {status.moves} moves" if status.moves else ", nothing moves"


_TURNING = "◐◓◑◒"
_STEP_INKS = {StepState.DONE: _PLAIN, StepState.CURRENT: _STRONG, StepState.OPEN: _FAINT}


def _steps(steps: Sequence[LessonStep]) -> list[TextRun]:
    """The steps, joined by arrows, and a gap."""
    runs: list[TextRun] = []
    for step in steps:
        runs += [TextRun(" ▸ ", _FAINT)] if runs else []
        runs.append(TextRun(step.text, _STEP_INKS[step.state]))
    return [*runs, _GAP] if runs else []


def _about_current(steps: Sequence[LessonStep]) -> Sequence[LessonStep]:
    """The current step and the one after it; the last one if all are done."""
    place = next((place for place, step in enumerate(steps) if step.state is StepState.CURRENT), len(steps))
    return steps[place : place + 2] or steps[-1:]


_STATES = {
    RunState.LIVE: TextRun("● LIVE", _STRONG),
    RunState.PAUSED: TextRun("‖ PAUSED", _WARN),
    RunState.SILENT: TextRun("✗ SILENT", _WARN),
    RunState.ENDED: TextRun("■ ENDED", _STRONG),
    RunState.LOST: TextRun("✗ LOST", _WARN),
    RunState.REPLAY_STANDS: TextRun("‖ REPLAY", _STRONG),
    RunState.REPLAY_PLAYS: TextRun("▶ REPLAY", _STRONG),
}


def _export(status: RunStatus) -> list[TextRun]:
    return [] if status.exported is None else [TextRun(f"EXPORT {status.exported} %", _WARN), _GAP]


def _recording(status: RunStatus) -> list[TextRun]:
    if status.recorded is None:
        return []
    lost = f", {status.unrecorded:,} missed" if status.unrecorded else ""
    size = f" {status.recorded_bytes // 1_000_000:,} MB" if status.recorded_bytes >= _WORTH_TELLING else ""
    return [TextRun(f"REC {status.recorded:,}{size}{lost}", _WARN), _GAP]


def _losses(status: RunStatus) -> list[TextRun]:
    known = "-" if status.dropped is None else status.dropped
    losses = [TextRun(f"lost {known}", _WARN if status.dropped else _FAINT)]
    if status.lost:
        losses += [_GAP, TextRun(f"trace lost {status.lost}", _WARN)]
    return losses
