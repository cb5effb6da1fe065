"""The window with a run's diagnosis: what happened, why, what to do, and where."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import partial
from threading import Event
from time import monotonic
from typing import Protocol

from textual import on
from textual.app import ComposeResult
from textual.await_complete import AwaitComplete
from textual.containers import VerticalScroll
from textual.content import Content
from textual.events import Key
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from cbtui.keys.action import Scope
from cbtui.keys.keymap import canonical, keymap_of
from cbtui.keys.refused import NOT_IN_DIAGNOSES
from cbtui.looks.theme import Charset
from cbtui.runs.judged.cures import Cure, Verdict, tried_in_vain
from cbtui.runs.live.findings import ExplainedFinding
from cbtui.screens.windows.finding_texts import cure_details, details_of, row_of, step_row, title_of
from cbtui.screens.windows.window import PlainOptionList, WindowScreen
from cbtui.widgets.key_bar import KeyBar
from lessons.lesson import Lesson
from sim.diagnosis import sentence
from sim.quantities.nanoseconds import SECOND
from sim.trace.model import Nanoseconds

_ALL_IS_WELL = "No rule has found a problem so far. What a program should do and does not, no rule can know."
_NOT_SIMPLE = (
    "No cure can be offered here: cbtui only makes small changes by itself, and this needs one by you."
)
_LEAST_WIDE = 120
"""The width of the window on a wide screen, unless a row needs more."""
_FRAME = 7
"""Columns of a row that its frame, its margins and the scroll bar take."""
_CHECK_INTERVAL = 0.5
"""Seconds between two looks at the current findings."""


class Trial(Protocol):
    """Tries cures in the background."""

    @property
    def refusal(self) -> str:
        """A sentence on why no cure of this run is tried; "" if cures are tried."""

    def cures(self, found: ExplainedFinding) -> Sequence[Cure]:
        """Return the cures of a finding that can be tried."""

    def judge(self, found: ExplainedFinding, cure: Cure, note: Callable[[int], object]) -> Verdict:
        """Try a cure and tell whether it ends a finding; for a worker thread.

        ``note`` gets the progress in per cent. The trial goes on if who asked does not wait for it.
        """


class NextStep(Enum):
    """A way to continue from a finding, by the action that takes it."""

    LOOK = "go"
    CURE = "try_this"
    LESSON = "open_lesson"


@dataclass(frozen=True, slots=True)
class ChosenStep:
    """The chosen step: go to a finding, try a cure, or open the lesson that shows the problem."""

    finding: ExplainedFinding
    step: NextStep = NextStep.LOOK
    cure: Cure | None = None


@dataclass(frozen=True)
class _Row:
    """A row of the list: the index of a finding, a step, and the cure if the step is to try one."""

    place: int
    step: NextStep
    cure: Cure | None = None


class DiagnosesScreen(WindowScreen[ChosenStep]):
    """Lists findings with their steps, problems first; the result is the chosen step, None to stay.

    A cure is offered once ``trial`` has found that it helps. ``lesson_on`` returns the lesson that shows a
    problem; it is offered after all trials, so that a key meant for a cure opens none. ``latest`` returns the
    current findings, or None once another run has begun: the list follows them, begins again when there is a
    new problem, or a cure of one that had none, and closes with its run. ``as_of`` returns the time of the
    run that they are about, which may have gone on since; ``beside`` what else is known of it, as a clause.
    """

    SCOPE = Scope.DIAGNOSES

    def __init__(
        self,
        findings: Sequence[ExplainedFinding],
        charset: Charset,
        trial: Trial | None = None,
        lesson_on: Callable[[ExplainedFinding], Lesson | None] = lambda _: None,
        latest: Callable[[], Sequence[ExplainedFinding] | None] | None = None,
        as_of: Callable[[], Nanoseconds] | None = None,
        beside: Callable[[], str] = lambda: "",
    ) -> None:
        super().__init__(charset)
        self._trial = trial
        self._lesson_on = lesson_on
        self._latest = latest
        self._as_of = as_of
        self._beside = beside
        self._outdated = Event()
        self._refused: tuple[str, _Row | None] = "", None
        """The action of a key that did nothing, and the row in which it did, while the window says why."""
        self._list(findings)

    def _list(self, findings: Sequence[ExplainedFinding]) -> None:
        """Begin with these findings."""
        trial = self._trial
        self._findings: Sequence[ExplainedFinding] = findings
        self._lessons = [self._lesson_on(each) for each in findings]
        cures = [() if trial is None else trial.cures(each) for each in findings]
        self._untried = [len(each) for each in cures]
        """The number of untried cures of each finding."""
        self._cures = [(place, cure) for place, each in enumerate(cures) for cure in each]
        self._helpful: list[tuple[int, Cure]] = []
        self._verdicts: list[tuple[int, Cure, Verdict]] = []
        """The verdicts on the tried cures, with the index of their finding."""
        self._percent: dict[int, int] = {}
        """The progress of the current trial, by the index of its finding."""
        self._trying_since = monotonic()
        self._rows = tuple(self._list_rows())
        self._outdated.set()
        self._outdated = Event()
        self._entitle()

    def _entitle(self) -> None:
        """Set the heading to the counts of the findings, and the time that they are about."""
        as_of = "" if self._as_of is None else f", as of {self._as_of() / SECOND:.1f} s"
        self.heading = f"{title_of(self._findings)}{as_of}"
        for window in self.query(".window"):
            window.border_title = self.heading

    def content(self) -> ComposeResult:
        """Lay out the list, and the details of the highlighted row."""
        yield PlainOptionList(*self._options())
        with VerticalScroll(can_focus=False):
            yield Static(classes="told")
        yield Static(classes="well", markup=False)

    def on_mount(self) -> None:
        """Highlight the worst finding, and check for new ones regularly."""
        self._begin()
        self.set_interval(_CHECK_INTERVAL, self._check_for_new)

    def _begin(self) -> None:
        some = bool(self._findings)
        listed, details = self.query_one(OptionList), self.query_one(VerticalScroll)
        listed.display = details.display = some
        self._tell_beside()
        self._explain_refused("")
        listed.highlighted = 0 if some else None
        self._tell_highlighted()
        self._widen()
        if self._trial is not None:
            self.run_worker(partial(self._try_all, self._trial, self._outdated), thread=True)

    def _tell_beside(self) -> None:
        beside, well = self._beside(), self.query_one(".well", Static)
        told = (_ALL_IS_WELL * (not self._findings), sentence(beside) if beside else "")
        well.update("\n".join(filter(None, told)))
        well.display = bool(beside or not self._findings)

    def _check_for_new(self) -> None:
        findings = self._findings if self._latest is None else self._latest()
        if findings is None:
            self.dismiss(None)
        elif not _to_try(findings) <= _to_try(self._findings):
            self._list(findings)
            self._show_options()
            self._begin()
        else:
            self._follow({each.finding.key: each for each in findings})

    def _follow(self, latest: Mapping[object, ExplainedFinding]) -> None:
        """Show the latest figures of the findings in place: nothing moves."""
        self._findings = [latest.get(each.finding.key, each) for each in self._findings]
        listed = self.query_one(OptionList)
        for place, option in enumerate(self._options()):
            if listed.get_option_at_index(place).prompt != option.prompt:
                listed.replace_option_prompt_at_index(place, option.prompt)
        self._entitle()
        self._tell_beside()
        self._tell_highlighted()

    def dismiss(self, result: ChosenStep | None = None) -> AwaitComplete:
        """Close the window, and begin no further trials."""
        self._outdated.set()
        return super().dismiss(result)

    def on_unmount(self) -> None:
        """Begin no further trials."""
        self._outdated.set()

    def _list_rows(self) -> Iterator[_Row]:
        for place, lesson in enumerate(self._lessons):
            yield _Row(place, NextStep.LOOK)
            yield from (_Row(place, NextStep.CURE, cure) for about, cure in self._helpful if about == place)
            is_new = lesson is not None and lesson not in self._lessons[:place]
            if is_new and not any(self._untried):
                yield _Row(place, NextStep.LESSON)

    def _options(self) -> Iterator[Option]:
        for row in self._rows:
            lesson = self._lessons[row.place]
            if row.cure is not None:
                yield Option(step_row(f"tried, it helps: {row.cure.words}", self._charset))
            elif row.step is NextStep.LESSON and lesson is not None:
                yield Option(
                    step_row(f"open lesson {lesson.number}, which shows this: {lesson.title}", self._charset)
                )
            else:
                yield Option(row_of(self._findings[row.place], self._charset))

    def _try_all(self, trial: Trial, outdated: Event) -> None:
        findings = self._findings
        for place, cure in self._cures:
            note = partial(self._note_progress, place, outdated)
            if outdated.is_set():
                return
            verdict = trial.judge(findings[place], cure, note)
            self._tell_from_thread(outdated, self._note_tried, place, cure, verdict)

    def _note_progress(self, place: int, outdated: Event, percent: int) -> None:
        if percent != self._percent.get(place) and not outdated.is_set():
            self._percent[place] = percent
            self._tell_from_thread(outdated, self._tell_highlighted)

    def _tell_from_thread(self, outdated: Event, tell: Callable[..., None], *told: object) -> None:
        """Let the screen's thread tell something, unless the window is being closed there."""
        if not outdated.is_set():
            self.app.call_from_thread(lambda: None if outdated.is_set() else tell(*told))

    def _note_tried(self, place: int, cure: Cure, verdict: Verdict) -> None:
        """Offer to try a cure if it helps; the highlight stays where it is."""
        chosen = self._chosen
        self._untried[place] -= 1
        self._percent[place] = 0
        self._verdicts.append((place, cure, verdict))
        if verdict.helps:
            self._helpful.append((place, verdict.both or cure))
            if chosen is not None and chosen.place == place:
                self._explain_refused("")
        self._rows = tuple(self._list_rows())
        self._show_options().highlighted = 0 if chosen is None else self._rows.index(chosen)
        self._tell_highlighted()
        self.call_after_refresh(self.query_one(KeyBar).changed)

    def _show_options(self) -> OptionList:
        listed = self.query_one(OptionList)
        listed.clear_options()
        listed.add_options(self._options())
        self._widen()
        return listed

    def _widen(self) -> None:
        """Let the window be as wide as its rows need, if there is room."""
        rows = (option.prompt for option in self._options())
        longest = max((row.cell_length for row in rows if isinstance(row, Content)), default=0)
        self.query_one(".window").styles.max_width = max(_LEAST_WIDE, longest + _FRAME)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the steps of the highlighted row."""
        chosen = self._chosen
        match action:
            case "previous" | "next":
                return len(self._rows) > 1
            case "go" | "try_this" | "open_lesson":
                if chosen is None or chosen.step.value != action:
                    return False
                return chosen.step is not NextStep.LOOK or self._findings[chosen.place].leads_somewhere
            case "try_cure":
                return self._cure_at_hand is not None
            case "page_up" | "page_down":
                return any(text.max_scroll_y > 0 for text in self.query(VerticalScroll))
        return True

    @property
    def _cure_at_hand(self) -> Cure | None:
        """The highlighted cure, or the first one of the highlighted finding."""
        chosen = self._chosen
        if chosen is None or chosen.cure is not None:
            return None if chosen is None else chosen.cure
        return next((cure for place, cure in self._helpful if place == chosen.place), None)

    def _tell_highlighted(self) -> None:
        """Show the details of the highlighted row."""
        chosen = self._chosen
        if chosen is None:
            return
        if chosen.cure is not None:
            width = self.query_one(".told").content_size.width
            details = cure_details(chosen.cure, self._charset, width)
        else:
            found, place = self._findings[chosen.place], chosen.place
            in_vain = self._untried[place] == 0 and {each.helps for each in self._of(place)} == {False}
            details = details_of(found, self._charset, self._about_trial(place), in_vain=in_vain)
        self.query_one(".told", Static).update(details)
        self._tell_refused()

    def _of(self, place: int) -> list[Verdict]:
        """The verdicts on the cures of a finding."""
        return [verdict for about, _, verdict in self._verdicts if about == place]

    def _about_trial(self, place: int) -> str:
        """The sentence on the trial of a finding's cures, or on why there is none; "" if one simply helps."""
        cures = [cure for about, cure in self._cures if about == place]
        if left := self._untried[place]:
            of = len(cures)
            percent = (100 * (of - left) + self._percent.get(place, 0)) // of
            subject = "Another cure" if any(about == place for about, _ in self._helpful) else "A cure"
            if place != self._cures[len(self._verdicts)][0]:
                return f"{subject} will be tried after those of another problem."
            how_far = f"{percent} %" if percent else "its run is starting"
            return f"{subject} is being tried, for {monotonic() - self._trying_since:.0f} s now: {how_far}."
        tried = [(cure, verdict) for about, cure, verdict in self._verdicts if about == place]
        if tried and not any(verdict.helps for _, verdict in tried):
            return tried_in_vain(tried)
        helpful = [verdict for verdict in self._of(place) if verdict.helps]
        if helpful and helpful[0].instead:
            return f"A cure was tried, and helps against this; then another one comes: {helpful[0].instead}."
        found = self._findings[place]
        if cures or self._trial is None or not found.is_problem:
            return ""
        has_edit = any(each.edit for each in found.explanation.remedies)
        return self._trial.refusal or (_NOT_SIMPLE if has_edit else "")

    @on(OptionList.OptionHighlighted)
    def _tell(self) -> None:
        self._tell_highlighted()
        if self._chosen != self._refused[1]:  # the same row is told again when a cure gets a row before it
            self._explain_refused("")
        self.query_one(VerticalScroll).scroll_home(animate=False)
        self.call_after_refresh(self.query_one(KeyBar).changed)

    def on_key(self, event: Key) -> None:
        """Say why a key of the window does nothing now."""
        meant = keymap_of(self.app).on(event.key, self.SCOPE)
        if meant and canonical(event.key) not in self.query_one(KeyBar).in_force():
            event.stop()
            self._explain_refused(meant[0].id)

    def _explain_refused(self, action: str) -> None:
        """Say in the frame why an action did nothing in the highlighted row; "" says nothing."""
        self._refused = action, self._chosen if action else None
        self._tell_refused()

    def _tell_refused(self) -> None:
        action, row = self._refused
        why = NOT_IN_DIAGNOSES.get(action, "")
        if why and not self._findings:
            why = "the list is empty"
        elif action == "try_cure" and row is not None and self._untried[row.place]:
            why = self._about_trial(row.place).rstrip(".")
            why = why[0].lower() + why[1:]
        self.query_one(".window").border_subtitle = why

    def action_go(self) -> None:
        """Go where the highlighted row leads."""
        if self._chosen is not None:
            row = self._chosen
            self.dismiss(ChosenStep(self._findings[row.place], row.step, row.cure))

    action_try_this = action_open_lesson = action_go

    def action_try_cure(self) -> None:
        """Run again with the highlighted cure."""
        if self._chosen is not None:
            self.dismiss(ChosenStep(self._findings[self._chosen.place], NextStep.CURE, self._cure_at_hand))

    @property
    def _chosen(self) -> _Row | None:
        highlighted = next((listed.highlighted for listed in self.query(OptionList)), None)
        return None if highlighted is None else self._rows[highlighted]


def _to_try(findings: Sequence[ExplainedFinding]) -> frozenset[object]:
    """Return what identifies the problems, and once more those with a cure: it may come after a while."""
    problems = ((each.finding.key, any(each.explanation.remedies)) for each in findings if each.is_problem)
    return frozenset((key, each) for key, has_cure in problems for each in (False, has_cure))
