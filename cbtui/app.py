"""The application: opens the menu and the lessons, and knows what the terminal can show."""

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from time import time
from typing import TYPE_CHECKING, Any, ClassVar

from textual.app import App, SystemCommand
from textual.binding import BindingType
from textual.events import Event, Key
from textual.filter import LineFilter
from textual.notifications import Notify
from textual.screen import Screen
from textual.theme import ThemeProvider
from textual.types import CSSPathType
from textual.widgets import Input

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.keys.keymap import Keymap
from cbtui.learning.outcome import observe_engine
from cbtui.looks.colour_themes import STANDARD, THEMES
from cbtui.looks.grey_filter import GreyFilter
from cbtui.looks.theme import Charset
from cbtui.runs.setup.recent import RecentEntry, RecentKind, RecentList
from cbtui.screens.menu import MenuScreen
from cbtui.terminal.ending import EndingApp
from cbtui.terminal.textual_internals import clear_hints, clear_read, make_room_for
from cbtui.text.ascii_filter import AsciiFilter
from cbtui.text.harmless_filter import HarmlessFilter
from cbtui.widgets.key_bar import say_at_once
from lessons.catalogue import find, lessons
from lessons.lesson import Lesson
from lessons.progress import Progress
from lessons.puzzles import puzzles

if TYPE_CHECKING:
    from textual.command import Provider
    from textual.driver import Driver

    from cbtui.engines.session import Deliver, Ended, EngineSession, OpenSession
    from cbtui.learning.outcome import Observe
    from cbtui.runs.compared_runs import ComparedRun, ComparisonTerms
    from cbtui.runs.setup.changes import Changes
    from cbtui.runs.setup.shown_program import ShownProgram
    from lessons.puzzles import Puzzle
    from sim.engine.setup import RealRos, RunSetup
    from sim.recording import Recording


def _actions_provider() -> "type[Provider]":
    from cbtui.keys.command_palette import ActionsProvider  # imported when the palette opens

    return ActionsProvider


def _preview_session(setup: "RunSetup", deliver: "Deliver", ended: "Ended") -> "EngineSession":
    from cbtui.engines.session import ProcessSession  # imported when the menu draws a lesson

    return ProcessSession(setup, deliver, ended)


def _engine_session(setup: "RunSetup", deliver: "Deliver", ended: "Ended") -> "EngineSession":
    from cbtui.engines.listening import ListeningSession  # imported when a lesson opens

    return ListeningSession(setup, deliver, ended)


