"""The pane that asks which thread goes on: who may, and why the others may not."""

from cbtui.widgets.choice.sheet import ChoiceOption, ChoiceSheet, kept_of, options_of
from cbtui.widgets.choice.widget import ChoiceOptions, ChoiceView

__all__ = ["ChoiceOption", "ChoiceOptions", "ChoiceSheet", "ChoiceView", "kept_of", "options_of"]
