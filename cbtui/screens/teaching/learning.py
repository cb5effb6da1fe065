"""The learner's progress in the lesson on screen, and its page."""

from collections.abc import Callable
from dataclasses import dataclass

from textual.screen import Screen

from cbtui.keys.action import Scope
from cbtui.keys.keymap import STANDARD
from cbtui.learning.lesson_page import Page, PageKeys, PageSection, PageState
from cbtui.learning.outcome import PredictionOutcome
from cbtui.learning.stage import LessonStep, steps_of
from cbtui.looks.theme import Charset
from cbtui.screens.parts.panes import PaneLayout
from cbtui.screens.parts.part import ScreenHost
from cbtui.widgets.guide import Guide
from lessons.lesson import Lesson
from lessons.progress import LessonProgress, Progress

_NAMED = ("predict", "explain", "hint", "solution", "exercise", "call_service")
"""Actions whose keys the page names."""


def signs() -> PageKeys:
    """Return the registry's keys, which the guide replaces by those in force."""
    return PageKeys(*(STANDARD.sign(Scope.LESSON, action, Charset.ASCII) for action in _NAMED))


@dataclass
class Learning:
    """Tracks the learner's progress in a lesson, and shows its page, which ``write`` creates."""

    screen: Screen[None]
    host: ScreenHost
    panes: PaneLayout
    lesson: Lesson
    write: Callable[[PageState], Page]
    state: PageState | None = None
    """The state of the page; None until it is shown first."""
    outcome_pending: bool = False
    """Whether the run that shows the true answers is in progress."""
    was_called: bool = True
    """Whether the run on screen has the call that the explanation is about."""

    @property
    def store(self) -> Progress:
        """The store of the learner's progress."""
        return self.host.console.progress

    @property
    def progress(self) -> LessonProgress:
        """The stored progress in the lesson."""
        return self.store.of(self.lesson.id)

    @property
    def guide(self) -> Guide:
        """The pane with the page."""
        return self.screen.query_one(Guide)

    def steps(self, checks: str = "") -> tuple[LessonStep, ...]:
        """Return the steps through the lesson; ``checks`` as ``steps_of``."""
        return steps_of(self.lesson, self.progress, checks)

    def page(self) -> Page:
        """Return the unlocked page."""
        if self.state is None:
            self.state = PageState(self.progress)
        return self.write(self.state)

    def update_state(self, outcome: PredictionOutcome | None = None) -> None:
        """Update the state of the page; a known outcome is kept until the next run for one."""
        known = None if self.state is None or self.outcome_pending else self.state.outcome
        self.state = PageState(self.progress, outcome or known, self.outcome_pending, self.was_called)
        self.host.redraw()

    async def update_page(self, outcome: PredictionOutcome | None = None) -> None:
        """Update the state, and show the unlocked page."""
        self.update_state(outcome)
        for sentence in self.store.troubles():
            self.screen.notify(sentence, severity="warning", markup=False)
        await self.guide.show(self.page())

    def read(self, part: PageSection) -> None:
        """Go to a section of the page."""
        self.panes.show("guide")
        self.guide.go_to(part)
