"""Checks of a run, and the functions of which a lesson's own checks and answers are made."""

from lessons.checks.callbacks import (
    exclusive_groups_hold,
    keeps_coming,
    never_overlap,
    never_raises,
    overlap,
    raises,
    ticks_on_time,
    uses_threads,
)
from lessons.checks.chains import chain_never_takes_longer_than, chain_never_uses_older_than
from lessons.checks.check import Check, Verdict
from lessons.checks.diagnosed import gets_stuck, never_stuck, no_problem, no_problems, problems
from lessons.checks.limits import (
    begin_in_order,
    is_called_between,
    is_called_often,
    never_gets_ahead_of,
    never_loses_messages,
    never_runs_longer_than,
    never_takes_older_than,
    never_waits_longer_than,
)
from lessons.checks.reading import (
    ROTATES,
    WHOLE_RUN,
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
from sim.quantities.nanoseconds import SECOND

__all__ = [
    "ROTATES",
    "SECOND",
    "Check",
    "Stretch",
    "Verdict",
    "WHOLE_RUN",
    "begin_in_order",
    "calls_of",
    "chain_never_takes_longer_than",
    "chain_never_uses_older_than",
    "data_never_older",
    "entities_named",
    "every_call_answered",
    "exclusive_groups_hold",
    "gets_stuck",
    "is_called",
    "is_called_between",
    "is_called_often",
    "keeps_coming",
    "log_never_says",
    "log_says",
    "never_gets_ahead_of",
    "never_loses_messages",
    "never_overlap",
    "never_raises",
    "never_runs_longer_than",
    "never_stuck",
    "never_takes_older_than",
    "never_waits_longer_than",
    "no_problem",
    "no_problems",
    "overlap",
    "problems",
    "raises",
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
