"""The window that asks for a callback's group."""

from textual import on
from textual.app import ComposeResult
from textual.content import Content
from textual.widgets import OptionList, Static

from cbtui.keys.action import Scope
from cbtui.looks.theme import Charset
from cbtui.runs.setup.changeable import ChangeableCallback
from cbtui.runs.setup.changes import GROUP_CHOICES
from cbtui.runs.setup.equivalent_code import code_of_group
from cbtui.screens.windows.window import WindowScreen
from cbtui.widgets.pageable_option_list import PageableOptionList

UNCHANGED = ""
"""The result for the program's own group."""
_OWN = "the program's"

_MEANINGS = {
    "own": "an exclusive group of its own",
    "shared": "one exclusive group for all you put there",
    "reentrant": "one reentrant group for all you put there",
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
        question = f"Which callback group should {self._callback.name} have?"
        yield Static(f"{question} The run starts again.\n{now}", markup=False)
        yield PageableOptionList(
            *(
                self.option(choice, f"  {choice or _OWN:<14} ", (_MEANINGS[choice], "$text-muted"))
                for choice in self._choices
            )
        )
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
