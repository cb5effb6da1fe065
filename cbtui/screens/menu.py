"""The menu: the lessons by unit, and what the highlighted one teaches."""

from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING, ClassVar, cast

from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.content import Content
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from cbtui.actions import Scope, bindings_of
from cbtui.screens.sized import SizedScreen
from cbtui.theme import Charset
from cbtui.widgets.about import About
from cbtui.widgets.banner import Banner
from cbtui.widgets.cells import fit
from cbtui.widgets.key_bar import KeyBar
from lessons.lesson import Lesson

if TYPE_CHECKING:
    from cbtui.app import CbtuiApp


class LessonList(OptionList, inherit_bindings=False):
    """The lessons; the screen's keys move its highlight."""


class MenuScreen(SizedScreen[None]):
    """Where the console begins and every lesson comes back to."""

    SCOPE = Scope.MENU
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.MENU)]

    def __init__(self, lessons: Sequence[Lesson], charset: Charset) -> None:
        super().__init__()
        self._lessons = lessons
        self._charset = charset

    def compose(self) -> ComposeResult:
        """Lay out head, list, description and keys."""
        yield Banner()
        with Container(id="choice"):
            yield LessonList(*self._options(), id="lessons")
            yield About()
        yield KeyBar(Scope.MENU, self._charset)

    def on_mount(self) -> None:
        """Highlight the first lesson."""
        self._list.highlighted = self._list.get_option_index(self._lessons[0].id)

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Tell what the highlighted lesson teaches."""
        self.query_one(About).lesson = self._lesson(event.option.id)

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Open the lesson that was clicked or confirmed."""
        self._open(self._lesson(event.option.id))

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the numbers of lessons that exist."""
        if action == "open_number":
            return any(lesson.number == parameters[0] for lesson in self._lessons)
        return True

    def action_open(self) -> None:
        """Open the highlighted lesson."""
        self._list.action_select()

    def action_open_number(self, number: int) -> None:
        """Open the lesson with a number."""
        for lesson in self._lessons:
            if lesson.number == number:
                self._list.highlighted = self._list.get_option_index(lesson.id)
                self._open(lesson)

    def action_previous(self) -> None:
        """Highlight the lesson above."""
        self._list.action_cursor_up()

    def action_next(self) -> None:
        """Highlight the lesson below."""
        self._list.action_cursor_down()

    def action_leave(self) -> None:
        """Leave the console."""
        self.app.exit()

    @property
    def _list(self) -> LessonList:
        return self.query_one(LessonList)

    def _open(self, lesson: Lesson) -> None:
        cast("CbtuiApp", self.app).open_lesson(lesson)

    def _lesson(self, lesson_id: str | None) -> Lesson:
        return next(lesson for lesson in self._lessons if lesson.id == lesson_id)

    def _options(self) -> list[Option]:
        options = []
        for unit, lessons in groupby(self._lessons, key=lambda lesson: lesson.unit):
            heading = Content.styled(f"Unit {unit}", "bold $text-primary")
            options.append(Option(heading, disabled=True))
            options += [Option(row(lesson), id=lesson.id) for lesson in lessons]
        return options


def row(lesson: Lesson) -> Content:
    """Return a lesson's line in the list."""
    return Content.assemble(
        (f"{lesson.number:>3}  ", "bold $text-accent"),
        (fit(lesson.title, 24, Charset.BRAILLE), "bold"),
        fit(lesson.executor, 26, Charset.BRAILLE),
        (lesson.groups, "$text-muted"),
    )
