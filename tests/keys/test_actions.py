from collections import Counter

import pytest
from textual.dom import DOMNode

from cbtui.app import CbtuiApp
from cbtui.keys.action import KeyAction, Scope, group_by, method_of
from cbtui.keys.actions import ACTIONS, TASKS, actions_of
from cbtui.keys.bindings import bindings_of
from cbtui.keys.signs import signs_of
from cbtui.looks.theme import Charset
from cbtui.screens.menu import MenuScreen
from cbtui.screens.windows.chain import ChainScreen
from cbtui.screens.windows.diagnoses import DiagnosesScreen
from cbtui.screens.windows.export import ExportScreen
from cbtui.screens.windows.group import GroupScreen
from cbtui.screens.windows.help import HelpScreen
from cbtui.screens.windows.moment import MomentScreen
from cbtui.screens.windows.open_file import OpenFileScreen
from cbtui.screens.windows.prediction import PredictionScreen
from cbtui.screens.windows.setup import SetupScreen
from cbtui.screens.windows.solution import ConfirmSolutionScreen, SolutionScreen
from cbtui.screens.windows.threads import ThreadsScreen
from cbtui.screens.windows.value import ValueScreen
from cbtui.widgets.checks import ChecksView
from cbtui.widgets.choice import ChoiceOptions
from cbtui.widgets.code import CodeView
from cbtui.widgets.log import LogFilter, LogLines
from cbtui.widgets.menu_search import MenuSearch
from cbtui.widgets.shell import ProgramKeyboard, Prompt

HOMES: dict[Scope, type[DOMNode]] = {
    Scope.EVERYWHERE: CbtuiApp,
    Scope.MENU: MenuScreen,
    Scope.SEARCH: MenuSearch,
    Scope.OPENING: OpenFileScreen,
    Scope.LOG: LogLines,
    Scope.FILTER: LogFilter,
    Scope.CODE: CodeView,
    Scope.CHECKS: ChecksView,
    Scope.CHOICE: ChoiceOptions,
    Scope.PROMPT: Prompt,
    Scope.KEYBOARD: ProgramKeyboard,
    Scope.THREADS: ThreadsScreen,
    Scope.GROUP: GroupScreen,
    Scope.EXPORT: ExportScreen,
    Scope.SETUP: SetupScreen,
    Scope.DIAGNOSES: DiagnosesScreen,
    Scope.PREDICTION: PredictionScreen,
    Scope.SOLUTION: SolutionScreen,
    Scope.ASKING: ConfirmSolutionScreen,
    Scope.VALUE: ValueScreen,
    Scope.MOMENT: MomentScreen,
    Scope.CHAIN: ChainScreen,
    Scope.HELP: HelpScreen,
}


@pytest.mark.parametrize(
    "action",
    [action for action in ACTIONS if action.scope in HOMES],
    ids=lambda action: f"{action.scope}-{action.id}",
)
def test_every_action_has_a_method_where_it_works(action: KeyAction) -> None:
    assert hasattr(HOMES[action.scope], f"action_{method_of(action)[0]}")


@pytest.mark.parametrize("action", ACTIONS, ids=lambda action: f"{action.scope}-{action.id}")
def test_no_key_is_one_that_terminals_keep_for_themselves(action: KeyAction) -> None:
    for key in action.key.split(","):
        assert key not in {"ctrl+j", "ctrl+m", "ctrl+h", "ctrl+i", "ctrl+s"}
        assert "alt" not in key


def test_only_actions_that_rule_each_other_out_share_a_key() -> None:
    used = Counter((action.scope, key) for action in ACTIONS for key in action.key.split(","))
    shared = {key for (_, key), times in used.items() if times > 1}
    assert shared == {
        *"rfedChHWPsSq7tgpnacR0uwkix",
        *["space", "enter", "full_stop", "comma", "colon", "minus", "plus"],
        *(f"{side}_{what}_bracket" for side in ("left", "right") for what in ("square", "curly")),
        *["less_than_sign", "greater_than_sign", "equals_sign"],
        *(f"ctrl+{arrow}" for arrow in ("left", "right", "up", "down")),
    }


def test_ids_are_unique_within_a_scope() -> None:
    assert max(Counter((action.scope, action.id) for action in ACTIONS).values()) == 1


def test_help_is_one_sentence_without_a_full_stop() -> None:
    assert all(action.line and not action.line.endswith(".") for action in ACTIONS)


def test_every_binding_can_be_remapped_by_its_id() -> None:
    bindings = bindings_of(*Scope)
    assert len({binding.id for binding in bindings}) == len(ACTIONS)


def test_a_window_offers_only_its_own_actions() -> None:
    assert {action.scope for action in actions_of(Scope.HELP)} == {Scope.HELP}
    assert {action.scope for action in actions_of(Scope.MENU)} == {Scope.MENU, Scope.EVERYWHERE}


def test_neighbouring_keys_are_written_together() -> None:
    groups = {group[0].label: group for group in group_by(actions_of(Scope.LESSON), "label")}
    assert signs_of(groups["pane"], Charset.BRAILLE) == "1-7"
    assert signs_of(groups["speed"], Charset.BRAILLE) == "- +"


@pytest.mark.parametrize(("answers", "signs"), [(2, "↑ ↓ 1 2"), (3, "↑ ↓ 1-3")])
def test_numbers_come_after_the_other_keys_however_many_there_are(answers: int, signs: str) -> None:
    choosing = [action for action in actions_of(Scope.PREDICTION) if action.label == "choose"]
    offered = [each for each in choosing if not each.key.isdigit() or int(each.key) <= answers]
    assert signs_of(offered, Charset.BRAILLE) == signs


@pytest.mark.parametrize("scope", Scope)
def test_an_ascii_terminal_gets_keys_in_ascii(scope: Scope) -> None:
    assert signs_of(actions_of(scope), Charset.ASCII).isascii()


def test_the_help_has_every_action_of_a_lesson_that_the_footer_may_have() -> None:
    shown = [name for names in TASKS.values() for name in names]
    assert len(shown) == len(set(shown))
    assert set(shown) == {action.name for action in ACTIONS if action.scope is Scope.LESSON and action.label}
