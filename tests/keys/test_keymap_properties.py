"""Whatever keys are chosen: Textual does what footer and help say, and no key is in two minds."""

from itertools import combinations

from hypothesis import given, settings
from hypothesis import strategies as st
from textual.binding import BindingsMap

from cbtui.app import CbtuiApp
from cbtui.keys.action import Scope, key_id
from cbtui.keys.actions import ACTIONS, actions_of
from cbtui.keys.bindings import bindings_of
from cbtui.keys.config_keys import read_keys
from cbtui.keys.keymap import Keymap, canonical, keys_of
from tests.support.properties import examples

POOL = sorted({key for action in ACTIONS for key in keys_of(action)} | {"f5", "f6", "ctrl+g", "é", "*"})
CHOICES = st.dictionaries(
    st.sampled_from(sorted({key_id(action) for action in ACTIONS})),
    st.lists(st.sampled_from(POOL), min_size=1, max_size=3, unique=True),
    max_size=25,
)


def keymap_of(choices: dict[str, list[str]]) -> Keymap:
    return read_keys(dict(choices), lambda name, sentence: None)


@given(CHOICES)
@settings(max_examples=examples(60), deadline=None)
def test_textual_has_the_keys_that_are_shown(choices: dict[str, list[str]]) -> None:
    keymap = keymap_of(choices)
    told = CbtuiApp(keys=keymap)._keymap
    for scope in Scope:
        bindings = BindingsMap(bindings_of(scope))
        bindings.apply_keymap(told)
        bound = {(canonical(key), binding.action) for key, binding in bindings}
        shown = keymap.of(action for action in ACTIONS if action.scope is scope)
        assert bound == {(key, action.id) for action in shown for key in keys_of(action)}


@given(CHOICES)
@settings(max_examples=examples(60), deadline=None)
def test_only_those_share_a_key_that_share_one_in_the_registry(choices: dict[str, list[str]]) -> None:
    keymap = keymap_of(choices)
    for scope in Scope:
        actions = actions_of(scope)
        keys = [
            (set(keys_of(action)), set(keys_of(now)))
            for action, now in zip(actions, keymap.of(actions), strict=True)
        ]
        for (one, now), (other, other_now) in combinations(keys, 2):
            assert one & other or not now & other_now
