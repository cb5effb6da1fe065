"""The window that asks for the executor's number of threads."""

from textual import on
from textual.app import ComposeResult
from textual.content import Content
from textual.widgets import OptionList, Static

from cbtui.keys.action import Scope
from cbtui.looks.theme import Charset
from cbtui.runs.setup.changeable import ChangeableSetup
from cbtui.runs.setup.equivalent_code import code_of_threads
from cbtui.screens.windows.window import ChoiceScreen
from cbtui.widgets.pageable_option_list import PageableOptionList
from sim.quantities.plural import counted

MOST = 8


class ThreadsScreen(ChoiceScreen[int]):
    """Asks for a number of threads, 0 for the program's own; the result is None if the window was closed."""

    SCOPE = Scope.THREADS
    heading = "Threads"
    choices = range(MOST + 1)

    def __init__(self, about: ChangeableSetup, chosen: int | None, charset: Charset) -> None:
        super().__init__(charset)
        self._about = about
        self.highlighted = chosen or 0

    def content(self) -> ComposeResult:
        """Lay out the question."""
        yield Static("How many threads should the executor have? The run starts again.")
        own = f"  the program's own: {self._about.executor}"
        texts = [own, *(f"  {counted(number, 'thread')}" for number in range(1, MOST + 1))]
        yield PageableOptionList(*(self.option(number, text) for number, text in enumerate(texts)))
        yield Static(classes="code")

    @on(OptionList.OptionHighlighted)
    def _show_code(self, event: OptionList.OptionHighlighted) -> None:
        number = event.option_index
        code = code_of_threads(number, self._about) if number else "# as it is written"
        self.query_one(".code", Static).update(Content(code))
