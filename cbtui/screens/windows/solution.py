"""The windows of an exercise's solution: the confirmation, and the solution as a difference or whole."""

from collections.abc import Iterator
from difflib import unified_diff

from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import Static

from cbtui.keys.action import Scope
from cbtui.learning.exercise_files import before_the_solution
from cbtui.looks.theme import Charset
from cbtui.screens.windows.window import WindowScreen
from cbtui.text.cells import visible
from cbtui.widgets.code.highlight import TokenKind, highlight
from cbtui.widgets.key_bar import KeyBar

_STYLES = {
    TokenKind.PLAIN: "$text",
    TokenKind.KEYWORD: "$text-accent",
    TokenKind.NAME: "bold $text-primary",
    TokenKind.BUILTIN: "$text-primary",
    TokenKind.STRING: "$text-success",
    TokenKind.NUMBER: "$text-warning",
    TokenKind.COMMENT: "italic $text-muted",
}
_CHANGED = {"+": "$text-success", "-": "$text-error", "@": "$text-muted"}


class SolutionScreen(WindowScreen[None]):
    """Shows a solution as a difference to the file ``begun`` (name and text), or whole."""

    SCOPE = Scope.SOLUTION

    def __init__(self, begun: tuple[str, str], solution: tuple[str, str], charset: Charset) -> None:
        super().__init__(charset)
        self._begun = begun
        self._solution = solution
        self._whole = False

    def content(self) -> ComposeResult:
        """Lay out the text."""
        with VerticalScroll():
            yield Static(classes="text", markup=False)

    def on_mount(self) -> None:
        """Begin with what differs."""
        self._show()

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the other view."""
        match action:
            case "show_whole":
                return not self._whole
            case "show_difference":
                return self._whole
        return True

    def action_show_whole(self) -> None:
        """Show the whole solution."""
        self._whole = True
        self._show()

    def action_show_difference(self) -> None:
        """Show what differs."""
        self._whole = False
        self._show()

    def _show(self) -> None:
        name, text = self._solution
        title = f"The solution: {name}" if self._whole else f"From {self._begun[0]} to the solution"
        self.query_one(".window").border_title = Content(title)
        shown = code_of(text, self._charset) if self._whole else difference(*self._begun, text, self._charset)
        self.query_one(".text", Static).update(shown)
        self.query_one(VerticalScroll).scroll_home(animate=False)
        self.query_one(KeyBar).changed()


class ConfirmSolutionScreen(WindowScreen[bool]):
    """Asks for a confirmation; its result is True to show the solution."""

    SCOPE = Scope.ASKING
    heading = "Look at the solution?"

    def __init__(self, hints_left: int, charset: Charset) -> None:
        super().__init__(charset)
        self._hints_left = hints_left

    def content(self) -> ComposeResult:
        """Lay out the question."""
        yield Static(before_the_solution(self._hints_left), markup=False)

    def action_take(self) -> None:
        """Look."""
        self.dismiss(True)


def code_of(source: str, charset: Charset) -> Content:
    """Return Python source with its words coloured."""
    lines = (
        Content.assemble(*((visible(word.text, charset), _STYLES[word.kind]) for word in line))
        for line in highlight(source)
    )
    return Content("\n").join(lines)


def difference(name: str, begun: str, solution: str, charset: Charset) -> Content:
    """Return how to get from a file to the solution: lines that go begin with ``-``, new ones with ``+``."""
    lines = list(_changed(begun, solution, charset))
    return Content("\n").join(lines) if lines else Content(f"{name} is the solution, word for word.")


def _changed(begun: str, solution: str, charset: Charset) -> Iterator[Content]:
    lines = unified_diff(begun.splitlines(), solution.splitlines(), lineterm="")
    for line in list(lines)[2:]:
        yield Content.styled(visible(line.expandtabs(4), charset), _CHANGED.get(line[0], "$text"))
