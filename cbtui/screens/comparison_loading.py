"""Loads two runs for a comparison, shows the progress, and opens the comparison."""

from dataclasses import dataclass
from threading import Event
from time import monotonic
from typing import ClassVar

from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.message import Message
from textual.widgets import Static

from cbtui.engines.follow import GivenUpError
from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of
from cbtui.looks.theme import Charset
from cbtui.runs.compared_runs import (
    CannotCompareError,
    ComparedRun,
    ComparisonTerms,
    RunPair,
    RunProgress,
    load_runs,
)
from cbtui.screens.compare import CompareScreen
from cbtui.screens.sized import SizedScreen
from cbtui.widgets.key_bar import KeyBar

_QUIET_TIME = 1.0
"""Seconds before progress is shown: most runs are loaded by then."""
_PROGRESS_INTERVAL = 0.1
"""Seconds between two progress messages."""
_ENABLED_ACTIONS = {"leave", "help", "command_palette"}


class ComparisonLoadingScreen(SizedScreen[None]):
    """Loads two runs on a worker thread.

    If that fails the reason is shown, and leaving the screen ends the console with exit code 2.
    """

    SCOPE = Scope.COMPARE
    CSS_PATH = "comparison_loading.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.COMPARE)]

    @dataclass
    class Progressed(Message):
        """Loading has progressed."""

        progress: RunProgress

    @dataclass
    class Ready(Message):
        """Both runs are loaded."""

        found: RunPair

    @dataclass
    class GatheringFailed(Message):
        """The runs cannot be compared; ``sentence`` says why."""

        sentence: str

    def __init__(
        self, first: ComparedRun, second: ComparedRun, terms: ComparisonTerms, charset: Charset
    ) -> None:
        super().__init__()
        self._runs = (first, second)
        self._terms = terms
        self._charset = charset
        self._given_up = Event()
        self._began = monotonic()
        self._told = 0.0
        self._found: RunPair | None = None
        self._failed = False

    def compose(self) -> ComposeResult:
        """Lay out the sentence."""
        with Container():
            yield Static(id="progress", markup=False)
        yield KeyBar(Scope.COMPARE, self._charset)

    def on_mount(self) -> None:
        """Begin."""
        self.run_worker(self._gather, thread=True)

    def on_unmount(self) -> None:
        """Abort loading when the screen is left."""
        self._given_up.set()

    def on_screen_resume(self) -> None:
        """Open a comparison that became ready while another screen covered this one."""
        self._open()

    # on the worker's thread

    def _gather(self) -> None:
        try:
            found = load_runs(*self._runs, self._terms, self._tell, self._given_up)
        except CannotCompareError as error:
            self.post_message(self.GatheringFailed(str(error)))
        except GivenUpError:
            return
        else:
            self.post_message(self.Ready(found))

    def _tell(self, progress: RunProgress) -> None:
        now = monotonic()
        if now - self._began >= _QUIET_TIME and now - self._told >= _PROGRESS_INTERVAL:
            self._told = now
            self.post_message(self.Progressed(progress))

    # on the screen's

    @on(Progressed)
    def _show_progress(self, message: Progressed) -> None:
        self.query_one("#progress", Static).update(message.progress.text)

    @on(Ready)
    def _take(self, message: Ready) -> None:
        self._found = message.found
        self._open()

    @on(GatheringFailed)
    def _show_failure(self, message: GatheringFailed) -> None:
        self._failed = True
        self.query_one("#progress", Static).update(message.sentence)

    def _open(self) -> None:
        found = self._found
        if found is not None and self.is_active:
            bounds = None if self._terms.start == 0 and self._terms.end is None else found.window
            self.app.switch_screen(CompareScreen(found.first, found.second, self._charset, bounds))

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer only leaving, help and palette while loading."""
        return action in _ENABLED_ACTIONS

    def action_leave(self) -> None:
        """Abort the comparison."""
        self._given_up.set()
        if self._failed:
            self.app.exit(return_code=2)
        else:
            self.dismiss()