class CbtuiApp(EndingApp):
    """The console.

    ``start_lesson`` is the id of a lesson to open at once, ``start_exercise`` the id of one whose exercise is
    opened, ``start_puzzle`` a puzzle, ``start_file`` a program file with its arguments and clock,
    ``start_changes`` the changes of either, ``start_program`` any other program, ``start_recording`` a
    recording, ``start_comparison`` two runs to compare. ``theme`` is the name of a colour theme,
    ``keys`` the keys in force, and ``complaints`` are sentences to begin with.
    ``open_session`` starts engines in place of the real ones, ``observe`` runs one to its end beside the
    screen.
    """

    TITLE = "cbtui"
    CSS_PATH: ClassVar[CSSPathType | None] = [
        # Textual does not read the CSS_PATH of the first screen.
        Path(__file__).with_name("app.tcss"),
        Path(__file__).parent / "screens" / "menu.tcss",
    ]
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.EVERYWHERE)]
    COMMANDS: ClassVar[set["type[Provider] | Callable[[], type[Provider]]"]] = App.COMMANDS | {
        _actions_provider
    }

    def __init__(
        self,
        charset: str = Charset.BRAILLE,
        start_lesson: str | None = None,
        start_exercise: str | None = None,
        start_puzzle: "Puzzle | None" = None,
        start_file: tuple[Path, Sequence[str], str] | None = None,
        start_changes: "Changes | None" = None,
        start_program: "ShownProgram | None" = None,
        start_recording: "Recording | None" = None,
        start_comparison: "tuple[ComparedRun, ComparedRun, ComparisonTerms] | None" = None,
        theme: str = STANDARD,
        keys: Keymap | None = None,
        complaints: Sequence[str] = (),
        open_session: "OpenSession | None" = None,
        observe: "Observe" = observe_engine,
    ) -> None:
        super().__init__()
        self.charset = Charset(charset)
        self._start_lesson = start_lesson
        self._start_exercise = start_exercise
        self._start_puzzle = start_puzzle
        self._start_file = start_file
        self._start_changes = start_changes
        self._start_program = start_program
        self._start_recording = start_recording
        self._start_comparison = start_comparison
        self._complaints = complaints
        self._open_session = open_session or _engine_session
        self._open_preview = open_session or _preview_session
        self._recents = RecentList()
        self.progress = Progress()
        """How far the learner has come."""
        self.observe = observe
        for each in THEMES:
            self.register_theme(each)
        self.theme = theme
        self.keys = keys or Keymap()
        self.set_keymap(self.keys.for_textual())
        self._ascii = AsciiFilter()
        self._harmless = HarmlessFilter()
        self._greys = [GreyFilter()] if self.no_color else []

    def search_themes(self) -> None:
        """Open a palette of the themes."""
        from cbtui.terminal.textual_internals import SafeCommandPalette

        self.push_screen(SafeCommandPalette(providers=[ThemeProvider], placeholder="Search for themes…"))

    def get_driver_class(self) -> "type[Driver]":
        """Return the driver that reads keys and draws."""
        driver = super().get_driver_class()
        if driver.__name__ == "LinuxDriver":
            from cbtui.terminal.driver import TerminalDriver

            return TerminalDriver
        return driver

    def action_command_palette(self) -> None:
        """Open the command palette, unless it is open."""
        from cbtui.terminal.textual_internals import SafeCommandPalette

        if not isinstance(self.screen, SafeCommandPalette):
            self.push_screen(SafeCommandPalette(id="--command-palette"))

    def on_notify(self, event: Notify) -> None:
        """Show a repeated sentence once, from now on for its whole time, and at most one before it."""
        make_room_for(self, event.notification.message)

    def tell_saved(self, sentence: str) -> None:
        """Report what was saved as a screen closed: in a notification, and on the terminal at exit."""
        self.saved.append(sentence)
        self.notify(sentence, markup=False)

    def get_default_screen(self) -> Screen[Any]:
        """Begin with the menu."""
        return MenuScreen(lessons(), self._recents, self.progress, self._open_preview, self.charset)

    def on_mount(self) -> None:
        """Open what the command line named."""
        self.app_resume_signal.subscribe(self, lambda _: self.refresh(layout=True))  # the terminal is blank
        for sentence in self._complaints:
            self.notify(sentence, severity="warning", timeout=12, markup=False)
        if self._start_lesson is not None:
            self.open_lesson(find(self._start_lesson), self._start_changes)
        elif self._start_exercise is not None:
            changes = self._start_changes
            self.open_exercise(find(self._start_exercise), None if changes is None else changes.real)
        elif self._start_puzzle is not None:
            self.open_puzzle(self._start_puzzle)
        elif self._start_file is not None:
            path, arguments, clock = self._start_file
            self._run_file(path, arguments, clock, self._start_changes)
        elif self._start_program is not None:
            self._show_program(self._start_program, None)
        elif self._start_recording is not None:
            self._show_recording(self._start_recording)
        elif self._start_comparison is not None:
            from cbtui.screens.comparison_loading import ComparisonLoadingScreen

            self.push_screen(ComparisonLoadingScreen(*self._start_comparison, self.charset))

    def open_lesson(
        self, lesson: Lesson, changes: "Changes | None" = None, *, tour: bool = False, over: bool = False
    ) -> None:
        """Run a lesson on screen, in place of another that may be open, as it is or with changes.

        With ``tour`` it is shown round first; with ``over`` the screen below stays.
        """
        say_at_once(self.screen, f"opening lesson {lesson.number}: {lesson.title} …")
        from cbtui.runs.setup.shown_program import of_lesson

        self._show_program(of_lesson(lesson, lessons()), changes, tour=tour, over=over)
        self._remember(RecentKind.LESSON, lesson.id)

    def open_exercise(self, lesson: Lesson, real: "RealRos | None" = None) -> None:
        """Run and check the exercise file in the current folder; created from the starter if missing.

        With ``real`` it runs on that ROS 2.
        """
        say_at_once(self.screen, "opening the exercise …")
        from cbtui.learning.exercise_files import CannotPlaceError, own_file
        from cbtui.screens.exercise import ExerciseScreen
        from lessons.lesson import BadLesson

        try:
            file = own_file(lesson, Path().absolute())
            screen = ExerciseScreen(lesson, lessons(), file.path, self._open_session, self.charset, real)
        except FileNotFoundError:
            self.notify("The current folder is gone; start the console in another one.", severity="error")
            return
        except (CannotPlaceError, BadLesson) as error:
            self.notify(str(error), severity="error", markup=False)
            return
        self._show_over_menu(screen)
        self.notify(file.sentence, markup=False)

    def open_puzzle(self, puzzle: "Puzzle") -> None:
        """Let the learner schedule the threads of a puzzle."""
        say_at_once(self.screen, f"opening the puzzle: {puzzle.title} …")
        from cbtui.runs.setup.shown_program import of_puzzle
        from cbtui.screens.choosing import ChoosingScreen

        self._show_over_menu(ChoosingScreen(of_puzzle(puzzle), self._open_session, self.charset, puzzle))

    def open_file(self, entry: RecentEntry) -> None:
        """Run a program or show a recording, in place of the window that asked for it.

        Raises:
            CannotOpenError: it is not there, or nothing that can be opened.
        """
        from cbtui.runs.setup.own_files import check, read_recording

        path = Path(entry.what)
        say_at_once(self.screen, f"opening {path.name} …")
        check(path)
        if entry.kind is RecentKind.RECORDING:
            self._show_recording(read_recording(path))
        else:
            self._run_file(path, entry.arguments, entry.clock, None)

    def _run_file(self, path: Path, arguments: Sequence[str], clock: str, changes: "Changes | None") -> None:
        from cbtui.runs.setup.shown_program import of_file

        self._show_program(of_file(path, arguments, clock), changes)
        self._remember(RecentKind.PROGRAM, str(path.absolute()), tuple(arguments), clock)

    def _show_recording(self, recording: "Recording") -> None:
        from cbtui.screens.replay import ReplayScreen

        self._show_over_menu(ReplayScreen(recording, self.charset))
        self._remember(RecentKind.RECORDING, str(recording.path.absolute()))

    def _remember(
        self, kind: RecentKind, what: str, arguments: tuple[str, ...] = (), clock: str = "real"
    ) -> None:
        self._recents.note(RecentEntry(kind, what, int(time()), arguments, clock))
        for sentence in self._recents.troubles():
            self.notify(sentence, severity="warning", markup=False)

    def _show_program(
        self,
        subject: "ShownProgram",
        changes: "Changes | None",
        *,
        tour: bool = False,
        over: bool = False,
    ) -> None:
        from cbtui.screens.lesson import LessonScreen  # imported late: the menu must appear first

        screen = LessonScreen(subject, self._open_session, self.charset, changes, tour=tour)
        if over:
            self.push_screen(screen)
        else:
            self._show_over_menu(screen)

    def _show_over_menu(self, screen: Screen[Any]) -> None:
        """Show a screen over the menu, in place of a lesson or a question for a file and what they said."""
        if getattr(self.screen, "SCOPE", None) in (Scope.LESSON, Scope.OPENING):
            self.clear_notifications()
            self.switch_screen(screen)
        else:
            self.push_screen(screen)

    async def on_event(self, event: Event) -> None:
        """Handle an event; a key takes away sentences over the screen that were read, escape all of them."""
        if isinstance(event, Key):
            if event.key == "escape":
                self.clear_notifications()
            else:
                clear_read(self)
        await super().on_event(event)

    def on_key(self, event: Key) -> None:
        """Say that a letter, a digit or tab does nothing if it reaches the app and is no key in force."""
        pressed = "tab" if event.key == "tab" else event.character or ""
        is_typed = isinstance(self.focused, Input)
        if pressed.isalnum() and not is_typed and event.key not in self.screen.active_bindings:
            helps = self.keys.sign(Scope.EVERYWHERE, "help", self.charset)
            clear_hints(self)
            self.notify(f"{pressed} does nothing here; {helps} lists the keys.", markup=False)

    def action_help(self) -> None:
        """Show every key."""
        from cbtui.screens.windows.help import HelpScreen

        if not isinstance(self.screen, HelpScreen):
            clear_hints(self)
            self.push_screen(HelpScreen(self.charset))

    def get_system_commands(self, screen: Screen[Any]) -> Iterable[SystemCommand]:
        """Offer what the palette has beside the registry's actions."""
        yield SystemCommand("Theme", "Choose another colour theme, dark or light", self.action_change_theme)
        for lesson in lessons():
            title = f"Open lesson {lesson.number:>2}: {lesson.title}"  # the palette sorts by text
            yield SystemCommand(title, lesson.executor, partial(self.open_lesson, lesson))
        for puzzle in puzzles():
            yield SystemCommand(
                f"Open puzzle: {puzzle.title}", puzzle.task, partial(self.open_puzzle, puzzle)
            )
        yield SystemCommand("Screenshot", "Save a picture of this screen (SVG)", self.deliver_screenshot)

    def get_line_filters(self) -> Sequence[LineFilter]:
        """Return the filters that every line passes on its way to the terminal."""
        filters = [*self._greys, *super().get_line_filters(), self._harmless]
        return [*filters, self._ascii] if self.charset is Charset.ASCII else filters
