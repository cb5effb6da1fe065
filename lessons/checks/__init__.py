"""Checks over a run, and what a lesson's own checks and answers are made of."""

from lessons.checks.callbacks import (
    exclusive_groups_hold,
    is_called_often,
    keeps_coming,
    never_overlap,
    never_raises,
    overlap,
    ticks_on_time,
    uses_threads,
)
from lessons.checks.check import Check, Verdict
from lessons.checks.diagnosed import never_stuck, no_problem, no_problems, problems
from lessons.checks.reading import (
    ROTATES,
    Stretch,
    calls_of,
    entities_named,
    is_called,
    requests_of,
    rotations,
    runs_long,
    seconds,
    spans_of,
    whole_run,
)
from lessons.checks.robot import data_never_older, turns
from lessons.checks.services import every_call_answered, log_never_says, log_says, replies_within
from sim.units import SECOND

__all__ = [
    "ROTATES",
    "SECOND",
    "Check",
    "Stretch",
    "Verdict",
    "calls_of",
    "data_never_older",
    "entities_named",
    "every_call_answered",
    "exclusive_groups_hold",
    "is_called",
    "is_called_often",
    "keeps_coming",
    "log_never_says",
    "log_says",
    "never_overlap",
    "never_raises",
    "never_stuck",
    "no_problem",
    "no_problems",
    "overlap",
    "problems",
    "replies_within",
    "requests_of",
    "rotations",
    "runs_long",
    "seconds",
    "spans_of",
    "ticks_on_time",
    "turns",
    "uses_threads",
    "whole_run",
]
