"""The menu: lessons by unit, recent files, and a description of the highlighted entry."""

import asyncio
from collections.abc import Callable, Sequence
from time import time
from typing import TYPE_CHECKING, ClassVar

from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.events import DescendantBlur, DescendantFocus
from textual.message import Message
from textual.timer import Timer
from textual.widgets import Input, OptionList

from cbtui.engines.follow import GivenUpError
from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.keys.keymap import keymap_of
from cbtui.learning.lesson_page import short_description
from cbtui.learning.preview import CALLS, LENGTH, CannotPreviewError, PreviewRun, why_no_preview
from cbtui.learning.stage import Stage, stage_of, stage_text
from cbtui.looks.theme import Charset
from cbtui.runs.setup.recent import RecentEntry, RecentList
from cbtui.screens.console import console_of
from cbtui.screens.layout import Layout
from cbtui.screens.sized import SizedScreen
from cbtui.widgets.banner import Banner
from cbtui.widgets.description_pane import DescriptionPane, EntryDescription, of_file, of_lesson
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.menu_list import MenuList, MenuRows, WideMenuRows, with_words
from cbtui.widgets.menu_search import MenuSearch
from cbtui.widgets.miniature import Miniature, PreviewPicture
from lessons.lesson import Lesson
from lessons.progress import Progress

if TYPE_CHECKING:
    from cbtui.engines.session import OpenSession

_HOVER_DELAY = 0.3
"""Seconds that a lesson must stay highlighted before its preview is run."""
_EXIT_TIMEOUT = 1.0
"""Seconds to wait at exit for the engine of a preview, which is killed sooner."""
_CALLED = " and ".join(f"{at / 1e9:g}" for at in CALLS)
_TITLE = f"first {LENGTH / 1e9:g} s, {{key}} pressed at {_CALLED} s"
_NO_PICTURE = "no picture"
_WAIT = f"Rest on a lesson, and {LENGTH / 1e9:g} s of it are run and drawn here."


