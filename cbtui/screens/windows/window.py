"""Windows: modal screens with a frame and the keys of their scope; some list choices or take a line."""

from collections.abc import Sequence
from typing import Any, ClassVar

from textual import on
from textual.app import ComposeResult
from textual.containers import Container, VerticalScroll
from textual.content import Content
from textual.screen import ModalScreen
from textual.types import CSSPathType
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from cbtui.keys.action import Scope
from cbtui.keys.bindings import bindings_of, of_the_app
from cbtui.keys.keymap import keymap_of
from cbtui.looks.theme import Charset
from cbtui.screens.sized import Result, SizedScreen
from cbtui.widgets.key_bar import KeyBar


class WindowScreen(ModalScreen[Result], SizedScreen[Result]):
    """A framed window with ``content`` and the keys of ``SCOPE``; closing it gives None."""

    SCOPE: ClassVar[Scope]
    heading: str | Content = ""
    """The text in the frame."""
    CSS_PATH: ClassVar[CSSPathType | None] = "window.tcss"
    HAS_HELP: ClassVar[bool] = True
    """Whether the key for help works here, too."""

    def __init_subclass__(cls, **options: Any) -> None:
        if "SCOPE" in vars(cls):
            cls.BINDINGS = [*bindings_of(cls.SCOPE), *([of_the_app("help")] if cls.HAS_HELP else [])]
        super().__init_subclass__(**options)

    def __init__(self, charset: Charset) -> None:
        super().__init__()
        self._charset = charset

    def compose(self) -> ComposeResult:
        """Lay out the frame."""
        with Container(classes="window") as window:
            window.border_title = self.heading
            yield from self.content()
            yield KeyBar(self.SCOPE, self._charset)

    def content(self) -> ComposeResult:
        """Yield what is in the frame, above the keys."""
        raise NotImplementedError

    def option(self, choice: object, *text: str | tuple[str, str]) -> Option:
        """Return an option of a list: the key of the action that chooses it, and a text with styles."""
        key = keymap_of(self.app).sign(self.SCOPE, f"choose({choice!r})", self._charset)
        return Option(Content.assemble((key, "bold $text-accent"), *text))

    def action_previous(self) -> None:
        """Highlight the option above."""
        self.query_one(OptionList).action_cursor_up()

    def action_next(self) -> None:
        """Highlight the option below."""
        self.query_one(OptionList).action_cursor_down()

    def action_page_up(self) -> None:
        """Scroll the text up."""
        self.query_one(VerticalScroll).scroll_page_up(animate=False)

    def action_page_down(self) -> None:
        """Scroll the text down."""
        self.query_one(VerticalScroll).scroll_page_down(animate=False)

    def action_close(self) -> None:
        """Close the window without a result."""
        self.dismiss(None)


class PlainOptionList(OptionList, inherit_bindings=False):
    """A list whose highlight is moved by the window's keys and by clicks."""


class ChoiceScreen(WindowScreen[Result]):
    """A window with a list of ``choices``; its result is the one that is clicked, confirmed or typed."""

    choices: Sequence[Result]
    highlighted: Result
    """The choice that is highlighted first."""

    def on_mount(self) -> None:
        """Highlight the first choice."""
        self.query_one(OptionList).highlighted = self.choices.index(self.highlighted)

    @on(OptionList.OptionSelected)
    def _choose_selected(self, event: OptionList.OptionSelected) -> None:
        self.action_choose(self.choices[event.option_index])

    def action_choose(self, choice: Result) -> None:
        """Close the window with a choice."""
        self.dismiss(choice)
