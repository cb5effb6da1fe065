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
from cbtui.screens.windows.window import ChoiceScreen
from cbtui.widgets.pageable_option_list import PageableOptionList

UNCHANGED = ""
"""The result for the program's own group."""
_OWN = "the program's"

_MEANINGS = {
    "own": "an exclusive group of its own",
    "shared": "one exclusive group for all you put there",
    "reentrant": "one reentrant group for all you put there",
    "default": "the node's default group, which is exclusive",
    UNCHANGED: "the group that the program gives it",
}


class GroupScreen(ChoiceScreen[str]):
    """Asks for one of ``GROUP_CHOICES``, or ``UNCHANGED``; the result is None if the window was closed."""

    SCOPE = Scope.GROUP
    heading = "Callback group"
    choices = (*GROUP_CHOICES, UNCHANGED)

    def __init__(self, callback: ChangeableCallback, chosen: str | None, charset: Charset) -> None:
        super().__init__(charset)
        self._callback = callback
        self.highlighted = chosen or UNCHANGED

    def content(self) -> ComposeResult:
        """Lay out the question."""
        now = f"In this run: group {self._callback.group}."
        question = f"Which callback group should {self._callback.title} have?"
        yield Static(f"{question} The run starts again.\n{now}", markup=False)
        yield PageableOptionList(
            *(
                self.option(choice, f"  {choice or _OWN:<14} ", (_MEANINGS[choice], "$text-muted"))
                for choice in self.choices
            )
        )
        yield Static(classes="code")

    @on(OptionList.OptionHighlighted)
    def _show_code(self, event: OptionList.OptionHighlighted) -> None:
        choice = self.choices[event.option_index]
        if choice == UNCHANGED:
            code = ["# as it is written"]
        else:
            code = code_of_group(self._callback.name, self._callback.kind, self._callback.maker, choice)
        self.query_one(".code", Static).update(Content("\n".join(code)))
