"""The window that asks for predictions before a run."""

from collections.abc import Callable
from enum import Enum, auto

from textual import on
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.widgets import OptionList, Static

from cbtui.keys.action import Scope
from cbtui.keys.keymap import keymap_of
from cbtui.keys.named_keys import with_keys_in_force
from cbtui.looks.theme import Charset
from cbtui.screens.windows.window import PlainOptionList, WindowScreen
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.prose import Prose
from lessons.description import Prediction

_FINAL = "your answer is final"


class PredictionExit(Enum):
    """How the window was left."""

    ON = auto()
    """Continue to the run, with or without answers."""
    BACK = auto()


class PredictionScreen(WindowScreen[PredictionExit]):
    """Asks the questions that are not answered yet, one after the other.

    ``answered`` is the number of answered questions; ``answer`` gets the indices of a question and its answer
    when the user confirms it. Nothing is highlighted at first, so that no answer is given by mistake.
    """

    SCOPE = Scope.PREDICTION

    def __init__(
        self,
        introduction: str,
        predictions: tuple[Prediction, ...],
        answered: int,
        answer: Callable[[int, int], None],
        charset: Charset,
    ) -> None:
        super().__init__(charset)
        self._introduction = introduction
        self._predictions = predictions
        self._place = answered
        self._answer = answer

    def content(self) -> ComposeResult:
        """Lay out what the lesson is about, the question, and the answers to choose from."""
        with VerticalScroll(can_focus=False):
            yield Prose(with_keys_in_force(self._introduction, keymap_of(self.app)))
        yield Static(classes="question", markup=False)
        yield PlainOptionList()

    def on_mount(self) -> None:
        """Ask the first question."""
        self._ask()

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer the numbers of existing answers, and ``take`` once one is highlighted."""
        match action:
            case "choose":
                place = parameters[0]
                return isinstance(place, int) and place <= len(self._prediction.answers)
            case "take" | "no_take":
                has_choice = self.is_mounted and self.query_one(OptionList).highlighted is not None
                return has_choice is (action == "take")
            case "page_up" | "page_down":
                return self.is_mounted and self.query_one(VerticalScroll).max_scroll_y > 0
        return True

    @property
    def _prediction(self) -> Prediction:
        return self._predictions[self._place]

    def _ask(self) -> None:
        several = len(self._predictions) > 1
        number = f" ({self._place + 1} of {len(self._predictions)})" if several else ""
        window = self.query_one(".window")
        window.border_title, window.border_subtitle = f"What do you expect?{number}", _FINAL
        self.query_one(".question", Static).update(self._prediction.question)
        answers = self.query_one(OptionList)
        answers.set_options(
            self.option(number, f"  {answer}")
            for number, answer in enumerate(self._prediction.answers, start=1)
        )
        answers.highlighted = None
        answers.focus()
        self.call_after_refresh(self.query_one(KeyBar).changed)

    @on(OptionList.OptionHighlighted)
    def _show_keys(self) -> None:
        self.query_one(".window").border_subtitle = _FINAL
        self.query_one(KeyBar).changed()

    @on(OptionList.OptionSelected)
    def _highlight_clicked(self, event: OptionList.OptionSelected) -> None:
        """Highlight a clicked answer without giving it."""
        self.query_one(OptionList).highlighted = event.option_index

    def action_choose(self, number: int) -> None:
        """Highlight an answer."""
        self.query_one(OptionList).highlighted = number - 1

    def action_take(self) -> None:
        """Take the highlighted answer, for good, and ask the next question."""
        chosen = self.query_one(OptionList).highlighted
        if chosen is None:
            return
        self._answer(self._place, chosen)
        if self._place + 1 == len(self._predictions):
            self.dismiss(PredictionExit.ON)
        else:
            self._place += 1
            self._ask()

    def action_no_take(self) -> None:
        """Say that an answer has to be chosen first."""
        numbers = f"1 to {len(self._prediction.answers)}"
        self.query_one(".window").border_subtitle = f"choose an answer first: {numbers}"

    def action_skip(self) -> None:
        """Go on without predicting."""
        self.dismiss(PredictionExit.ON)

    def action_close(self) -> None:
        """Go back to where the person came from."""
        self.dismiss(PredictionExit.BACK)
