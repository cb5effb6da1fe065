"""The window that asks for a callback's group."""

from textual import on
from textual.app import ComposeResult
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from cbtui.keys.action import Scope
from cbtui.keys.keymap import keymap_of
from cbtui.looks.theme import Charset
from cbtui.runs.setup.changeable import ChangeableCallback
from cbtui.runs.setup.changes import GROUP_CHOICES
from cbtui.runs.setup.equivalent_code import code_of_group
from cbtui.screens.window import WindowScreen
from cbtui.widgets.pageable_option_list import PageableOptionList

UNCHANGED = ""
"""The result for the program's own group."""

_MEANINGS = {
    "own": "an exclusive group that nobody else can hold",
    "shared": "one exclusive group for all that you put there",
    "reentrant": "one reentrant group for all that you put there",
    "default": "the node's default group, which is exclusive",
    UNCHANGED: "the group that the program says",
}


class GroupScreen(WindowScreen[str]):
    """Its result is one of ``GROUP_CHOICES``, or ``UNCHANGED``; None if it was closed."""

    SCOPE = Scope.GROUP
    heading = "Callback group"

    def __init__(self, callback: ChangeableCallback, chosen: str | None, charset: Charset) -> None:
        super().__init__(charset)
        self._callback = callback
        self._choices = (*GROUP_CHOICES, UNCHANGED)
        self._chosen = chosen or UNCHANGED

    def content(self) -> ComposeResult:
        """Lay out the question."""
        now = f"In this run: group {self._callback.group}."
        question = f"Which callback group does {self._callback.name} get?"
        yield Static(f"{question} The run starts again.\n{now}", markup=False)
        yield PageableOptionList(*(self._option(choice) for choice in self._choices))
        yield Static(classes="code")

    def on_mount(self) -> None:
        """Highlight the current choice."""
        self.query_one(OptionList).highlighted = self._choices.index(self._chosen)

    @on(OptionList.OptionHighlighted)
    def _show_code(self, event: OptionList.OptionHighlighted) -> None:
        choice = self._choices[event.option_index]
        if choice == UNCHANGED:
            code = ["# as it is written"]
        else:
            code = code_of_group(self._callback.name, self._callback.kind, choice)
        self.query_one(".code", Static).update(Content("\n".join(code)))

    @on(OptionList.OptionSelected)
    def _take(self, event: OptionList.OptionSelected) -> None:
        self.dismiss(self._choices[event.option_index])

    def action_choose(self, choice: str) -> None:
        """Take a group."""
        self.dismiss(choice)

    def _option(self, choice: str) -> Option:
        name = choice or "the program's"
        key = (self._key(choice), "bold $text-accent")
        return Option(Content.assemble(key, f"  {name:<14} ", (_MEANINGS[choice], "$text-muted")))

    def _key(self, choice: str) -> str:
        """The key that takes a group."""
        return keymap_of(self.app).sign(Scope.GROUP, f"choose({choice!r})", self._charset)
