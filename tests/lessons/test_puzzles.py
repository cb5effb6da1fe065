"""Puzzles: each belongs to a lesson, is not solved by itself, and has a solution that solves it."""

import ast

import msgspec
import pytest

from cbtui.runs.judged.exploring import each_schedule
from cbtui.runs.setup.lesson_setup import RunRequest
from lessons.catalogue import find
from lessons.puzzles import SECONDS, Puzzle, puzzles
from tests.support.daily import first_daily


def test_there_are_eight_or_more_each_beside_a_lesson() -> None:
    assert len(puzzles()) >= 8
    for puzzle in puzzles():
        assert find(puzzle.lesson).id == puzzle.lesson
        assert puzzle.title
        assert puzzle.task.endswith(".")
        assert ast.get_docstring(ast.parse(puzzle.node_path.read_text())) is None


@pytest.mark.parametrize("puzzle", first_daily(*puzzles()), ids=lambda puzzle: puzzle.id)
def test_its_solution_solves_it_and_nothing_else_does(puzzle: Puzzle) -> None:
    setup = RunRequest(files=[puzzle.node_path], clock="virtual", seconds=SECONDS).setup()
    judge = puzzle.goal.check().judge
    seeds = [puzzle.solution, "moves:"]
    verdicts = each_schedule(setup, "node.py", 60, seeds, lambda observed: judge(observed.timeline))
    assert {seed: verdict.passed for seed, verdict in verdicts} == {puzzle.solution: True, "moves:": False}


def test_a_seat_that_is_sold_twice_reaches_the_goal_whoever_is_second() -> None:
    puzzle = next(each for each in puzzles() if each.id == "last-seat")
    setup = RunRequest(files=[puzzle.node_path], clock="virtual", seconds=SECONDS).setup()
    judge, seeds = puzzle.goal.check().judge, [puzzle.solution, "moves:0=1,1=1,3=1"]
    verdicts = dict(each_schedule(setup, "node.py", 60, seeds, lambda observed: judge(observed.timeline)))
    assert [verdicts[seed].passed for seed in seeds] == [True, True]
    assert [verdicts[seed].seen.split()[0] for seed in seeds] == ["ann", "bob"]


def test_a_goal_that_is_misspelt_is_refused() -> None:
    with pytest.raises(msgspec.ValidationError):
        msgspec.toml.decode('title="a"\nlesson="b"\ntask="c"\ngoal={raise="d"}\nsolution=""', type=Puzzle)
