"""The letters of callback groups in two runs that are compared."""

from dataclasses import replace

import pytest

from sim.trace.events import EntityAppeared, EntityKind, GroupAppeared, GroupKind
from sim.trace.figures.compared_groups import lettered_alike
from sim.trace.incremental import run_to_end
from sim.trace.timeline import Timeline
from tests.support.runs import Run


def groups(*members: str) -> Timeline:
    """A run of a node with a group for each text, of timers with these callbacks."""
    made = Run()
    node = made.node("/node")
    for names in members:
        group = made.exclusive(node)
        for name in names.split():
            made.timer(group, name, 1.0)
    timeline = Timeline()
    timeline.extend(made.events)
    return timeline


def letters(run: Timeline) -> str:
    return " ".join(f"{run.groups[each.group].letter}:{each.callback}" for each in run.entities.values())


@pytest.mark.parametrize(
    ("first", "second", "told"),
    [
        (["a b", "c d"], ["d", "a b", "c"], "B:d A:a A:b C:c"),
        (["a b", "c d"], ["c d", "a b"], "B:c B:d A:a A:b"),
        (["a b c"], ["a", "b c"], "B:a A:b A:c"),
        (["a b"], ["a", "b"], "A:a B:b"),
        (["", "a"], ["b", "a"], "A:b B:a"),
        (["a", "b"], ["x", "y"], "C:x D:y"),
        (["a"], ["a", "b"], "A:a B:b"),
    ],
)
def test_a_group_has_the_letter_of_the_one_with_which_it_shares_most_and_else_one_of_its_own(
    first: list[str], second: list[str], told: str
) -> None:
    run = groups(*second)
    assert letters(run_to_end(lettered_alike(groups(*first), run, run))) == told


def test_a_group_that_a_change_adds_takes_no_letter_from_one_of_the_program() -> None:
    run = groups("new", "old", "moved also", "stays")
    for added in (1, 3):
        run.groups[added] = replace(run.groups[added], is_own=False)
    assert letters(run_to_end(lettered_alike(groups("new old", "moved also stays"), run, run))) == (
        "C:new A:old D:moved D:also B:stays"
    )


def test_a_run_that_goes_on_keeps_its_letters_and_shows_what_is_new_in_it() -> None:
    first, run = groups("a", "b"), groups("b", "a")
    lettered = run_to_end(lettered_alike(first, run, run))
    run.extend(
        [
            GroupAppeared(5, 3, 1, GroupKind.EXCLUSIVE, "MutuallyExclusiveCallbackGroup"),
            EntityAppeared(5, 3, 1, 3, EntityKind.TIMER, "", "late", "node.py", 1, 1, 0, 5),
        ]
    )
    assert (lettered.end, letters(lettered)) == (5, "B:b A:a C:late")
    again = run_to_end(lettered_alike(first, run, lettered))
    assert ([each.letter for each in again.groups.values()], letters(run)) == (
        ["A", "B", "C"],
        "A:b B:a C:late",
    )
    assert run_to_end(lettered_alike(first, run, again)) is again
