"""The application: opens the menu and the lessons, and knows what the terminal can show."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from textual.app import App, SystemCommand
from textual.binding import BindingType
from textual.filter import LineFilter
from textual.screen import Screen
from textual.types import CSSPathType

from cbtui.actions import Scope, bindings_of
from cbtui.ascii_filter import AsciiFilter
from cbtui.screens.menu import MenuScreen
from cbtui.theme import Charset
from lessons.catalogue import find, lessons
from lessons.lesson import Lesson

if TYPE_CHECKING:
    from textual.command import Provider

    from cbtui.live_run import Deliver, Ended, OpenSession, Session
    from cbtui.subject import Subject
    from sim.engine.setup import RunSetup
    from sim.trace.recording import Recording


def _actions_provider() -> "type[Provider]":
    from cbtui.palette import ActionsProvider  # imported when the palette opens

    return ActionsProvider


def _engine_session(setup: "RunSetup", deliver: "Deliver", ended: "Ended") -> "Session":
    from cbtui.listening import ListeningSession  # imported when a lesson opens

    return ListeningSession(setup, deliver, ended)


class CbtuiApp(App[None]):
    """The console.

    ``start_lesson`` is the id of a lesson to open at once, ``start_file`` a program file, its arguments and
    its clock, ``start_recording`` a recording to show; ``open_session`` starts engines, the real ones unless
    a test says otherwise.
    """

    TITLE = "cbtui"
    CSS_PATH: ClassVar[CSSPathType | None] = [
        # The first screen's own CSS_PATH is not read by Textual.
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
        start_file: tuple[Path, Sequence[str], str] | None = None,
        start_recording: "Recording | None" = None,
        open_session: "OpenSession" = _engine_session,
    ) -> None:
        super().__init__()
        self.charset = Charset(charset)
        self._start_lesson = start_lesson
        self._start_file = start_file
        self._start_recording = start_recording
        self._open_session = open_session
        self._ascii = AsciiFilter()

    def get_default_screen(self) -> Screen[Any]:
        """Begin with the menu."""
        return MenuScreen(lessons(), self.charset)

    def on_mount(self) -> None:
        """Open the lesson that was asked for."""
        if self._start_lesson is not None:
            self.open_lesson(find(self._start_lesson))
        elif self._start_file is not None:
            from cbtui.subject import of_file

            self._show(of_file(*self._start_file))
        elif self._start_recording is not None:
            from cbtui.screens.replay import ReplayScreen

            self.push_screen(ReplayScreen(self._start_recording, self.charset))

    def open_lesson(self, lesson: Lesson) -> None:
        """Run a lesson on screen, in place of another that may be open."""
        from cbtui.subject import of_lesson

        self._show(of_lesson(lesson, lessons()))

    def _show(self, subject: "Subject") -> None:
        from cbtui.screens.lesson import LessonScreen  # the menu has to be there before all that is needed

        screen = LessonScreen(subject, self._open_session, self.charset)
        if isinstance(self.screen, LessonScreen):
            self.switch_screen(screen)
        else:
            self.push_screen(screen)

    def action_help(self) -> None:
        """Show every key."""
        from cbtui.screens.help import HelpScreen

        if not isinstance(self.screen, HelpScreen):
            self.push_screen(HelpScreen(self.charset))

    def get_system_commands(self, screen: Screen[Any]) -> Iterable[SystemCommand]:
        """Offer what the palette has beside the registry's actions."""
        yield SystemCommand("Theme", "Choose another colour theme, dark or light", self.action_change_theme)
        yield SystemCommand("Screenshot", "Save a picture of this screen (SVG)", self.deliver_screenshot)

    def get_line_filters(self) -> Sequence[LineFilter]:
        """Return what every line passes on its way to the terminal."""
        filters = super().get_line_filters()
        return [*filters, self._ascii] if self.charset is Charset.ASCII else filters
