"""The window that asks for the executor's number of threads."""

from textual import on
from textual.app import ComposeResult
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from cbtui.keys.action import Scope
from cbtui.keys.keymap import keymap_of
from cbtui.looks.theme import Charset
from cbtui.runs.setup.changeable import ChangeableSetup
from cbtui.runs.setup.equivalent_code import code_of_threads
from cbtui.screens.window import WindowScreen
from cbtui.widgets.pageable_option_list import PageableOptionList
from sim.plural import counted

MOST = 8


class ThreadsScreen(WindowScreen[int]):
    """Its result is the number, or 0 for the program's own; None if it was closed."""

    SCOPE = Scope.THREADS
    heading = "Threads"

    def __init__(self, about: ChangeableSetup, chosen: int | None, charset: Charset) -> None:
        super().__init__(charset)
        self._about = about
        self._chosen = chosen or 0

    def content(self) -> ComposeResult:
        """Lay out the question."""
        yield Static("How many threads does the executor get?\nThe run starts again with them.")
        yield PageableOptionList(*self._options())
        yield Static(classes="code")

    def on_mount(self) -> None:
        """Highlight the current choice."""
        self.query_one(OptionList).highlighted = self._chosen

    @on(OptionList.OptionHighlighted)
    def _show_code(self, event: OptionList.OptionHighlighted) -> None:
        number = event.option_index
        code = code_of_threads(number, self._about) if number else "# as it is written"
        self.query_one(".code", Static).update(Content(code))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Take the number that was clicked or confirmed."""
        self.dismiss(event.option_index)

    def action_choose(self, number: int) -> None:
        """Take a number."""
        self.dismiss(number)

    def _options(self) -> list[Option]:
        own = f"  the program's own: {self._about.executor}"
        texts = [own, *(f"  {counted(number, 'thread')}" for number in range(1, MOST + 1))]
        return [
            Option(Content.assemble((self._key(number), "bold $text-accent"), text))
            for number, text in enumerate(texts)
        ]

    def _key(self, number: int) -> str:
        """The key that takes a number."""
        return keymap_of(self.app).sign(Scope.THREADS, f"choose({number})", self._charset)
