"""How far the learner is in the lesson on screen, and what of its page can be read so far."""

from collections.abc import Callable
from dataclasses import dataclass

from textual.screen import Screen

from cbtui.keys.action import Scope
from cbtui.keys.keymap import STANDARD
from cbtui.learning.lesson_page import Page, PageKeys, PageSection, PageState
from cbtui.learning.outcome import PredictionOutcome
from cbtui.looks.theme import Charset
from cbtui.screens.parts.panes import PaneLayout
from cbtui.screens.parts.part import ScreenHost
from cbtui.widgets.guide import Guide
from lessons.lesson import Lesson
from lessons.progress import LessonProgress, Progress

_NAMED = ("predict", "explain", "hint", "solution", "exercise")
"""The actions whose keys the page names."""


def signs() -> PageKeys:
    """Return the registry's keys: the guide shows those in force, as for the lesson's own texts."""
    return PageKeys(*(STANDARD.sign(Scope.LESSON, action, Charset.ASCII) for action in _NAMED))


@dataclass
class Learning:
    """Keeps how far the learner is in a lesson, and shows its page; ``write`` makes the page of that."""

    screen: Screen[None]
    host: ScreenHost
    panes: PaneLayout
    lesson: Lesson
    write: Callable[[PageState], Page]
    standing: PageState | None = None
    """How far the learner is; None until the page is shown first."""
    finds_out: bool = False
    """Whether a run is going on to find out what is true."""

    @property
    def store(self) -> Progress:
        """Where the learner's progress is kept."""
        return self.host.console.progress

    @property
    def progress(self) -> LessonProgress:
        """How far the learner is by what is kept."""
        return self.store.of(self.lesson.id)

    @property
    def guide(self) -> Guide:
        """The pane with the page."""
        return self.screen.query_one(Guide)

    def page(self) -> Page:
        """Return what can be read now."""
        if self.standing is None:
            self.standing = PageState(self.progress)
        return self.write(self.standing)

    def take_stock(self, outcome: PredictionOutcome | None = None) -> None:
        """Note how far the learner is; what a run showed stays known until the next is to find it out."""
        known = None if self.standing is None or self.finds_out else self.standing.outcome
        self.standing = PageState(self.progress, outcome or known, self.finds_out)
        self.host.redraw()

    async def learnt(self, outcome: PredictionOutcome | None = None) -> None:
        """Take in what was learnt, and show what can be read now."""
        self.take_stock(outcome)
        for sentence in self.store.troubles():
            self.screen.notify(sentence, severity="warning", markup=False)
        await self.guide.show(self.page())

    def read(self, part: PageSection) -> None:
        """Go to a part of the page."""
        self.panes.show("guide")
        self.guide.go_to(part)