class MenuScreen(SizedScreen[None]):
    """The first screen, to which every lesson returns.

    The highlighted lesson is run once for its preview: one engine at a time, only while the menu is active.
    """

    SCOPE = Scope.MENU
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.MENU)]

    class Drawn(Message):
        """A preview run has ended; ``subject`` is its picture, a sentence, or None if aborted."""

        def __init__(self, lesson: Lesson, subject: PreviewPicture | str | None) -> None:
            super().__init__()
            self.lesson = lesson
            self.subject = subject

    def __init__(
        self,
        lessons: Sequence[Lesson],
        recents: RecentList,
        progress: Progress,
        open_session: "OpenSession",
        charset: Charset,
        now: Callable[[], float] = time,
    ) -> None:
        super().__init__()
        self._lessons = lessons
        self._recents = recents
        self._progress = progress
        self._open_session = open_session
        self._charset = charset
        self._now = now
        self._subjects: dict[str, PreviewPicture | str] = {}
        self._run: PreviewRun | None = None
        self._rest: Timer | None = None
        self._filled_with: object = None
        self._words = ""

    def compose(self) -> ComposeResult:
        """Lay out head, list, description and keys."""
        yield Banner()
        with Container(id="choice"):
            yield MenuList(id="lessons")
            yield DescriptionPane()
            yield Miniature()
        yield KeyBar(Scope.MENU, self._charset)

    def on_mount(self) -> None:
        """Focus the list."""
        self._list.focus()

    def on_screen_resume(self) -> None:
        """Refresh recent entries and progress, which other consoles may have changed."""
        self._progress.refresh()
        if self._filled_with == self._contents:
            self._describe()
        else:
            self._fill()

    def on_screen_suspend(self) -> None:
        """Abort the preview, as another engine may start now."""
        if self._rest is not None:
            self._rest.stop()
        self._give_up()

    async def on_unmount(self) -> None:
        """Wait for the preview's engine to end."""
        if self._run is not None:
            self._run.give_up()
            await asyncio.to_thread(self._run.wait, _EXIT_TIMEOUT)

    def laid_out(self) -> None:
        """Tell more in the list where there is room."""
        if self._filled_with != self._contents:
            self._fill()

    # the list

    @property
    def _contents(self) -> object:
        """Everything that the list depends on except the search."""
        return self.layout_now, self._recents.entries, self._stages

    @property
    def _stages(self) -> dict[str, Stage]:
        """The stage of each lesson by its id."""
        opened = self._recents.lessons
        return {
            lesson.id: stage_of(lesson, self._progress.of(lesson.id), opened=lesson.id in opened)
            for lesson in self._lessons
        }

    def _fill(self) -> None:
        self._filled_with = self._contents
        kind = WideMenuRows if self.layout_now is Layout.GRID else MenuRows
        rows = kind(self._lessons, self._stages, self._now())
        wanted = with_words(self._words)
        self._list.show(filter(wanted, self._lessons), filter(wanted, self._recents.files), rows)
        self._tell_troubles()
        self._describe()

    def _tell_troubles(self) -> None:
        for sentence in (*self._recents.troubles(), *self._progress.troubles()):
            self.notify(sentence, severity="warning", markup=False)

    def _describe(self) -> None:
        """Describe the highlighted entry, and start its preview after a delay."""
        chosen = self._list.chosen
        about = self.query_one(DescriptionPane)
        about.description = self._description
        about.set_class(not isinstance(chosen, Lesson), "-alone")
        self._miniature.display = isinstance(chosen, Lesson)
        key = keymap_of(self.app).sign(Scope.LESSON, "call_service", self._charset)
        reason = why_no_preview(chosen) if isinstance(chosen, Lesson) else None
        self._miniature.border_title = Text(_TITLE.format(key=key) if reason is None else _NO_PICTURE)
        if isinstance(chosen, Lesson) and reason is not None:
            self._subjects[chosen.id] = f"It is not run for its picture: {reason}."
        self._show_drawn()
        if self._rest is not None:
            self._rest.stop()
        if isinstance(chosen, Lesson) and chosen.id not in self._subjects:
            self._rest = self.set_timer(_HOVER_DELAY, self._draw)
        self.query_one(KeyBar).changed()

    @property
    def _description(self) -> EntryDescription:
        chosen = self._list.chosen
        if isinstance(chosen, Lesson):
            text = short_description(chosen, self._progress.of(chosen.id))
            opened = self._recents.lessons.get(chosen.id)
            so_far = stage_text(self._stages[chosen.id])
            return of_lesson(chosen, text, opened, self._now(), so_far, keymap_of(self.app))
        if chosen is not None:
            forget = keymap_of(self.app).sign(Scope.MENU, "forget", self._charset)
            return of_file(chosen, self._now(), forget)
        return EntryDescription("Nothing found", "No lesson and no recent file has all of these words.")

    @on(OptionList.OptionHighlighted)
    def _show_highlighted(self) -> None:
        self._describe()

    @on(OptionList.OptionSelected)
    def _open_selected(self, event: OptionList.OptionSelected) -> None:
        self._open(self._list.choice(str(event.option.id)))

    # the picture

    def _draw(self) -> None:
        """Start the preview of the highlighted lesson, after aborting another one."""
        chosen = self._list.chosen
        if not isinstance(chosen, Lesson) or chosen.id in self._subjects or not self.is_active:
            return
        if self._run is not None:
            if self._run.lesson is not chosen:
                self._run.give_up()
            return
        run = self._run = PreviewRun(chosen, self._open_session)
        self.run_worker(lambda: self._draw_with(run, chosen), thread=True)

    def _draw_with(self, run: PreviewRun, lesson: Lesson) -> None:
        """Run a preview, on a worker thread."""
        subject: PreviewPicture | str | None
        try:
            timeline = run.run()
        except CannotPreviewError as error:
            subject = f"It could not be run for its picture: {error}."
        except GivenUpError:
            subject = None
        else:
            from cbtui.widgets.lanes import (
                LanePainter,  # on this thread: the screen must not stand still for it
            )

            key = keymap_of(self.app).sign(Scope.LESSON, "call_service", self._charset)
            subject = PreviewPicture(timeline, LanePainter(self._charset, lesson.service.name, call_key=key))
        self.post_message(self.Drawn(lesson, subject))

    @on(Drawn)
    def _take_drawn(self, message: Drawn) -> None:
        self._run = None
        if message.subject is not None:
            self._subjects[message.lesson.id] = message.subject
            self._show_drawn()
        self._draw()

    def _show_drawn(self) -> None:
        chosen = self._list.chosen
        subject = self._subjects.get(chosen.id) if isinstance(chosen, Lesson) else None
        self._miniature.sentence = subject if isinstance(subject, str) else _WAIT
        self._miniature.subject = subject if isinstance(subject, PreviewPicture) else None

    def _give_up(self) -> None:
        if self._run is not None:
            self._run.give_up()

    # the search

    @on(Input.Changed)
    def _search_for(self, event: Input.Changed) -> None:
        self._words = event.value
        self._list.highlight_first()
        self._fill()

    @on(Input.Submitted)
    def _open_found(self) -> None:
        self._list.action_select()

    @on(MenuSearch.HighlightMoved)
    def _move(self, message: MenuSearch.HighlightMoved) -> None:
        if message.step < 0:
            self.action_previous()
        else:
            self.action_next()

    @on(MenuSearch.SearchCleared)
    def action_end_search(self) -> None:
        """Show everything again."""
        self._list.focus()
        self.query(MenuSearch).remove()
        self._words = ""
        self._fill()

    def on_descendant_focus(self, event: DescendantFocus) -> None:
        """Show the keys of the widget with the focus."""
        self.query_one(KeyBar).show(Scope.SEARCH if isinstance(event.widget, MenuSearch) else Scope.MENU)

    def on_descendant_blur(self, event: DescendantBlur) -> None:
        """Remove an empty search line."""
        if isinstance(event.widget, MenuSearch) and not self._words:
            self.query(MenuSearch).remove()

    # the keys

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the actions of the highlighted entry, and the numbers of existing lessons."""
        match action:
            case "open_number":
                return any(lesson.number == parameters[0] for lesson in self._lessons)
            case "open" | "submit":
                return self._list.chosen is not None
            case "forget":
                return isinstance(self._list.chosen, RecentEntry)
            case "end_search":
                return bool(self._words)
        return True

    def action_open(self) -> None:
        """Open what is highlighted."""
        self._list.action_select()

    def action_open_number(self, number: int) -> None:
        """Open the lesson with a number."""
        for lesson in self._lessons:
            if lesson.number == number:
                self._list.choose(lesson.id)
                self._open(lesson)

    def action_previous(self) -> None:
        """Highlight what is above."""
        self._list.action_cursor_up()

    def action_next(self) -> None:
        """Highlight what is below."""
        self._list.action_cursor_down()

    def action_search(self) -> None:
        """Let words be typed."""
        if not self.query(MenuSearch):
            self.mount(MenuSearch(), before="#choice")
        self.query_one(MenuSearch).focus()

    def action_open_file(self) -> None:
        """Ask for a file."""
        from cbtui.screens.open_file import OpenFileScreen

        self.app.push_screen(OpenFileScreen(self._charset))

    def action_forget(self) -> None:
        """Take the highlighted file off the list."""
        chosen = self._list.chosen
        if isinstance(chosen, RecentEntry):
            self._recents.forget(chosen)
            self._fill()

    def action_leave(self) -> None:
        """Leave the console."""
        self.app.exit()

    @property
    def _list(self) -> MenuList:
        return self.query_one(MenuList)

    @property
    def _miniature(self) -> Miniature:
        return self.query_one(Miniature)

    def _open(self, choice: Lesson | RecentEntry) -> None:
        app = console_of(self)
        if isinstance(choice, Lesson):
            app.open_lesson(choice)
            return
        from cbtui.runs.setup.own_files import CannotOpenError

        try:
            app.open_file(choice)
        except CannotOpenError as error:
            self.notify(str(error), severity="error", markup=False)
            self._describe()
