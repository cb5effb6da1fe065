"""The pane that asks which thread goes on."""

from dataclasses import dataclass
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import VerticalScroll
from textual.content import Content
from textual.message import Message
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from cbtui.keys.action import PANES, Scope
from cbtui.keys.bindings import bindings_of
from cbtui.widgets.choice.sheet import ChoiceSheet

_PANE_NUMBERS = range(1, len(PANES) + 2)
"""Those of the panes, of which the choice is the last."""


class ChoiceOptions(OptionList, inherit_bindings=False):
    """The threads that may go on; a digit, a click or enter chooses one."""

    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.CHOICE)]
    is_over = False
    """Whether nothing more can be chosen."""

    @dataclass
    class ChosenUnseen(Message):
        """An option was chosen by its number, from 0, that is not there now."""

        option: int

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer choosing only if there is a thread; once nothing more is chosen, numbers switch panes."""
        if action == "choose":
            return not self.is_over or parameters[0] not in _PANE_NUMBERS
        if action in ("cursor_up", "cursor_down", "take"):
            return self.option_count > 0
        return super().check_action(action, parameters)

    def action_choose(self, number: int) -> None:
        """Choose the option with a number, from 1, be it one to come."""
        if number <= self.option_count:
            self.highlighted = number - 1
            self.action_select()
        else:
            self.post_message(self.ChosenUnseen(number - 1))

    def action_take(self) -> None:
        """Choose the highlighted option."""
        self.action_select()


class ChoiceView(VerticalScroll, can_focus=False):
    """Shows a sheet."""

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id)
        self.sheet = ChoiceSheet("")

    def compose(self) -> ComposeResult:
        """Lay out the task, the question, the options, and why there are no others."""
        yield Static(id="task", markup=False)
        yield Static(id="news", markup=False)
        yield ChoiceOptions(markup=False)
        yield Static(id="kept", markup=False)

    def show(self, sheet: ChoiceSheet) -> None:
        """Show another sheet."""
        if sheet == self.sheet:
            return
        before, self.sheet = self.sheet, sheet
        task = self.query_one("#task", Static)
        task.display = bool(sheet.task)
        task.update(sheet.task)
        self.query_one("#news", Static).update(sheet.news)
        self.query_one(ChoiceOptions).is_over = sheet.is_over
        self.query_one("#kept", Static).update("\n".join(["Not now:", *sheet.kept] if sheet.kept else []))
        if sheet.options != before.options or sheet.news != before.news:
            options = self.query_one(ChoiceOptions)
            options.set_options(
                Option(Content.assemble((str(number), "bold $text-accent"), f" {option.text}"))
                for number, option in enumerate(sheet.options, start=1)
            )
            options.highlighted = (sheet.advised or 0) if sheet.options else None
            self.scroll_home(animate=False)
