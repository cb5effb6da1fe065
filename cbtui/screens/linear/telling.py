"""Prints a run in lines: its news, and the moments that the user goes to."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from cbtui.keys.keymap import Keymap
from cbtui.runs.live.live_run import LiveRun, RunState, ShownRun
from cbtui.runs.setup.shown_program import ShownProgram
from cbtui.screens.linear.dialogue import LineHost
from cbtui.screens.linear.narrative import LEAST, Narrative, told_finding, told_moment
from cbtui.screens.parts.copying import summary
from cbtui.screens.parts.narration import was_stepped
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.part import ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.widgets.diagnosis import diagnosis_on_screen
from cbtui.widgets.narrator.narration import narration
from sim.files.untrusted import program_text
from sim.quantities.durations import duration, timestamp
from sim.trace.events import AnyEvent, KeyboardAsked, TimeHalted
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline


@dataclass
class Telling(ScreenPart):
    """Prints what happens in a run, its problems, and the moments that ``navigation`` goes to.

    ``begin`` is called for each new run; ``live`` returns the run if it has an engine.
    """

    host: LineHost
    subject: ShownProgram
    runs: RunController[ShownRun]
    live: Callable[[], LiveRun | None]
    keymap: Keymap
    narrative: Narrative = field(default_factory=lambda: Narrative(Timeline()))
    _state: RunState = RunState.STARTING
    _steps: bool = False
    _asked: KeyboardAsked | None = None
    _moved_to: Nanoseconds | None = None

    def __post_init__(self) -> None:
        runs = self.runs
        self.navigation = TimeNavigation(
            lambda: [runs.timeline], lambda: runs.timeline.end, self._move, self.live, self._await_step
        )

    def begin(self) -> None:
        """Begin to report a new run, with the settings of the last one."""
        before = self.narrative
        self.narrative = Narrative(self.runs.timeline, before.least, whole=before.whole)
        self._state, self._steps, self._moved_to = RunState.STARTING, False, None

    def tell_news(self) -> None:
        """Print the news at the current moment; nothing before a moment that the user went to is news."""
        findings, now = self.runs.findings, self.navigation.now
        findings.update_when_due()
        if self._moved_to is not None:
            self.narrative.news(min(self._moved_to, now), findings.findings)
            self._moved_to = None
        for line in self.narrative.news(now, findings.findings):
            self.host.tell(line)
        self.tell_state()
        before, asked = self._asked, self.runs.run.asked
        self._asked = asked
        if asked is not None and asked != before:
            key = self.host.key("type")
            self.host.tell(f"{asked.program} waits for the keyboard" + (f": press {key}" if key else ""))

    def tell_state(self) -> None:
        """Print whether time passes, or how the run ended, if that has changed."""
        run, at = self.runs.run, timestamp(self.navigation.now)
        before, self._state = self._state, run.state
        is_under_way = run.state in (RunState.LIVE, RunState.PAUSED, RunState.REPLAY_PLAYS)
        looks_back = self.navigation.playhead.at is not None
        if before is run.state or run.state is RunState.STARTING:
            return
        if before is RunState.STARTING and looks_back:
            return
        if is_under_way or looks_back:
            self.host.tell(f"{at}: {'time stands still' if run.paused else 'time goes on'}")
        else:
            playhead, concurrency = self.navigation.playhead, self.runs.concurrency
            self.host.tell(diagnosis_on_screen(run, playhead, concurrency, self.keymap).text)

    def _await_step(self) -> None:
        """Print the next decision once it is made."""
        self._steps = True

    def take(self, events: Iterable[AnyEvent]) -> None:
        """Print the decision to which the run was stepped."""
        if self._steps and any(isinstance(event, TimeHalted) for event in events):
            self._steps = False
            self.action_narrate()

    def _move(self) -> None:
        timeline, now = self.runs.timeline, self.navigation.now
        self._steps, self._moved_to = False, now
        if self.navigation.playhead.at is None:
            self.host.tell(f"{timestamp(now)}: {'the present' if self.runs.run.alive else 'the end'}")
        for line in told_moment(timeline, now):
            self.host.tell(line)

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer more or less detail, within the limits."""
        least = self.narrative.least
        return {"zoom_in": least > LEAST[0], "zoom_out": least < LEAST[-1]}.get(action, True)

    def action_narrate(self) -> None:
        """Print the executor's last decision."""
        stepped = was_stepped(self.runs.run, self.navigation)
        for line in narration(self.runs.timeline, self.navigation.now, stepped):
            self.host.tell(line)

    def action_select(self) -> None:
        """Print what runs and waits."""
        runs = self.runs
        for line in summary(self.subject, runs.timeline, self.navigation.now, runs.concurrency):
            self.host.tell(line.strip())

    def action_diagnoses(self) -> None:
        """Print the findings with their numbers."""
        findings = self.runs.findings
        findings.update()
        for number, each in enumerate(findings.findings, start=1):
            what = "problem" if each.is_problem else "remark"
            self.host.tell(f"{number}: {what}: {told_finding(each)}")
        if not findings.findings:
            self.host.tell(
                "no rule has found a problem so far; what a program should do and does not, no rule can know"
            )

    def action_zoom_in(self) -> None:
        """Report shorter calls and waits."""
        self._change_least(-1)

    def action_zoom_out(self) -> None:
        """Report only longer calls and waits."""
        self._change_least(1)

    def _change_least(self, step: int) -> None:
        self.narrative.least = LEAST[LEAST.index(self.narrative.least) + step]
        self.host.tell(f"calls and waits are told from {duration(self.narrative.least)} on")

    @property
    def _source(self) -> str:
        subject = self.subject
        return subject.source or program_text(subject.node_path) or "# There is no code to be read."

    def action_show_pane(self, name: str) -> None:
        """Print the guide or the code, or report the whole log."""
        match name:
            case "guide":
                self.host.tell_page(self.subject.guide)
                return
            case "code":
                for number, line in enumerate(self._source.splitlines(), start=1):
                    self.host.tell(f"{number}: {line}" if line.strip() else None)
                return
        whole = self.narrative.whole = not self.narrative.whole
        self.host.tell("every line of the log is told" if whole else "each text of the log is told once")
