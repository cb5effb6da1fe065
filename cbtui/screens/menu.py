"""The menu: lessons by unit, recent files, and a description of the highlighted entry."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from importlib import import_module
from time import time
from typing import TYPE_CHECKING, ClassVar

from rich.text import Text
from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.events import DescendantBlur, DescendantFocus, Key
from textual.widgets import Input, OptionList

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.keys.keymap import keymap_of
from cbtui.learning.lesson_page import short_description
from cbtui.learning.preview import CALLS, LENGTH, code_asked_about, why_no_preview
from cbtui.learning.stage import Stage, is_revealed, puzzle_note, stage_note, stage_of, stage_of_puzzle
from cbtui.looks.theme import Charset
from cbtui.runs.setup.recent import RecentEntry, RecentList
from cbtui.screens.console import console_of
from cbtui.screens.layout import Layout
from cbtui.screens.parts.previews import Previews
from cbtui.screens.sized import SizedScreen
from cbtui.terminal.textual_internals import is_being_removed
from cbtui.widgets.banner import Banner
from cbtui.widgets.description_pane import DescriptionPane, EntryDescription, of_file, of_lesson, of_puzzle
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.menu_list import (
    MenuChoice,
    MenuList,
    MenuRows,
    Taught,
    WideMenuRows,
    found_in,
    id_of,
    with_words,
)
from cbtui.widgets.menu_search import MenuSearch
from cbtui.widgets.miniature import Miniature, PreviewPicture
from lessons.catalogue import find
from lessons.lesson import Lesson
from lessons.progress import Progress
from lessons.puzzles import Puzzle, puzzles, puzzles_of

if TYPE_CHECKING:
    from cbtui.engines.session import OpenSession

_IDLE = 0.2
"""Seconds from the first picture to the import of what the next screen needs."""
_TALL = 48
"""Rows of a terminal from which on the preview has more room than the description."""
_CALLED = " and ".join(f"{at / 1e9:g}" for at in CALLS)
_TITLE = f"first {LENGTH / 1e9:g} s, {{key}} pressed at {_CALLED} s"
_ASKED = "its first question"
_NO_PICTURE = "no preview"
_WAIT = f"Stay on a lesson for a moment: its first {LENGTH / 1e9:g} s are run and drawn here."


class MenuScreen(SizedScreen[None]):
    """The first screen, to which every lesson returns."""

    SCOPE = Scope.MENU
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.MENU)]

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
        self.charset = charset
        """What the terminal can show."""
        self._now = now
        self._previews = Previews(self, open_session, charset, lambda: self._previewed)
        self._filled_with: object = None
        self._words = ""
        self._is_old_search = False
        self._latest: RecentEntry | None = None
        """What was opened last before the menu was left."""

    def compose(self) -> ComposeResult:
        """Lay out head, list, description and keys."""
        yield Banner()
        with Container(id="choice"):
            yield MenuList(id="lessons")
            yield DescriptionPane()
            yield Miniature()
        yield KeyBar(Scope.MENU, self.charset)

    def on_mount(self) -> None:
        """Focus the list, and import the lessons' screen in the background."""
        self._list.focus()
        self._latest = self._recents.latest
        self.set_timer(_IDLE, self._import_lessons)

    def on_screen_resume(self) -> None:
        """Refresh recent entries and progress, which other consoles may have changed.

        What was opened meanwhile, by whatever way, is highlighted.
        """
        self._progress.refresh()
        self._is_old_search = bool(self._words)
        if self._is_old_search:
            self._list.focus()
        if self._filled_with == self._contents:
            self._describe()
        else:
            self._fill()
        latest, self._latest = self._latest, self._recents.latest
        if self._latest is not None and self._latest != latest:
            self._list.choose(id_of(self._latest))

    def on_screen_suspend(self) -> None:
        """Abort the preview."""
        self._previews.suspend()

    async def on_unmount(self) -> None:
        """Leave no engine behind."""
        await self._previews.leave()

    def laid_out(self) -> None:
        """Show more details in the list, and a larger preview, if there is room."""
        self.set_class(self.app.size.height >= _TALL, "-tall")
        if self._filled_with != self._contents:
            self._fill()

    def _import_lessons(self) -> None:
        """Import the lessons' screen on a thread of its own, so that the first one opens at once."""
        self.run_worker(lambda: import_module("cbtui.screens.lesson"), thread=True, group="import")

    # the list

    @property
    def _contents(self) -> object:
        """Everything that the list depends on except the search."""
        return self.layout_now, self._recents.entries, self._stages

    @property
    def _stages(self) -> dict[str, Stage]:
        """The stage of each lesson and puzzle by its id."""
        opened = self._recents.lessons
        return {
            lesson.id: stage_of(lesson, self._progress.of(lesson.id), opened=lesson.id in opened)
            for lesson in self._lessons
        } | {puzzle.id: stage_of_puzzle(self._progress.of(puzzle.id)) for puzzle in puzzles()}

    def _fill(self) -> None:
        self._filled_with = self._contents
        kind = WideMenuRows if self.layout_now is Layout.GRID else MenuRows
        rows = kind(self._lessons, self._stages, self._now())
        files = filter(with_words(self._words), self._recents.files)
        self._list.show(found_in(tuple(self._taught()), self._words), files, rows)
        self._tell_troubles()
        self._describe()

    def _taught(self) -> Iterator[Taught]:
        """Every lesson and its puzzles, each with its unit."""
        for lesson in self._lessons:
            yield lesson.unit, lesson
            for puzzle in puzzles_of(lesson.id):
                yield lesson.unit, puzzle

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
        key = keymap_of(self.app).sign(Scope.LESSON, "call_service", self.charset)
        asked = self._asked_first(chosen)
        reason = why_no_preview(chosen) if isinstance(chosen, Lesson) else None
        title = _ASKED if asked else _TITLE.format(key=key) if reason is None else _NO_PICTURE
        blank = "" if self.layout_now is Layout.GRID else " "  # Textual adds it where there is a right edge
        self._miniature.border_title = Text(title + blank)
        if isinstance(chosen, Lesson) and reason is not None:
            self._previews.subjects[chosen.id] = f"It has no preview: {reason}."
        self._show_drawn()
        self._previews.schedule()
        self.query_one(KeyBar).changed()

    @property
    def _description(self) -> EntryDescription:
        chosen = self._list.chosen
        if isinstance(chosen, Lesson):
            text = short_description(chosen, self._progress.of(chosen.id))
            opened = self._recents.lessons.get(chosen.id)
            progress = self._progress.of(chosen.id)
            note = stage_note(chosen, progress, self._stages[chosen.id]).text
            described = of_lesson(chosen, text, opened, self._now(), note, keymap_of(self.app))
            return described if is_revealed(chosen, progress) else replace(described, keys=())
        if isinstance(chosen, Puzzle):
            note = puzzle_note(self._progress.of(chosen.id)).text
            return of_puzzle(chosen, find(chosen.lesson).title, note)
        if chosen is not None:
            forget = keymap_of(self.app).sign(Scope.MENU, "forget", self.charset)
            return of_file(chosen, self._now(), forget)
        return EntryDescription("Nothing found", "No lesson or recent file has all of these words.")

    @on(OptionList.OptionHighlighted)
    def _show_highlighted(self) -> None:
        self._describe()

    @on(OptionList.OptionSelected)
    def _open_selected(self, event: OptionList.OptionSelected) -> None:
        self._open(self._list.choice(str(event.option.id)))

    # the picture

    @on(Previews.Drawn)
    def _take_drawn(self, message: Previews.Drawn) -> None:
        self._previews.take(message)
        self._show_drawn()

    @property
    def _previewed(self) -> Lesson | None:
        """The highlighted lesson if its preview gives nothing away."""
        chosen = self._list.chosen
        return chosen if isinstance(chosen, Lesson) and not self._asked_first(chosen) else None

    def _asked_first(self, chosen: MenuChoice | None) -> str:
        """The first question of a lesson whose preview would give its answer away; "" without one."""
        if not isinstance(chosen, Lesson) or is_revealed(chosen, self._progress.of(chosen.id)):
            return ""
        return chosen.predictions[0].question

    def _show_drawn(self) -> None:
        lesson, asked = self._previewed, self._asked_first(self._list.chosen)
        subject = None if lesson is None else self._previews.subjects.get(lesson.id)
        self._miniature.sentence = subject if isinstance(subject, str) else asked or _WAIT
        chosen = self._list.chosen
        self._miniature.code = code_asked_about(chosen) if asked and isinstance(chosen, Lesson) else ""
        self._miniature.subject = subject if isinstance(subject, PreviewPicture) else None

    # the search

    def on_key(self, event: Key) -> None:
        """Search with a letter or digit that is no key of the menu, or that was typed as a search began.

        Keys after the one that opened a screen are for that screen; the app forwards them.
        """
        typed = event.character or ""
        if not self.is_current:
            return
        is_searching = self.query(MenuSearch) and not self._is_old_search
        if typed.isalnum() and (is_searching or event.key not in self.active_bindings):
            event.stop()
            self.action_search()
            (search := self.query_one(MenuSearch)).insert_text_at_cursor(typed)
            self._show_found(search.value)  # at once, as the next key may already be enter

    @on(Input.Changed)
    def _search_for(self, event: Input.Changed) -> None:
        if event.value != self._words and not is_being_removed(event.input):
            self._show_found(event.value)

    def _show_found(self, words: str) -> None:
        """Show the results, and open a lesson at once if only its number begins with the typed digits."""
        self._words = words
        self._fill()
        self._list.highlight_first(words)
        found = list(filter(with_words(words), self._lessons)) if words.isdecimal() else []
        if len(found) == 1 and words == str(found[0].number):
            self._list.choose(found[0].id)
            self._open(found[0])
            console_of(self).ignore_enter()

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
            case "open" | "submit":
                return self._list.chosen is not None
            case "forget":
                return isinstance(self._list.chosen, RecentEntry)
            case "end_search":
                return bool(self._words)
        return True

    def action_open(self) -> None:
        """Open the highlighted entry."""
        self._list.action_select()

    def action_tour(self) -> None:
        """Open the first lesson with a tour over it."""
        console_of(self).open_lesson(self._lessons[0], tour=True)

    def action_previous(self) -> None:
        """Highlight the one above."""
        self._list.action_cursor_up()

    def action_next(self) -> None:
        """Highlight the one below."""
        self._list.action_cursor_down()

    def action_search(self) -> None:
        """Open the search line, an empty one where the menu was left since the last search."""
        if not self.query(MenuSearch):
            self.mount(MenuSearch(), before="#choice")
        elif self._is_old_search:
            search = self.query_one(MenuSearch)
            with search.prevent(Input.Changed):
                search.clear()
            self._show_found("")
        self._is_old_search = False
        self.set_focus(self.query_one(MenuSearch))  # at once, as the next key is for it

    def action_jump(self) -> None:
        """Show a letter on each entry; typing it highlights that."""
        from cbtui.screens.parts.jumps import Jumps

        Jumps(self, self).action_jump()

    def action_open_file(self) -> None:
        """Ask for a file."""
        from cbtui.screens.windows.open_file import OpenFileScreen

        self.app.push_screen(OpenFileScreen(self.charset))

    def action_forget(self) -> None:
        """Remove the highlighted file from the list."""
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

    def _open(self, choice: MenuChoice) -> None:
        app = console_of(self)
        if self._words.isdecimal():
            self.action_end_search()
        if isinstance(choice, Lesson):
            app.open_lesson(choice)
            return
        if isinstance(choice, Puzzle):
            app.open_puzzle(choice)
            return
        from cbtui.runs.setup.own_files import CannotOpenError

        try:
            app.open_file(choice)
        except CannotOpenError as error:
            self.notify(str(error), severity="error", markup=False)
            self._describe()
